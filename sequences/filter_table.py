#!/usr/bin/env python3
"""Prints the Markdown tables of what sequences/filter_rows has measured; started by it.

Reads DIRECTORY/<scene>/<spp>/<method>.json (of `eigenlight evaluate`) and, for CPU time a frame
without rendering, resampling and writing, <method>/frames.jsonl beside it.
"""

import argparse
import json
import pathlib

NOT_DENOISING = {"source", "resample", "write"}


def cpu_ms(directory):
    lines = (directory / "frames.jsonl").read_text(encoding="utf-8").splitlines()
    times = [
        sum(time["cpu_ms"] for stage, time in json.loads(line)["stages"].items()
            if stage not in NOT_DENOISING)
        for line in lines
    ]
    return sum(times) / len(times)


def row(directory, scene, spp, method):
    figures = json.loads((directory / scene / spp / f"{method}.json").read_text())["mean"]
    cells = [scene, spp, f"`{method}`"]
    for name in ("mse", "relmse", "temporal_error"):
        cells.append(f"{figures[name]:.3g}" if name in figures else "-")
    return cells + [f"{cpu_ms(directory / scene / spp / method):.0f}"]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("directory", type=pathlib.Path)
    for name in ("--scenes", "--methods", "--spp"):
        parser.add_argument(name, nargs="+", required=True)
    options = parser.parse_args()
    print("| scene | spp | method | MSE | relMSE | temporal error | CPU ms |")
    print("| --- | ---: | --- | ---: | ---: | ---: | ---: |")
    for scene in options.scenes:
        for spp in options.spp:
            for method in options.methods:
                print("| " + " | ".join(row(options.directory, scene, spp, method)) + " |")


if __name__ == "__main__":
    main()
