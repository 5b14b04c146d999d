#!/usr/bin/env python3
"""Puts what sequences/benchmark has measured into docs/: report.py DIRECTORY [DOCS]

Each table goes between the markers `<!-- benchmark:NAME -->` and `<!-- /benchmark:NAME -->`; SVG
plots go to the folder `plots`. Steps without a result in DIRECTORY leave their table as it is.
"""

import math
import os
import pathlib
import re
import sys

import table
from chart import COLORS, Chart
from results import load_json, load_results

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "sequences"))

from quality_table import log_figures  # noqa: E402

SCENE_NAMES = {"lights": "atrium, lights", "objects": "atrium, objects", "sponza": "crytek-sponza"}
METHODS = ["eigenlight", "OIDN", "mean", "svgf", "chen2012", "noisy"]  # take colors first


def set_sections(text, sections):
    """`text` with what stands between `<!-- benchmark:NAME -->` and `<!-- /benchmark:NAME -->`
    replaced for each name; ValueError naming the first that is not there exactly once."""
    for name, content in sections.items():
        begin, end = f"<!-- benchmark:{name} -->", f"<!-- /benchmark:{name} -->"
        if text.count(begin) != 1 or text.count(end) != 1 or text.index(begin) > text.index(end):
            raise ValueError(f"expected one '{begin}' and one '{end}' behind it")
        head, rest = text.split(begin)
        text = f"{head}{begin}\n{content.strip()}\n{end}{rest.split(end)[1]}"
    return text


def roofline(path):
    """At 1280x720, or at all sizes of a run without that one."""
    results = [r for r in load_results(path) if r.threads == 1]
    heights = [720] if any(r.height == 720 for r in results) else None
    return table.roofline(results, heights, [5]) + "\n\n" + table.loop(results, heights, None)


def bench_targets(path):
    return {r.target for r in load_results(path)}


def scaling(path, plots):
    """The tables and two plots of bench_scaling."""
    results = list(table.medians(load_results(path)))
    pixels = [(r.pixels * 1e-6, r["cpu_ms"]) for r in results if r.stage == "loop_pixels"]
    chart = Chart("CPU time against pixels", "megapixels", "CPU ms a frame")
    chart.add("eigenlight, K = 3", pixels)
    chart.write(plots / "scaling-pixels.svg")
    chart = Chart("Filters against their radius", "radius, pixels", "CPU ns a pixel")
    for stage, name in (("guided_radius", "guided filter"), ("bilateral_radius", "cross bilateral")):
        chart.add(name, [(r.value, r["ns_per_pixel"]) for r in results if r.stage == stage])
    chart.write(plots / "scaling-radius.svg")
    images = "".join(f"![{alt}](plots/{name}.svg)\n" for name, alt in (
        ("scaling-pixels", "CPU time of the loop against pixels"),
        ("scaling-radius", "CPU time of the guided and the cross bilateral filter against radius")))
    return table.scaling(results) + "\n\n" + images


def quality_figures(directory):
    """figures[scene][method]: the means of `eigenlight evaluate`; in the order of measurement."""
    paths = sorted(directory.glob("*/*.json"))
    found = {}
    for scene in ("atrium", "lights", "objects", "sponza"):
        methods = {p.stem: load_json(p)["mean"] for p in paths if p.parent.name == scene}
        if methods:
            found[scene] = methods
    return found


def quality_pivot(figures, metric):
    """Methods by scenes: the figure, and as a multiple of the noisy input."""
    order = ("noisy", "mean", "chen2012", "oidn", "eigenlight")
    methods = [m for m in order if all(m in of_scene for of_scene in figures.values())]
    rows = []
    for method in methods:
        cells = [{"oidn": "OIDN balanced", "noisy": "noisy"}.get(method, f"`{method}`")]
        for of_scene in figures.values():
            value, noisy = of_scene[method][metric], of_scene["noisy"][metric]
            cells.append(f"{value:.3g}" + ("" if method == "noisy" else f" ({value / noisy:.4f})"))
        rows.append(cells)
    return table.markdown([""] + [SCENE_NAMES.get(s, s) for s in figures], rows)


def quality(directory, settings):
    figures = quality_figures(directory)
    lines = [settings.strip(), "", "relMSE, and as a multiple of the noisy input:", "",
             quality_pivot(figures, "relmse"), "",
             "Temporal error, and as a multiple of the noisy input:", "",
             quality_pivot(figures, "temporal_error"), ""]
    extra = [(s, log_figures(directory / s / "eigenlight")[0]) for s in figures]
    lines.append("Samples that resampling adds to each pixel's own: " +
                 ", ".join(f"{SCENE_NAMES.get(s, s)} {e:.2f}" for s, e in extra) + ".")
    return "\n".join(lines)


def curves(scene):
    """(CPU ms a frame, relMSE) by contender: the points of error against time."""
    found = {}
    for cell in scene["cells"]:
        error = cell["mean"].get("relmse")
        if error is not None and error > 0.0:
            found.setdefault(cell["contender"], []).append((cell["cpu_ms"]["total"], error))
    return found


def error_at(points, ms):
    """The error at `ms` on straight lines between points in log-log; None beyond them."""
    points = sorted(points)
    for (t0, e0), (t1, e1) in zip(points, points[1:]):
        if t0 <= ms <= t1 and t0 < t1:
            share = math.log(ms / t0) / math.log(t1 / t0)
            return math.exp((1.0 - share) * math.log(e0) + share * math.log(e1))
    return None


def at_equal_time(scene, ours):
    """Our time in the middle of our curve, which others can reach from both sides, and all errors."""
    found = curves(scene)
    points = sorted(found[ours])
    ms = points[len(points) // 2][0]
    errors = {label: error_at(of_label, ms) for label, of_label in found.items()}
    return ms, {label: error for label, error in errors.items() if error is not None}


def compare(path, plots):
    """A plot of error against time for each scene, and errors at equal time."""
    results = load_json(path)
    labels = [c["label"] for c in results["settings"]["contenders"]]
    known = [name for name in METHODS if name in labels]
    order = known + [label for label in labels if label not in known]
    colors = {label: COLORS[i % len(COLORS)] for i, label in enumerate(order)}
    parts, rows = [], []
    for scene in results["scenes"]:
        name = re.sub(r"[^\w-]+", "-", scene["name"])
        chart = Chart(f"{scene['name']}: error against time", "CPU ms a frame, rendering + denoising",
                      "relMSE")
        for label, points in curves(scene).items():
            chart.add(label, points)
        chart.write(plots / f"error-time-{name}.svg", colors)
        parts.append(f"![{scene['name']}: relMSE against CPU time](plots/error-time-{name}.svg)")
        ms, errors = at_equal_time(scene, results["settings"]["ours"])
        best = min(errors.values(), default=None)
        cells = [f"{errors[l]:.3g}" if l in errors else "-" for l in labels]
        cells = [f"**{c}**" if errors.get(l) == best and l in errors else c
                 for l, c in zip(labels, cells)]
        rows.append([scene["name"], f"{ms:.0f}"] + cells)
    settings = results["settings"]
    head = (f"{settings['width']}x{settings['height']}, frames {settings['frames']}, "
            f"{', '.join(map(str, settings['spp']))} samples a pixel; relMSE at the same total CPU "
            "time, read off the measured curves; - where a curve does not reach that time:")
    return "\n\n".join(["\n".join(parts), head, table.markdown(["scene", "ms"] + labels, rows)])


def ablation(path):
    """Our method with all its parts, and without each: figures, and their multiples of the whole."""
    results = load_json(path)
    settings, scene = results["settings"], results["scenes"][0]
    cells = {cell["contender"]: cell for cell in scene["cells"]}
    figures = {label: (cell["mean"]["relmse"], cell["mean"]["temporal_error"], cell["cpu_ms"]["denoise"],
                       cell["cpu_ms"]["total"]) for label, cell in cells.items()}
    whole = figures[settings["ours"]]
    rows = []
    for contender in settings["contenders"]:
        row = ["all parts" if "without" not in contender else f"without `{contender['without']}`"]
        for value, all_parts, form in zip(figures[contender["label"]], whole, (".3g", ".3g", ".1f", ".0f")):
            row.append(f"{value:{form}} ({value / all_parts:.2f})")
        rows.append(row)
    head = (f"{scene['name']}, {settings['width']}x{settings['height']}, frames {settings['frames']}, "
            f"{settings['spp'][0]} samples a pixel; in parentheses multiples of the whole:")
    names = ["", "relMSE", "temporal error", "denoising, CPU ms", "with rendering, CPU ms"]
    return head + "\n\n" + table.markdown(names, rows)


def render(path):
    rows = []
    for entry in load_json(path)["benchmarks"]:
        # Antialiasing has a table of its own.
        if entry.get("error_occurred") or not entry["name"].startswith("indirect_"):
            continue
        name = entry["name"].split("/")[0].removeprefix("indirect_")
        of_cpu = entry["rays"] * entry["real_time"] / entry["cpu_time"]
        rows.append([name, f"{of_cpu * 1e-6:.2f}", f"{entry['rays'] * 1e-6:.2f}",
                     f"{entry['rays_per_sample']:.2f}"])
    head = ["scene", "million rays per CPU second", "per second, all threads", "rays/sample"]
    return table.markdown(head, rows)


def papers(paths):
    """What each paper claims, what it gives here, and whether that holds."""
    parts = []
    for path in paths:
        paper = load_json(path)
        width, height = paper["size"]
        rows = [[c["where"], c["claim"], c["paper"], c["ours"], c["verdict"]] for c in paper["claims"]]
        parts.append(f"{paper['title']} (theirs: {paper['paper_hardware']}; here, where the paper gives no "
                     f"size, {width}x{height}, frames {paper['frames']}):")
        words = table.markdown([paper["paper"], "claim", "the paper", "here", ""], rows)
        parts.append(words.replace(" ---: |", " --- |"))
    return "\n\n".join(parts)


def sections(directory, plots):
    """The sections of docs/ by name, as far as there are results."""
    found = {}
    if (directory / "denoise.json").exists():
        found["roofline"] = roofline(directory / "denoise.json")
        if len(bench_targets(directory / "denoise.json")) > 1:
            found["targets"] = table.targets(load_results(directory / "denoise.json"))
    if (directory / "scaling.json").exists():
        found["scaling"] = scaling(directory / "scaling.json", plots)
    if (directory / "render.json").exists():
        found["render"] = render(directory / "render.json")
    if (directory / "peer.md").exists():
        found["peer"] = (directory / "peer.md").read_text(encoding="utf-8")
    if (directory / "quality.txt").exists():
        settings = (directory / "quality.txt").read_text(encoding="utf-8")
        found["quality"] = quality(directory / "quality", settings)
    if (directory / "compare" / "results.json").exists():
        found["compare"] = compare(directory / "compare" / "results.json", plots)
    if (directory / "ablate" / "results.json").exists():
        found["ablation"] = ablation(directory / "ablate" / "results.json")
    reruns = sorted(directory.glob("paper-*.json"))
    if reruns:
        found["papers"] = papers(reruns)
    return found


def write_page(page, found):
    text = set_sections(page.read_text(encoding="utf-8"), found)
    temporary = page.with_suffix(".part")
    temporary.write_text(text, encoding="utf-8")
    os.replace(temporary, page)
    print(f"{page}: {', '.join(found) or 'nothing to fill in'}")


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    directory = pathlib.Path(sys.argv[1])
    docs = pathlib.Path(sys.argv[2]) if len(sys.argv) == 3 else ROOT / "docs"
    found = sections(directory, docs / "plots")
    papers_alone = {name: found.pop(name) for name in ("papers",) if name in found}
    for page, content in ((docs / "measurements.md", found), (docs / "papers.md", papers_alone)):
        try:
            write_page(page, content)
        except ValueError as error:
            sys.exit(f"{page}: {error}")


if __name__ == "__main__":
    main()
