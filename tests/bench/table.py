#!/usr/bin/env python3
"""Prints a Markdown table of bench_denoise: table.py RESULT.json [PEER]

RESULT.json comes from `bench_denoise --benchmark_out=RESULT.json --benchmark_out_format=json`.
PEER is the program oidn_peer; with it the table ends with OIDN's CPU time on frames of the same
sizes, and the denoiser's share of it.
"""

import json
import os
import re
import subprocess
import sys

NAME = re.compile(r"(\w+)/height:(\d+)/bases:(\d+)/threads:(\d+)")
WITHOUT_BASES = {"innovation", "budget", "atrous", "guided"}


def load(path):
    """Rows of (stage, height, bases, threads, counters), without those that failed."""
    with open(path, encoding="utf-8") as file:
        results = json.load(file)["benchmarks"]
    for result in results:
        match = NAME.match(result["name"])
        if result.get("error_occurred"):
            sys.exit(f"{path}: {result['name']}: {result['error_message']}")
        if match:
            stage, height, bases, threads = match.groups()
            yield stage, int(height), int(bases), int(threads), result


def peer_cpu_ms(peer, height):
    """Median CPU milliseconds of OIDN balanced on one frame."""
    size = f"{height * 16 // 9}x{height}"
    # Threads that wait must sleep, or their waiting counts as work.
    environment = dict(os.environ, OMP_WAIT_POLICY="passive")
    command = [peer, "--bench", size, "--repeat", "3"]
    output = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    found = re.search(r"cpu ms: min [\d.]+ +median ([\d.]+)", output.stdout)
    if not found:
        sys.exit(f"{peer}: no CPU time in what it printed")
    return float(found.group(1))


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    rows = list(load(sys.argv[1]))
    print("| stage | size | K | threads | MB moved | copy ms | CPU ms | ratio | ns/pixel |")
    print("| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |")
    for stage, height, bases, threads, counters in rows:
        print(
            f"| {stage} | {height * 16 // 9}x{height} | {'' if stage in WITHOUT_BASES else bases} "
            f"| {threads} | {counters['bytes'] * 1e-6:.0f} | {counters['copy_ms']:.2f} "
            f"| {counters['cpu_ms']:.1f} | {counters['ratio']:.1f} | {counters['ns_per_pixel']:.1f} |"
        )
    if len(sys.argv) == 2:
        return
    print("\n| size | OIDN balanced, CPU ms | K | threads | denoiser, CPU ms | OIDN / denoiser |")
    print("| --- | ---: | ---: | ---: | ---: | ---: |")
    ours = [row for row in rows if row[0] == "denoiser"]
    peers = {height: peer_cpu_ms(sys.argv[2], height) for height in sorted({r[1] for r in ours})}
    for _, height, bases, threads, counters in ours:
        cpu = counters["cpu_ms"]
        print(
            f"| {height * 16 // 9}x{height} | {peers[height]:.0f} | {bases} | {threads} "
            f"| {cpu:.1f} | {peers[height] / cpu:.1f} |"
        )


if __name__ == "__main__":
    main()
