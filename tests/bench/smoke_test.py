#!/usr/bin/env python3
"""Runs each benchmark once on tiny frames: that they work, not how fast. smoke_test.py PROGRAM..."""

import os
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).parent))

import table  # noqa: E402
from results import load_json, load_results  # noqa: E402


def run(program, folder):
    """The results of all its benchmarks. No scene from outside the project is used."""
    path = folder / (pathlib.Path(program).name + ".json")
    environment = dict(os.environ, EIGENLIGHT_BENCH_HEIGHTS="36", EIGENLIGHT_SHARED=str(folder))
    command = [program, "--benchmark_min_time=0.001", f"--benchmark_out={path}",
               "--benchmark_out_format=json"]
    if "render" in path.name:
        command.append("--benchmark_filter=procedural|antialias")
    subprocess.run(command, env=environment, stdout=subprocess.DEVNULL, check=True)
    return path


def check_render(path):
    entries = load_json(path)["benchmarks"]
    assert entries and all(entry["rays"] > 0 for entry in entries), path


def check_stages(path):
    results = load_results(path)
    for result in results:
        for counter in ("bytes", "copy_ms", "cpu_ms", "ratio", "pixels_per_second"):
            assert result[counter] > 0, f"{result.name}: {counter} is {result[counter]}"
    stages = {result.stage for result in results}
    if "loop_pixels" in stages:
        assert "64x36: radius | guided filter" in table.scaling(results)
        return
    for arithmetic in ("atrous", "guided"):
        assert all(r["fma_ratio"] > 0 for r in results if r.stage == arithmetic)
    assert table.loop(results, [36], [5]).count("\n") == 2
    text = table.roofline(results, None, None)
    missing = [stage for stage in stages - {"loop_stages"} if f"| {stage} |" not in text]
    assert not missing, f"not in the table: {missing}"


def main():
    with tempfile.TemporaryDirectory() as name:
        for program in sys.argv[1:]:
            path = run(program, pathlib.Path(name))
            (check_render if "render" in path.name else check_stages)(path)
    print(f"{len(sys.argv) - 1} programs run")


if __name__ == "__main__":
    main()
