#!/usr/bin/env python3
"""Prints the denoiser beside OIDN balanced on frames of the same sizes, as a Markdown table.

Both run by turns on one thread, and of each the least CPU time counts: whatever else the machine
does slows both. `denoiser` has light that changes everywhere, `denoiser_steady` light that does not.
"""

import argparse
import os
import pathlib
import re
import subprocess
import sys
import tempfile

from results import load_results
from table import markdown

STAGES = ("denoiser", "denoiser_steady")


def run(command, environment=None):
    """What a program printed; ends this one with one line if it fails."""
    try:
        return subprocess.run(command, env={**os.environ, **(environment or {})}, check=True,
                              capture_output=True, text=True).stdout
    except (OSError, subprocess.CalledProcessError) as error:
        sys.exit(f"{' '.join(map(str, command))}: {getattr(error, 'stderr', None) or error}")


def peer_ms(program, size):
    """CPU milliseconds of OIDN balanced on one frame."""
    # Threads that wait must sleep, or their waiting counts as work.
    text = run([program, "--bench", size, "--repeat", "1", "--threads", "1"],
               {"OMP_WAIT_POLICY": "passive"})
    found = re.search(r"cpu ms: min ([\d.]+)", text)
    if not found:
        sys.exit(f"{program}: no CPU time in what it printed")
    return float(found.group(1))


def our_ms(program, height):
    """CPU milliseconds of each of STAGES on a frame, K = 5."""
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "result.json"
        run([program, f"--benchmark_filter=^({'|'.join(STAGES)})/height:{height}/bases:5/threads:1/target:0",
             "--benchmark_min_time=0.2", f"--benchmark_out={path}", "--benchmark_out_format=json"],
            {"EIGENLIGHT_BENCH_HEIGHTS": str(height)})
        return {result.stage: result["cpu_ms"] for result in load_results(path)}


def row(options, height):
    size = f"{height * 16 // 9}x{height}"
    theirs, ours = [], {stage: [] for stage in STAGES}
    for _ in range(options.turns):
        theirs.append(peer_ms(options.peer, size))
        for stage, time in our_ms(options.bench, height).items():
            ours[stage].append(time)
    cells = [size, f"{min(theirs):.0f}"]
    for stage in STAGES:
        cells += [f"{min(ours[stage]):.1f}", f"{min(theirs) / min(ours[stage]):.1f}"]
    return cells


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("bench", help="the program bench_denoise")
    parser.add_argument("peer", help="the program oidn_peer")
    parser.add_argument("heights", help="such as '360 720'")
    parser.add_argument("--turns", type=int, default=4, help="[%(default)s]")
    options = parser.parse_args()
    head = ["size", "OIDN balanced, CPU ms", "denoiser, changing light, CPU ms", "OIDN / denoiser",
            "steady light, CPU ms", "OIDN / denoiser"]
    print(markdown(head, [row(options, height) for height in map(int, options.heights.split())]))


if __name__ == "__main__":
    main()
