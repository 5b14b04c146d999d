#!/usr/bin/env python3
"""Runs each benchmark once on tiny frames: that they work, not how fast. smoke_test.py PROGRAM..."""

import math
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


def check_timed(path):
    """Filters and rivals: each beside its copy; the pyramid's quality by its figures."""
    entries = load_json(path)["benchmarks"]
    assert entries, path
    for entry in entries:
        assert not entry.get("error_occurred"), f"{entry['name']}: {entry['error_message']}"
        quality = entry["name"].startswith("quality/")
        counters = (("trained_psnr", "trained_ssim", "untrained_psnr", "untrained_ssim") if quality
                    else ("bytes", "copy_ms", "cpu_ms", "ratio", "pixels_per_second"))
        for counter in counters:
            value = entry[counter]
            assert value > 0 and math.isfinite(value), f"{entry['name']}: {counter} is {value}"


def check_stages(path):
    results = load_results(path)
    for result in results:
        for counter in ("bytes", "copy_ms", "cpu_ms", "ratio", "pixels_per_second"):
            assert result[counter] > 0, f"{result.name}: {counter} is {result[counter]}"
    stages = {result.stage for result in results}
    if "loop_pixels" in stages:
        assert "64x36: radius | guided filter" in table.scaling(results)
        return
    for arithmetic in ("atrous", "soft_atrous", "guided"):
        assert all(r["fma_ratio"] > 0 for r in results if r.stage == arithmetic)
    assert table.loop(results, [36], [5]).count("\n") == 2
    text = table.roofline(results, None, None)
    missing = [stage for stage in stages - {"loop_stages"} if f"| {stage} |" not in text]
    assert not missing, f"not in the table: {missing}"


CHECKS = {"bench_render": check_render}
CHECKS.update({f"bench_{name}": check_timed for name in ("filters", "pyramid", "rivals")})


def main():
    with tempfile.TemporaryDirectory() as name:
        for program in sys.argv[1:]:
            path = run(program, pathlib.Path(name))
            CHECKS.get(path.stem, check_stages)(path)
    print(f"{len(sys.argv) - 1} programs run")


if __name__ == "__main__":
    main()
