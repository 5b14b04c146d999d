"""docs/measurements.md: a section for what each step of sequences/benchmark prints."""

import datetime
import pathlib
import re
import shutil
import subprocess
import textwrap

from chart import COLORS, Chart
from results import load_json, load_results
from step_runner import ROOT, say, write_whole
from table import medians

METHODS = ["eigenlight", "OIDN", "mean", "svgf", "chen2012", "noisy"]  # take colors first
HEAD = """# Measurements

How good and how fast the denoiser is, in full. Words such as relMSE are explained in the [glossary](glossary.md).

| | |
| --- | --- |
| date | {date} |
| program | {commit} |
| machine | {machine} |
| command | `sequences/benchmark` |

The command writes this file whole: edit the script, not this file. A section whose step was not run keeps what its
last run left, with its own date, commit and machine. On a shared machine code that waits for memory can take twice as
long from one minute to the next. Ratios to a copy of the same bytes in the same run swing much less, so they stand
beside most times."""


def machine():
    """Processor, cores and the widest instruction set, as `eigenlight` tells them."""
    text = pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8")
    flags = set(re.search(r"^flags\s*: (.*)$", text, re.M)[1].split())
    names = (("AVX-512", {f"avx512{part}" for part in ("f", "vl", "dq", "bw", "cd")}), ("AVX2", {"avx2"}),
             ("SSE4.2", {"sse4_2"}))
    widest = next((name for name, needed in names if needed <= flags), "no AVX-512, AVX2 or SSE4.2")
    model = re.search(r"^model name\s*: (.*)$", text, re.M)
    cores = len(re.findall(r"^processor\s*:", text, re.M))
    return f"{model[1] if model else 'unknown'}, {cores} cores, {widest}"


def commit():
    """The commit that is checked out, and whether files beside docs/ differ from it."""
    def git(*words):
        return subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True, check=False)

    found = git("rev-parse", "--short", "HEAD").stdout.strip()
    if not found:
        return "unknown commit"
    changed = git("status", "--porcelain", "--untracked-files=no", "--", ".", ":!docs").stdout.strip()
    return f"commit {found}" + (" and uncommitted changes" if changed else "")


def facts():
    """What stands at the head of the file and of each section."""
    day = datetime.datetime.now(datetime.timezone.utc).date().isoformat()
    return {"date": day, "commit": commit(), "machine": machine()}


def section_text(section, facts_of_run, docs, replaced):
    """A section as it stands in the file, without its title."""
    shown = "\n".join(command.shown(replaced) for command in section.commands)
    printed = [command.target.read_text(encoding="utf-8").strip() for command in section.commands
               if command.target]
    images = [f"![{what}]({name})" for what, name in section.pictures(docs)]
    measured = "Measured {date}, {commit}, on {machine}:".format(**facts_of_run)
    parts = [textwrap.fill(section.words, 118), textwrap.fill(measured, 118), f"```sh\n{shown}\n```", *printed, "\n".join(images)]
    return "\n\n".join(part for part in parts if part)


def sections_of(text):
    """The sections of a file by title, in their order."""
    parts = re.split(r"^## (.*)\n", text, flags=re.M)
    return {title: body.strip() for title, body in zip(parts[1::2], parts[2::2])}


def document(titles, fresh, old, facts_now):
    """The whole file: for each of `titles` its section of `fresh`, else of the file `old`."""
    kept = sections_of(old)
    found = {title: fresh.get(title, kept.get(title)) for title in titles}
    found = {title: body for title, body in found.items() if body}
    contents = "\n".join(f"- [{title}](#{anchor(title)})" for title in found)
    bodies = [f"## {title}\n\n{body}" for title, body in found.items()]
    return "\n\n".join([HEAD.format(**facts_now), contents, *bodies]) + "\n"


def anchor(title):
    """The link to a heading, as Markdown viewers make it."""
    return re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-")


def write(path, steps, titles, state, replaced):
    """Writes the file `path` with new sections for `steps`, and their pictures beside it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    fresh = {section.title: section_text(section, state.facts(step), path.parent, replaced)
             for step in steps for section in step.sections}
    old = path.read_text(encoding="utf-8") if path.exists() else ""
    for title in sections_of(old):
        if title not in titles:
            say(f"{path}: no step prints the section '{title}': dropped")
    write_whole(path, document(titles, fresh, old, facts()))
    say(f"{path}: {', '.join(fresh) or 'nothing new'}")


def scaling_plots(path):
    """Plots of bench_scaling."""
    def draw(docs):
        results = list(medians(load_results(path)))
        chart = Chart("CPU time against pixels", "megapixels", "CPU ms a frame")
        chart.add("eigenlight, K = 3",
                  [(r.pixels * 1e-6, r["cpu_ms"]) for r in results if r.stage == "loop_pixels"])
        chart.write(docs / "plots/scaling-pixels.svg")
        chart = Chart("Filters against their radius", "radius, pixels", "CPU ns a pixel")
        for stage, name in (("guided_radius", "guided filter"), ("bilateral_radius", "cross bilateral")):
            chart.add(name, [(r.value, r["ns_per_pixel"]) for r in results if r.stage == stage])
        chart.write(docs / "plots/scaling-radius.svg")
        return [("CPU time of the loop against pixels", "plots/scaling-pixels.svg"),
                ("CPU time of the guided and the cross bilateral filter against radius",
                 "plots/scaling-radius.svg")]
    return draw


def curves(scene):
    """(CPU ms a frame, relMSE) by contender: the points of error against time. A relMSE at or below
    zero is noise of the references and has no place on the plot."""
    found = {}
    for cell in scene["cells"]:
        error = cell["mean"].get("relmse")
        if error is not None and error > 0.0:
            found.setdefault(cell["contender"], []).append((cell["cpu_ms"]["total"], error))
    return found


def error_time_plots(path):
    """A plot of error against time for each scene of a comparison."""
    def draw(docs):
        results = load_json(path)
        labels = [c["label"] for c in results["settings"]["contenders"]]
        known = [name for name in METHODS if name in labels]
        order = known + [label for label in labels if label not in known]
        colors = {label: COLORS[i % len(COLORS)] for i, label in enumerate(order)}
        drawn = []
        for scene in results["scenes"]:
            chart = Chart(f"{scene['name']}: error against time",
                          "CPU ms a frame, rendering + denoising", "relMSE")
            for label, points in curves(scene).items():
                chart.add(label, points)
            name = f"plots/error-time-{scene['name']}.svg"
            chart.write(docs / name, colors)
            drawn.append((f"{scene['name']}: relMSE against CPU time", name))
        return drawn
    return draw


def crops(path, name, what):
    """A picture of crops as `eigenlight compare` leaves it."""
    def copy(docs):
        (docs / "pictures").mkdir(exist_ok=True)
        shutil.copyfile(path, docs / "pictures" / name)
        return [(what, f"pictures/{name}")]
    return copy
