#!/usr/bin/env python3
"""Tests of sequences/benchmark and of what it writes to docs/."""

import contextlib
import io
import json
import pathlib
import subprocess
import sys
import unittest
import xml.etree.ElementTree

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path += [str(ROOT / "tests" / "bench"), str(ROOT / "sequences")]
sys.dont_write_bytecode = True

import report  # noqa: E402
import step_runner  # noqa: E402
from chart import Chart, spread  # noqa: E402
from folder_case import FolderTest  # noqa: E402

SVG = "{http://www.w3.org/2000/svg}"


class PapersTest(FolderTest):
    def test_claims_become_a_table_for_each_paper(self):
        claim = {"where": "Fig. 1", "claim": "fast", "paper": "1 ms", "ours": "2 ms", "verdict": "not"}
        for name in ("b2012", "a2011"):
            (self.folder / f"paper-{name}.json").write_text(json.dumps(
                {"paper": name, "title": f"Title of {name}", "paper_hardware": "a GPU",
                 "size": [8, 4], "frames": "0-7", "claims": [claim]}))
        text = report.sections(self.folder, self.folder)["papers"]
        self.assertIn("Title of a2011 (theirs: a GPU; here, where the paper gives no size, 8x4", text)
        self.assertIn("| --- | --- | --- | --- | --- |\n| Fig. 1 | fast | 1 ms | 2 ms | not |", text)
        self.assertLess(text.index("a2011"), text.index("b2012"))

    def test_without_reruns_there_is_no_section(self):
        self.assertNotIn("papers", report.sections(self.folder, self.folder))


class RunnerTest(FolderTest):
    def step(self, name, text="x", program=None):
        """Adds `text` to a file each time that it runs."""
        log = self.folder / f"{name}.count"
        command = ["sh", "-c", f"printf %s '{text}' >> '{log}'; echo result"]
        return step_runner.Step(name, 1, [program] if program else [],
                              [(command, self.folder / f"{name}.out")])

    def run_steps(self, *steps):
        state = step_runner.State(self.folder / "state.json")
        with contextlib.redirect_stderr(io.StringIO()) as err:
            step_runner.Runner(state, list(steps), self.folder).run_all()
        return err.getvalue()

    def count(self, name):
        return len((self.folder / f"{name}.count").read_text())

    def test_steps_run_once(self):
        said = self.run_steps(self.step("a"), self.step("b"))
        self.assertIn("2 min left, a", said)
        self.assertIn("1 min left, b", said)
        self.run_steps(self.step("a"), self.step("b"))
        self.assertEqual((self.count("a"), self.count("b")), (1, 1))
        self.assertEqual((self.folder / "a.out").read_text(), "result\n")

    def test_other_settings_and_programs_run_again(self):
        program = self.folder / "program"
        program.write_text("1")
        self.run_steps(self.step("a", "x", program))
        self.run_steps(self.step("a", "y", program))
        self.assertEqual(self.count("a"), 2)
        program.write_text("2")
        self.run_steps(self.step("a", "y", program))
        self.assertEqual(self.count("a"), 3)

    def test_a_failed_step_keeps_those_before_it_and_leaves_no_half_result(self):
        target = self.folder / "broken.out"
        broken = step_runner.Step("broken", 1, [], [(["sh", "-c", "echo half; exit 3"], target)])
        with self.assertRaises(SystemExit) as raised:
            self.run_steps(self.step("a"), broken)
        self.assertIn("ended with 3", str(raised.exception))
        self.assertFalse(target.exists())
        state = step_runner.State(self.folder / "state.json")
        self.assertTrue(state.is_done(self.step("a")))
        self.assertFalse(state.is_done(broken))

    def test_bar_counts_down(self):
        self.assertIn("." * 30, step_runner.bar(0, 10, 10, "a"))
        self.assertIn("#" * 15 + "." * 15 + "]    5 min left, a", step_runner.bar(5, 10, 5, "a"))
        self.assertIn("#" * 30, step_runner.bar(11, 10, 0, "a"))


class CommandTest(unittest.TestCase):
    def test_unknown_steps_and_options_end_with_one_line(self):
        for words, what in ((["--only", "quality,dinner"], "unknown step 'dinner'"),
                            (["--only", "scaling"], "bench_scaling: No such file"),
                            (["--pace", "fast"], "unrecognized arguments: --pace fast")):
            command = [sys.executable, str(ROOT / "sequences" / "benchmark"), "--programs", "none"]
            run = subprocess.run(command + words, capture_output=True, text=True, check=False)
            self.assertNotEqual(run.returncode, 0)
            self.assertIn(what, run.stderr.strip().splitlines()[-1])


class SectionTest(unittest.TestCase):
    TEXT = ("a\n<!-- benchmark:x -->\nold\n<!-- /benchmark:x -->\nb\n"
            "<!-- benchmark:y -->\n<!-- /benchmark:y -->\n")

    def test_replaces_between_its_marks_only(self):
        text = report.set_sections(self.TEXT, {"x": "new\n"})
        self.assertEqual(text, self.TEXT.replace("old", "new"))
        self.assertEqual(report.set_sections(text, {"x": "new"}), text)

    def test_missing_marks_are_named(self):
        for broken in (self.TEXT.replace("/benchmark:x", "/benchmark:z"), self.TEXT + self.TEXT, ""):
            with self.assertRaisesRegex(ValueError, "benchmark:x"):
                report.set_sections(broken, {"x": "new"})

    def test_the_pages_have_all_marks(self):
        names = ("quality", "roofline", "peer", "render", "compare", "ablation", "scaling", "targets")
        for page, marks in (("measurements.md", names), ("papers.md", ("papers",))):
            text = (ROOT / "docs" / page).read_text(encoding="utf-8")
            report.set_sections(text, {name: "new" for name in marks})


class ChartTest(FolderTest):
    def test_points_lie_where_their_logarithms_say(self):
        chart = Chart("error & time", "ms", "relMSE")
        chart.add("ours", [(1000, 0.01), (10, 1.0), (100, 0.1)])
        chart.write(self.folder / "deep" / "a.svg")
        root = xml.etree.ElementTree.parse(self.folder / "deep" / "a.svg").getroot()
        points = [tuple(map(float, p.split(","))) for p in
                  root.find(f"{SVG}polyline").get("points").split()]
        self.assertAlmostEqual(points[1][0] - points[0][0], points[2][0] - points[1][0], delta=0.2)
        self.assertAlmostEqual(points[1][1] - points[0][1], points[2][1] - points[1][1], delta=0.2)
        self.assertLess(points[0][0], points[2][0])
        self.assertLess(points[0][1], points[2][1])  # less error is lower
        words = [element.text for element in root.iter(f"{SVG}text")]
        for wanted in ("error & time", "ms", "relMSE", "ours", "100", "0.1"):
            self.assertIn(wanted, words)

    def test_draws_a_plot_in_json(self):
        plot = {"title": "t", "x": "frame", "y": "error", "log": [False, True],
                "series": {"a": [[0, 1e-6], [1, 1e-5]], "long": [[i, 1e-4] for i in range(61)]}}
        root = xml.etree.ElementTree.fromstring(Chart.from_json(plot).svg())
        self.assertEqual(len(root.findall(f"{SVG}polyline")), 2)
        self.assertEqual(len(root.findall(f"{SVG}circle")), 2, "long series have no dots")

    def test_labels_do_not_overlap(self):
        places = spread([10.0, 50.0, 12.0, 11.0], 17)
        self.assertEqual(places, [10.0, 61.0, 44.0, 27.0])

    def test_what_cannot_be_drawn_is_refused(self):
        with self.assertRaisesRegex(ValueError, "nothing to draw"):
            Chart("empty", "x", "y").svg()
        chart = Chart("zero", "x", "y")
        chart.add("a", [(1, 0.0)])
        with self.assertRaisesRegex(ValueError, "no place for 0"):
            chart.svg()


class ReportTest(FolderTest):
    def test_compare_draws_each_scene_and_marks_the_best(self):
        def cell(name, ms, error):
            return {"contender": name, "spp": 1, "cpu_ms": {"total": ms}, "mean": {"relmse": error}}

        results = {
            "settings": {"contenders": [{"label": "ours"}, {"label": "mean"}, {"label": "OIDN"}],
                         "ours": "ours", "width": 320, "height": 180, "frames": "40-43",
                         "spp": [1, 2]},
            "scenes": [{"name": "atrium, lights",
                        "cells": [cell("ours", 10, 0.02), cell("ours", 20, 0.01),
                                  cell("mean", 5, 0.16), cell("mean", 80, 0.01),
                                  cell("OIDN", 90, 0.01), cell("OIDN", 95, -0.001)]}]}
        path = self.folder / "results.json"
        path.write_text(json.dumps(results))
        text = report.compare(path, self.folder / "plots")
        # Half of the way from 5 to 80 ms by logarithms; OIDN is nowhere near.
        self.assertIn("| atrium, lights | 20 | **0.01** | 0.04 | - |", text)
        svg = (self.folder / "plots" / "error-time-atrium-lights.svg").read_text()
        root = xml.etree.ElementTree.fromstring(svg)
        # A figure below zero is noise of the references: it has no place on the plot.
        self.assertEqual([len(line.get("points").split()) for line in root.iter(f"{SVG}polyline")],
                         [2, 2, 1])

    def test_errors_are_read_off_the_curve_only(self):
        points = [(40.0, 0.1), (10.0, 0.4)]
        self.assertAlmostEqual(report.error_at(points, 20.0), 0.2)
        self.assertAlmostEqual(report.error_at(points, 10.0), 0.4)
        self.assertIsNone(report.error_at(points, 9.9))
        self.assertIsNone(report.error_at(points, 40.1))

    def test_ablation_sets_each_part_beside_the_whole(self):
        def cell(name, relmse, ms):
            return {"contender": name, "spp": 3, "cpu_ms": {"denoise": ms, "total": 2 * ms},
                    "mean": {"relmse": relmse, "temporal_error": 2 * relmse}}

        results = {"settings": {"contenders": [{"label": "ours", "method": "ours"},
                                               {"label": "ours-without-x", "without": "x"}],
                                "ours": "ours", "width": 8, "height": 4, "frames": "1-2", "spp": [3]},
                   "scenes": [{"name": "atrium", "cells": [cell("ours", 0.01, 10.0),
                                                           cell("ours-without-x", 0.02, 5.0)]}]}
        path = self.folder / "results.json"
        path.write_text(json.dumps(results))
        text = report.ablation(path)
        self.assertIn("| all parts | 0.01 (1.00) | 0.02 (1.00) | 10.0 (1.00) | 20 (1.00) |", text)
        self.assertIn("| without `x` | 0.02 (2.00) | 0.04 (2.00) | 5.0 (0.50) | 10 (0.50) |", text)

    def test_quality_is_a_table_of_methods_by_scenes(self):
        figures = {"atrium": {"noisy": {"relmse": 1.0}, "eigenlight": {"relmse": 0.01}},
                   "sponza": {"noisy": {"relmse": 0.5}, "eigenlight": {"relmse": 0.001}}}
        text = report.quality_pivot(figures, "relmse")
        self.assertIn("|  | atrium | crytek-sponza |", text)
        self.assertIn("| `eigenlight` | 0.01 (0.0100) | 0.001 (0.0020) |", text)


if __name__ == "__main__":
    unittest.main()
