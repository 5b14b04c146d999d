#!/usr/bin/env python3
"""Prints the Markdown table of what sequences/quality has measured; started by it.

Reads DIRECTORY/<scene>/<method>.json (of `eigenlight evaluate`), <scene>/<method>/frames.jsonl and
<scene>/oidn/peer.txt. CPU time leaves out rendering, resampling and writing.
"""

import argparse
import json
import pathlib
import re

NOT_DENOISING = {"source", "resample", "write"}


def mean(values):
    values = list(values)
    return sum(values) / len(values) if values else None


def log_figures(directory):
    """Extra samples a pixel and CPU milliseconds a frame, over frames with history."""
    path = directory / "frames.jsonl"
    if not path.exists():
        return None, None
    lines = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]
    lines = [line for line in lines if not line["cut"]]
    extra = mean(line["extra_samples"] / max(line["surface_pixels"], 1) for line in lines)
    cpu = mean(
        sum(time["cpu_ms"] for stage, time in line["stages"].items() if stage not in NOT_DENOISING)
        for line in lines
    )
    return extra, cpu


def peer_cpu_ms(directory):
    found = re.findall(r"cpu ms: min ([\d.]+)", (directory / "peer.txt").read_text())
    return mean(map(float, found))


def row(directory, scene, method, noisy):
    figures = json.loads((directory / scene / f"{method}.json").read_text())["mean"]
    extra, cpu = log_figures(directory / scene / method)
    if method == "oidn":
        extra, cpu = 0.0, peer_cpu_ms(directory / scene / method)
    if method == "noisy":
        extra, cpu = 0.0, 0.0
    cells = [scene, method]
    for name in ("relmse", "temporal_error"):
        cells += number(figures.get(name), 3), ratio(figures.get(name), noisy.get(name))
    return cells + [number(extra, 2), number(cpu, 3)]


def number(value, digits):
    return "-" if value is None else f"{value:.{digits}g}"


def ratio(value, noisy):
    return "-" if value is None or not noisy else f"{value / noisy:.4f}"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("directory", type=pathlib.Path)
    parser.add_argument("--scenes", nargs="+", required=True)
    parser.add_argument("--methods", nargs="+", required=True)
    options = parser.parse_args()
    print("| scene | method | relMSE | / noisy | temporal error | / noisy | extra spp | CPU ms |")
    print("| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: |")
    for scene in options.scenes:
        noisy = {}
        path = options.directory / scene / "noisy.json"
        if path.exists():
            noisy = json.loads(path.read_text(encoding="utf-8"))["mean"]
        for method in options.methods:
            print("| " + " | ".join(row(options.directory, scene, method, noisy)) + " |")


if __name__ == "__main__":
    main()
