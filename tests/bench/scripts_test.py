#!/usr/bin/env python3
"""Tests of the scripts in this folder."""

import json
import pathlib
import subprocess
import sys
import unittest

HERE = pathlib.Path(__file__).parent
sys.path.insert(0, str(HERE))

import peer  # noqa: E402
import table  # noqa: E402
from folder_case import FolderTest  # noqa: E402
from results import load_results  # noqa: E402


def benchmark(stage, ratio, height=720, **changes):
    """An entry as google/benchmark writes it: K = 5 at `ratio` times the copy's 10 ms."""
    name = f"{stage}/height:{height}/bases:5/threads:1/target:0/manual_time"
    entry = {"name": name, "run_name": name, "run_type": "iteration", "label": "AVX3",
             "bytes": 2e8, "copy_ms": 10.0, "cpu_ms": 10.0 * ratio, "ratio": ratio,
             "ns_per_pixel": 20.0, "pixels_per_second": 5e7}
    entry.update(changes)
    return entry


class PeerTest(FolderTest):
    def program(self, name, text):
        path = self.folder / name
        path.write_text(f"#!/bin/sh\n{text}\n")
        path.chmod(0o755)
        return str(path)

    def test_least_times_of_all_turns_stand_side_by_side(self):
        # Each prints the next of its times; ours waits for none of the peer's.
        theirs = self.program("peer", f"""cd {self.folder}; n=$(cat n 2>/dev/null || echo 0)
echo $((n + 1)) > n; set -- 3000 2000 2500; shift $n; echo "cpu ms: min $1  median 1.0" """)
        entries = [benchmark(stage, 20.0 / (i + 1), height=36) for i, stage in enumerate(peer.STAGES)]
        (self.folder / "results.json").write_text(json.dumps({"benchmarks": entries}))
        ours = self.program("bench", f"""for a; do case $a in --benchmark_out=*)
cp {self.folder}/results.json ${{a#*=}};; esac; done""")
        run = subprocess.run([sys.executable, str(HERE / "peer.py"), ours, theirs, "36",
                              "--turns", "3"], capture_output=True, text=True, check=True)
        self.assertIn("| 64x36 | 2000 | 200.0 | 10.0 | 100.0 | 20.0 |", run.stdout)

    def test_a_peer_that_fails_or_is_silent_is_named(self):
        for text, what in (("echo broken >&2; exit 3", "broken"), ("echo hello", "no CPU time")):
            with self.assertRaises(SystemExit) as raised:
                peer.peer_ms(self.program("peer", text), "64x36")
            self.assertIn(what, str(raised.exception))


class ScriptTest(FolderTest):
    def write(self, name, entries):
        path = self.folder / name
        path.write_text(json.dumps({"context": {"num_cpus": 2}, "benchmarks": entries}))
        return str(path)

    def test_roofline_takes_the_closer_floor(self):
        fast = benchmark("update", 3.0)
        bound = benchmark("atrous", 18.0, flops=4e9, peak_gflops=100.0, fma_ratio=4.5)
        text = table.roofline(load_results(self.write("a.json", [fast, bound])), None, None)
        self.assertIn("| update | 1280x720 | 5 | 1 | copy 200 MB | 10.00 | 30.0 | 3.0 | 50.0 |", text)
        self.assertIn("| atrous | 1280x720 |  | 1 | 4.00 GFLOP at 100 GFLOP/s | 40.00 | 180.0 | 4.5 |",
                      text)

    def test_loop_shows_shares(self):
        times = {f"{stage}_ms": 25.0 for stage in table.LOOP_STAGES}
        path = self.write("a.json", [benchmark("loop_stages", 10.0, **times)])
        text = table.loop(load_results(path), [720], [5])
        self.assertIn("| 1280x720 | 5 | 100.0 | 25.0 (25 %) |", text)

    def test_repetitions_count_once_by_their_median(self):
        path = self.write("a.json", [benchmark("update", r) for r in (9.0, 3.0, 2.0)])
        text = table.roofline(load_results(path), [720], [5])
        self.assertEqual(len(text.splitlines()), 3)
        self.assertIn("| 3.0 |", text)

    def test_rays_are_shown_per_cpu_second_and_per_second(self):
        entry = {"name": "indirect_atrium/real_time", "rays": 3e6, "real_time": 1.0, "cpu_time": 2.0,
                 "rays_per_sample": 2.5}
        text = table.render([entry, {"name": "antialias_none"}, dict(entry, error_occurred=True)])
        self.assertEqual(text.splitlines()[2:], ["| atrium | 1.50 | 3.00 | 2.50 |"])

    def test_bad_results_are_one_line(self):
        failed = benchmark("update", 1.0, error_occurred=True, error_message="no energy")
        (self.folder / "text").write_text("no json")
        for path, what in ((self.write("a", [failed]), "no energy"), (self.write("b", []), "no meas"),
                           (str(self.folder / "text"), "no JSON"), ("missing.json", "No such file")):
            command = [sys.executable, str(HERE / "table.py"), "roofline", path]
            run = subprocess.run(command, capture_output=True, text=True, check=False)
            self.assertEqual(run.returncode, 1)
            self.assertIn(what, run.stderr)
            self.assertEqual(len(run.stderr.strip().splitlines()), 1)


if __name__ == "__main__":
    unittest.main()
