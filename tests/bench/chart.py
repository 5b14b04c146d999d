#!/usr/bin/env python3
"""Draws line charts as SVG for READMEs, light or dark as the reader's system is.

As a program: chart.py PLOT.json OUT.svg draws a plot of Chart.from_json().
"""

import json
import math
import os
import pathlib
import sys
import xml.sax.saxutils

WIDTH, HEIGHT = 760, 440
LEFT, RIGHT, TOP, BOTTOM = 78, 170, 46, 58
ENOUGH_TICKS = 4
MOST_DOTS = 60  # of a series; a longer one is a line only

# Okabe and Ito 2008: told apart by all kinds of color vision, on light and on dark.
COLORS = ["#d55e00", "#0072b2", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#8c8c8c", "#b09500"]

STYLE = """
text { font: 13px system-ui, sans-serif; fill: #24292f }
.title { font-size: 16px; font-weight: 600 }
.tick { font-size: 12px; fill: #57606a }
.grid { stroke: #d0d7de; stroke-width: 1 }
.back { fill: #ffffff }
@media (prefers-color-scheme: dark) {
  text { fill: #e6edf3 } .tick { fill: #9da7b3 } .grid { stroke: #30363d } .back { fill: #0d1117 }
}
"""


class Axis:
    """Maps values to pixels, linearly or by their logarithm, with round ticks."""

    def __init__(self, values, low, high, is_log):
        self.is_log = is_log
        self.low, self.high = low, high
        first, last = min(values), max(values)
        if is_log:
            if first <= 0.0:
                raise ValueError(f"a logarithmic axis has no place for {first:g}")
            self.first, self.last = first / 1.15, last * 1.15
        else:
            self.first, self.last = min(0.0, first), last * 1.05 or 1.0

    def place(self, value):
        if self.is_log:
            share = math.log(value / self.first) / math.log(self.last / self.first)
        else:
            share = (value - self.first) / (self.last - self.first)
        return self.low + share * (self.high - self.low)

    def ticks(self):
        if not self.is_log:
            step = 10.0 ** math.floor(math.log10(self.last - self.first))
            while (self.last - self.first) / step < ENOUGH_TICKS:
                step /= 2
            return [i * step for i in range(int(self.last / step) + 1)]
        decades = range(math.floor(math.log10(self.first)), math.ceil(math.log10(self.last)) + 1)
        found = []
        for steps in ((1,), (1, 2, 5), range(1, 10)):
            values = [s * 10.0**d for d in decades for s in steps]
            found = [v for v in values if self.first <= v <= self.last]
            if len(found) >= ENOUGH_TICKS:
                break
        return found


def text(x, y, words, attributes=""):
    return f'<text x="{x:.1f}" y="{y:.1f}" {attributes}>{xml.sax.saxutils.escape(words)}</text>'


def spread(places, gap):
    """The same places in the same order, moved apart to at least `gap`."""
    order = sorted(range(len(places)), key=places.__getitem__)
    moved = list(places)
    for before, after in zip(order, order[1:]):
        moved[after] = max(moved[after], moved[before] + gap)
    return moved


class Chart:
    """Series of points (x, y) under their names; `colors` fixes the color of a name."""

    def __init__(self, title, x_label, y_label, is_log=(True, True)):
        self.title, self.labels, self.is_log = title, (x_label, y_label), is_log
        self.series = {}

    @classmethod
    def from_json(cls, plot):
        """A plot as results.json of `compare --paper` has it: title, x, y (labels), series {name: [[x,
        y]]}, and perhaps log [x, y]."""
        chart = cls(plot["title"], plot["x"], plot["y"], plot.get("log", (True, True)))
        for name, points in plot["series"].items():
            chart.add(name, [tuple(point) for point in points])
        return chart

    def add(self, name, points):
        if points:
            self.series[name] = sorted(points)

    def svg(self, colors=None):
        if not self.series:
            raise ValueError(f"{self.title}: nothing to draw")
        points = [p for series in self.series.values() for p in series]
        x = Axis([p[0] for p in points], LEFT, WIDTH - RIGHT, self.is_log[0])
        y = Axis([p[1] for p in points], HEIGHT - BOTTOM, TOP, self.is_log[1])
        parts = [
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" '
            f'width="{WIDTH}" height="{HEIGHT}" role="img">',
            f"<title>{xml.sax.saxutils.escape(self.title)}</title><style>{STYLE}</style>",
            f'<rect class="back" width="{WIDTH}" height="{HEIGHT}"/>',
            text(LEFT, 26, self.title, 'class="title"'),
        ]
        parts += self.frame(x, y) + self.lines(x, y, colors or {}) + ["</svg>\n"]
        return "\n".join(parts)

    def frame(self, x, y):
        parts = []
        for tick in x.ticks():
            at = x.place(tick)
            parts.append(f'<path class="grid" d="M{at:.1f} {TOP}V{HEIGHT - BOTTOM}"/>')
            parts.append(text(at, HEIGHT - BOTTOM + 18, f"{tick:g}",
                              'class="tick" text-anchor="middle"'))
        for tick in y.ticks():
            at = y.place(tick)
            parts.append(f'<path class="grid" d="M{LEFT} {at:.1f}H{WIDTH - RIGHT}"/>')
            parts.append(text(LEFT - 8, at + 4, f"{tick:g}", 'class="tick" text-anchor="end"'))
        middle = 0.5 * (LEFT + WIDTH - RIGHT)
        parts.append(text(middle, HEIGHT - 14, self.labels[0], 'text-anchor="middle"'))
        up = 0.5 * (TOP + HEIGHT - BOTTOM)
        parts.append(text(20, up, self.labels[1],
                          f'text-anchor="middle" transform="rotate(-90 20 {up:.1f})"'))
        return parts

    def lines(self, x, y, colors):
        parts = []
        ends = spread([y.place(series[-1][1]) for series in self.series.values()], 17)
        for i, (name, series) in enumerate(self.series.items()):
            color = colors.get(name, COLORS[i % len(COLORS)])
            places = [(x.place(a), y.place(b)) for a, b in series]
            path = " ".join(f"{a:.1f},{b:.1f}" for a, b in places)
            parts.append(f'<polyline points="{path}" fill="none" stroke="{color}" '
                         f'stroke-width="2.2"/>')
            parts += [f'<circle cx="{a:.1f}" cy="{b:.1f}" r="3.6" fill="{color}"/>'
                      for a, b in places if len(places) <= MOST_DOTS]
            right = WIDTH - RIGHT + 12
            parts.append(f'<path d="M{places[-1][0] + 5:.1f} {places[-1][1]:.1f}L{right - 3} '
                         f'{ends[i]:.1f}" stroke="{color}" stroke-width="0.8" opacity="0.6"/>')
            parts.append(text(right, ends[i] + 4, name, f'style="fill:{color};font-weight:600"'))
        return parts

    def write(self, path, colors=None):
        """In one step: the file is whole or not there."""
        path = pathlib.Path(path)
        path.parent.mkdir(parents=True, exist_ok=True)
        temporary = path.with_suffix(".part")
        temporary.write_text(self.svg(colors), encoding="utf-8")
        os.replace(temporary, path)


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    Chart.from_json(json.loads(pathlib.Path(sys.argv[1]).read_text(encoding="utf-8"))).write(sys.argv[2])


if __name__ == "__main__":
    main()
