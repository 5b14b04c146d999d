#!/usr/bin/env python3
"""Prints measurements as Markdown tables.

table.py roofline RESULT.json [--heights 720] [--bases 5]
    each stage beside its floor: the copy of the bytes that it must move, or, for stages that are
    bound by arithmetic, its operations at the peak of multiply-adds, both measured in the same run
table.py loop RESULT.json [--heights 720] [--bases 5]
    where the loop's time goes
table.py targets RESULT.json
    CPU time of each stage by instruction set
table.py scaling RESULT.json
    of bench_scaling: the loop by pixels and by bases, filters by radius
table.py render RESULT.json
    of bench_render: rays of indirect light a second

RESULT.json comes from `bench_denoise --benchmark_out=RESULT.json --benchmark_out_format=json`.
"""

import argparse

from results import load_json, load_results


LOOP_STAGES = ("warp", "budget", "project", "predict", "bound", "correct", "learn", "update", "filter")


def markdown(head, rows):
    """A table whose first column is text and whose others are numbers."""
    lines = ["| " + " | ".join(head) + " |", "| --- |" + " ---: |" * (len(head) - 1)]
    lines += ["| " + " | ".join(cells) + " |" for cells in rows]
    return "\n".join(lines)


def medians(results):
    """One result for each name: the repetition of median CPU time."""
    by_name = {}
    for result in results:
        by_name.setdefault(result.name, []).append(result)
    for group in by_name.values():
        yield sorted(group, key=lambda result: result["cpu_ms"])[(len(group) - 1) // 2]


def floor_cells(result):
    """Floor, its milliseconds, measured milliseconds, ratio: of the floor that is closer."""
    copy, cpu = result["copy_ms"], result["cpu_ms"]
    fma = cpu / result["fma_ratio"] if result.get("fma_ratio") else 0.0
    if fma > copy:
        name = f"{result['flops'] * 1e-9:.2f} GFLOP at {result['peak_gflops']:.0f} GFLOP/s"
        return [name, f"{fma:.2f}", f"{cpu:.1f}", f"{cpu / fma:.1f}"]
    return [f"copy {result['bytes'] * 1e-6:.0f} MB", f"{copy:.2f}", f"{cpu:.1f}", f"{cpu / copy:.1f}"]


def roofline(results, heights, bases):
    head = ["stage", "size", "K", "threads", "floor", "floor ms", "CPU ms", "ratio", "Mpixel/s"]
    rows = []
    for result in medians(results):
        if result.stage == "loop_stages" or result.target:
            continue
        if heights and result.height not in heights:
            continue
        if bases and result.bases and result.value not in bases:
            continue
        rows.append([result.stage, result.size, result.bases, str(result.threads)])
        rows[-1] += floor_cells(result) + [f"{result['pixels_per_second'] * 1e-6:.1f}"]
    return markdown(head, rows)


def targets(results):
    times, names = {}, {}
    for result in medians(results):
        names[result.target] = result.target_name
        if result.threads > 1:
            continue
        case = (result.stage, result.size, result.bases)
        times.setdefault(case, {})[result.target] = result["cpu_ms"]
    rows = []
    for (stage, size, bases), found in times.items():
        if len(found) < 2:
            continue
        cells = [f"{found[t]:.1f}" if t in found else "" for t in sorted(names)]
        rows.append([stage, size, bases] + cells)
    return markdown(["stage", "size", "K"] + [f"{names[t]}, ms" for t in sorted(names)], rows)


def loop(results, heights, bases):
    """The loop's own stages: milliseconds, and shares of the whole."""
    rows = []
    for result in medians(results):
        if result.stage != "loop_stages" or (heights and result.height not in heights):
            continue
        if bases and result.value not in bases:
            continue
        times = [result[f"{stage}_ms"] for stage in LOOP_STAGES]
        rows.append([result.size, result.bases, f"{result['cpu_ms']:.1f}"])
        rows[-1] += [f"{t:.1f} ({100 * t / result['cpu_ms']:.0f} %)" for t in times]
    return markdown(["loop at", "K", "CPU ms", *LOOP_STAGES], rows)


def scaling_table(results, stage, column, label):
    head = [label, "CPU ms", "ns/pixel", "ratio to copy"]
    rows = [
        [column(result), f"{result['cpu_ms']:.1f}", f"{result['ns_per_pixel']:.1f}",
         f"{result['ratio']:.1f}"]
        for result in medians(results)
        if result.stage == stage
    ]
    return markdown(head, rows)


def radius_table(results, label):
    """Guided and bilateral filter side by side."""
    times = {}
    for result in medians(results):
        if result.kind == "radius":
            times.setdefault(result.value, {})[result.stage] = result["ns_per_pixel"]
    rows = [
        [str(radius)] + [f"{found[s]:.0f}" for s in ("guided_radius", "bilateral_radius")]
        for radius, found in sorted(times.items())
    ]
    return markdown([label, "guided filter, ns/pixel", "cross bilateral, ns/pixel"], rows)


def scaling(results):
    bases = {r.value for r in results if r.stage == "loop_pixels"}
    size = next(r.size for r in results if r.stage == "loop_bases")
    return "\n\n".join([
        scaling_table(results, "loop_pixels", lambda r: r.size,
                      f"loop, K = {', '.join(map(str, sorted(bases)))}: size"),
        scaling_table(results, "loop_bases", lambda r: str(r.value), f"loop, {size}: K"),
        radius_table(results, f"{size}: radius"),
    ])


def render(entries):
    rows = []
    for entry in entries:
        if entry.get("error_occurred") or not entry["name"].startswith("indirect_"):
            continue
        name = entry["name"].split("/")[0].removeprefix("indirect_")
        of_cpu = entry["rays"] * entry["real_time"] / entry["cpu_time"]
        rows.append([name, f"{of_cpu * 1e-6:.2f}", f"{entry['rays'] * 1e-6:.2f}",
                     f"{entry['rays_per_sample']:.2f}"])
    head = ["scene", "million rays per CPU second", "per second, all threads", "rays/sample"]
    return markdown(head, rows)


def numbers(text):
    return [int(word) for word in text.split(",")]


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("table", choices=["roofline", "loop", "targets", "scaling", "render"])
    parser.add_argument("result")
    parser.add_argument("--heights", type=numbers, help="such as 720,1080; without it all")
    parser.add_argument("--bases", type=numbers, help="such as 5; without it all")
    options = parser.parse_args()
    if options.table == "render":
        print(render(load_json(options.result)["benchmarks"]))
        return
    results = load_results(options.result)
    if options.table == "roofline":
        print(roofline(results, options.heights, options.bases))
    elif options.table == "loop":
        print(loop(results, options.heights, options.bases))
    elif options.table == "targets":
        print(targets(results))
    else:
        print(scaling(results))


if __name__ == "__main__":
    main()
