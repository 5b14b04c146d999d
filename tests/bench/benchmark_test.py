#!/usr/bin/env python3
"""Tests of sequences/benchmark and of the document that it writes."""

import contextlib
import io
import json
import pathlib
import subprocess
import sys
import unittest
import xml.etree.ElementTree

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "bench"))
sys.dont_write_bytecode = True

import report  # noqa: E402
from chart import Chart, spread  # noqa: E402
from folder_case import FolderTest  # noqa: E402
from step_runner import Command, Runner, Section, State, Step, bar  # noqa: E402

SVG = "{http://www.w3.org/2000/svg}"
FACTS = {"date": "2026-01-02", "commit": "commit abc", "machine": "a CPU"}


class RunnerTest(FolderTest):
    def step(self, name, text="x", program=None):
        """Adds `text` to a file each time that it runs, and prints a result."""
        log = self.folder / f"{name}.count"
        command = Command(["sh", "-c", f"printf %s '{text}' >> '{log}'; echo result"],
                          self.folder / f"{name}.out")
        return Step(name, 1, [program] if program else [], [Section(name, "", [command])])

    def run_steps(self, *steps):
        state = State(self.folder / "state.json")
        with contextlib.redirect_stderr(io.StringIO()) as err:
            Runner(state, list(steps), self.folder, lambda: FACTS).run_all()
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
        self.assertEqual(State(self.folder / "state.json").facts(self.step("a")), FACTS)

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
        command = Command(["sh", "-c", "echo half; exit 3"], target)
        broken = Step("broken", 1, [], [Section("broken", "", [command])])
        with self.assertRaises(SystemExit) as raised:
            self.run_steps(self.step("a"), broken)
        self.assertIn("ended with 3", str(raised.exception))
        self.assertFalse(target.exists())
        state = State(self.folder / "state.json")
        self.assertTrue(state.is_done(self.step("a")))
        self.assertFalse(state.is_done(broken))

    def test_a_command_of_several_sections_runs_once(self):
        shared = self.step("a").commands[0]
        step = Step("a", 1, [], [Section("one", "", [shared]), Section("two", "", [shared])])
        self.run_steps(step)
        self.assertEqual(self.count("a"), 1)

    def test_bar_counts_down(self):
        self.assertIn("." * 30, bar(0, 10, 10, "a"))
        self.assertIn("#" * 15 + "." * 15 + "]    5 min left, a", bar(5, 10, 5, "a"))
        self.assertIn("#" * 30, bar(11, 10, 0, "a"))


class CommandTest(unittest.TestCase):
    def test_unknown_steps_and_options_end_with_one_line(self):
        for words, what in ((["--only", "quality,dinner"], "unknown step 'dinner'"),
                            (["--only", "scaling"], "bench_scaling: No such file"),
                            (["--pace", "fast"], "unrecognized arguments: --pace fast")):
            command = [sys.executable, str(ROOT / "sequences" / "benchmark"), "--programs", "none",
                       "--docs", "none"]
            run = subprocess.run(command + words, capture_output=True, text=True, check=False)
            self.assertNotEqual(run.returncode, 0)
            self.assertIn(what, run.stderr.strip().splitlines()[-1])

    def test_commands_are_shown_as_one_types_them(self):
        command = Command(["/home/me/peer", "a b", 3], None, {"SIZE": "36"})
        self.assertEqual(command.shown([("/home/me/peer", "$(peer)")]), "SIZE=36 $(peer) 'a b' 3")
        long = Command(["x" * 60, "y" * 60, "z"]).shown()
        self.assertEqual(long, "x" * 60 + " \\\n  " + "y" * 60 + " z")


class DocumentTest(FolderTest):
    def setUp(self):
        super().setUp()
        self.path = self.folder / "docs" / "measurements.md"
        self.path.parent.mkdir()

    def write(self, name, printed, date, titles=("A: one", "B")):
        """Runs one step that prints `printed` and writes the document."""
        title = {"a": "A: one", "b": "B"}[name]
        command = Command(["echo", printed], self.folder / f"{name}.md")
        step = Step(name, 1, [], [Section(title, "Words.", [command], self.draw)])
        state = State(self.folder / "state.json")
        with contextlib.redirect_stderr(io.StringIO()) as err:
            Runner(state, [step], self.folder, lambda: dict(FACTS, date=date)).run_all()
            report.write(self.path, [step], titles, state, [])
        return err.getvalue()

    def draw(self, docs):
        (docs / "x.svg").write_text("<svg/>")
        return [("a plot", "x.svg")]

    def test_holds_head_contents_commands_results_and_plots(self):
        self.write("a", "| 1 |", "2026-01-02")
        text = self.path.read_text()
        self.assertTrue(text.startswith("# Measurements\n\n"))
        self.assertIn(f"| machine | {report.facts()['machine']} |", text)
        self.assertIn("- [A: one](#a-one)\n", text)
        self.assertIn("## A: one\n\nWords.\n\nMeasured 2026-01-02, commit abc, on a CPU:\n\n"
                      "```sh\necho '| 1 |'\n```\n\n| 1 |\n\n![a plot](x.svg)\n", text)
        self.assertTrue((self.path.parent / "x.svg").exists())

    def test_steps_that_were_not_run_keep_their_sections(self):
        self.write("b", "old b", "2026-01-01")
        self.write("a", "new a", "2026-01-02")
        text = self.path.read_text()
        self.assertLess(text.index("new a"), text.index("old b"))  # in the order of the steps
        self.assertIn("Measured 2026-01-01", text)
        self.write("b", "new b", "2026-01-03")
        self.assertNotIn("old b", self.path.read_text())
        self.assertNotIn("2026-01-01", self.path.read_text())

    def test_sections_that_no_step_prints_are_dropped_aloud(self):
        self.write("b", "b", "2026-01-01")
        said = self.write("a", "a", "2026-01-02", titles=("A: one",))
        self.assertIn("no step prints the section 'B': dropped", said)
        self.assertNotIn("## B", self.path.read_text())

    def test_every_step_has_a_section_of_its_own_title(self):
        text = (ROOT / "sequences" / "benchmark").read_text(encoding="utf-8")
        space = {"__name__": "benchmark", "__file__": str(ROOT / "sequences" / "benchmark")}
        exec(compile(text, "benchmark", "exec"), space)  # it has no suffix to be imported by
        old = sys.argv
        sys.argv = ["benchmark", "--programs", "none"]
        self.addCleanup(setattr, sys, "argv", old)
        with contextlib.redirect_stderr(io.StringIO()):
            titles = space["all_titles"](space["parse"]())
        self.assertEqual(len(set(titles)), len(titles))
        self.assertGreaterEqual(len(titles), len(space["NAMES"]))


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

    def test_empty_charts_and_values_without_logarithm_are_refused(self):
        with self.assertRaisesRegex(ValueError, "nothing to draw"):
            Chart("empty", "x", "y").svg()
        chart = Chart("zero", "x", "y")
        chart.add("a", [(1, 0.0)])
        with self.assertRaisesRegex(ValueError, "no place for 0"):
            chart.svg()

    def test_error_against_time_has_a_plot_for_each_scene(self):
        def cell(name, ms, error):
            return {"contender": name, "spp": 1, "cpu_ms": {"total": ms}, "mean": {"relmse": error}}

        results = {
            "settings": {"contenders": [{"label": "ours"}, {"label": "mean"}, {"label": "OIDN"}]},
            "scenes": [{"name": "atrium-lights",
                        "cells": [cell("ours", 10, 0.02), cell("ours", 20, 0.01),
                                  cell("mean", 5, 0.16), cell("mean", 80, 0.01),
                                  cell("OIDN", 90, 0.01), cell("OIDN", 95, -0.001)]}]}
        path = self.folder / "results.json"
        path.write_text(json.dumps(results))
        drawn = report.error_time_plots(path)(self.folder)
        self.assertEqual(drawn, [("atrium-lights: relMSE against CPU time", "plots/error-time-atrium-lights.svg")])
        root = xml.etree.ElementTree.parse(self.folder / drawn[0][1]).getroot()
        # A figure below zero is noise of the references: it has no place on the plot.
        self.assertEqual([len(line.get("points").split()) for line in root.iter(f"{SVG}polyline")],
                         [2, 2, 1])


if __name__ == "__main__":
    unittest.main()
