#!/usr/bin/env python3
"""Tests of the scripts in this folder."""

import contextlib
import io
import itertools
import json
import math
import pathlib
import random
import subprocess
import sys
import unittest

HERE = pathlib.Path(__file__).parent
sys.path.insert(0, str(HERE))

import log  # noqa: E402
import peer  # noqa: E402
import table  # noqa: E402
from folder_case import FolderTest  # noqa: E402
from results import load_results  # noqa: E402
from utest import arrangements, ranks, u_test  # noqa: E402


def counted_p(a, b):
    """The p of the U test by trying all ways to deal the values into two samples."""
    values = list(a) + list(b)

    def u(first):
        rest = [i for i in range(len(values)) if i not in first]
        return sum(values[i] > values[j] for i in first for j in rest)

    observed = u(tuple(range(len(a))))
    distance = abs(observed - len(a) * len(b) / 2)
    deals = list(itertools.combinations(range(len(values)), len(a)))
    as_far = sum(abs(u(deal) - len(a) * len(b) / 2) >= distance for deal in deals)
    return as_far / len(deals)


class UTest(unittest.TestCase):
    def test_ties_share_ranks(self):
        self.assertEqual(ranks([3.0, 1.0, 3.0, 2.0, 3.0]), [4.0, 1.0, 4.0, 2.0, 4.0])

    def test_arrangements_are_complete_and_symmetric(self):
        for n, m in ((1, 1), (3, 5), (9, 9)):
            counts = arrangements(n, m)
            self.assertEqual(sum(counts), math.comb(n + m, n))
            self.assertEqual(counts, counts[::-1])

    def test_known_values(self):
        # P(U <= u), as in the table of Mann and Whitney 1947: 4 of 70 orders, 7 of 126, 12 of 252.
        for n, m, u, p in ((4, 4, 2, 0.0571), (4, 5, 3, 0.0556), (5, 5, 4, 0.0476)):
            counts = arrangements(n, m)
            self.assertAlmostEqual(sum(counts[: u + 1]) / sum(counts), p, places=4)
        self.assertAlmostEqual(u_test([1, 2, 3], [4, 5, 6]), 0.1)

    def test_agrees_with_counting(self):
        rng = random.Random(1)
        for n, m in ((1, 4), (3, 3), (4, 5), (5, 5)):
            for shift in (0.0, 0.5, 2.0):
                a = [rng.random() for _ in range(n)]
                b = [rng.random() + shift for _ in range(m)]
                self.assertAlmostEqual(u_test(a, b), counted_p(a, b), places=12)

    def test_approximation_meets_the_exact_value(self):
        rng = random.Random(2)
        a = [rng.random() for _ in range(20)]
        b = [rng.random() + 0.2 for _ in range(20)]
        exact = u_test(a, b)
        # One value more is beyond the exact range; a tie in the middle as well.
        self.assertAlmostEqual(u_test(a + [0.55], b + [0.55]), exact, delta=0.02)

    def test_equal_samples_are_equal(self):
        self.assertEqual(u_test([1.0] * 9, [1.0] * 9), 1.0)
        self.assertGreater(u_test([1.0, 2.0, 3.0], [1.0, 2.0, 3.0]), 0.9)
        with self.assertRaises(ValueError):
            u_test([], [1.0])


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

    def compare(self, old, new):
        with contextlib.redirect_stdout(io.StringIO()) as out:
            slower = log.compare(log.load(old), log.load(new), 0.05)
        return slower, out.getvalue()

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

    def test_log_keeps_repetitions_and_finds_commits(self):
        path = self.write("a.json", [benchmark("update", r) for r in (2.0, 2.1)])
        lines = self.folder / "deep" / "log.jsonl"
        log.append(path, lines)
        log.append(self.write("b.json", [benchmark("update", 4.0)]), lines)
        first, second = (json.loads(line) for line in lines.read_text().splitlines())
        self.assertEqual(first["cpus"], 2)
        name = "update/height:720/bases:5/threads:1/target:0"
        self.assertEqual(first["benchmarks"][name]["ratio"], [2.0, 2.1])
        self.assertEqual(log.load(f"{lines}:-1"), second["benchmarks"])
        if second["commit"]:
            self.assertEqual(log.load(f"{lines}:{second['commit'][:8]}"), second["benchmarks"])
        with self.assertRaises(SystemExit):
            log.load(f"{lines}:0123456789")

    def test_slower_is_told_from_noise(self):
        rng = random.Random(3)
        runs = {
            name: self.write(name, [benchmark("update", centre + 0.1 * rng.random()) for _ in range(9)])
            for name, centre in (("old", 2.0), ("same", 2.0), ("slow", 2.2), ("fast", 1.8))
        }
        self.assertEqual(self.compare(runs["old"], runs["same"])[0], 0)
        slower, text = self.compare(runs["old"], runs["slow"])
        self.assertEqual(slower, 1)
        self.assertIn("slower", text)
        slower, text = self.compare(runs["old"], runs["fast"])
        self.assertEqual(slower, 0)
        self.assertIn("faster", text)

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
