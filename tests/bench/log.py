#!/usr/bin/env python3
"""Keeps measurements by commit, and compares them.

log.py append RESULT.json [--log out/bench/log.jsonl]
    adds one line: commit, date, machine, and of each benchmark the values of every repetition
log.py compare OLD NEW [--alpha 0.05]
    of each benchmark in both: medians, change, and the p of the U test over repetitions. OLD and NEW
    are result files, or LOG.jsonl:COMMIT (the last line of that commit), or LOG.jsonl:-1 (the last
    line). Compared are ratios to the floor measured in the same run: they do not move with the
    machine's other work as times do. Exit status 3 if anything is slower for certain.

Run benchmarks with --benchmark_repetitions=9 or more: fewer cannot show small differences.
"""

import argparse
import datetime
import json
import os
import pathlib
import statistics
import subprocess
import sys

from results import load_json, load_results
from utest import u_test

KEPT = ("cpu_ms", "ratio", "fma_ratio")
SLOWER = 3


def git(*words):
    run = subprocess.run(["git", *words], capture_output=True, text=True, check=False)
    return run.stdout.strip()


def samples(path):
    """Counter values of each benchmark in a result file, one for each repetition."""
    found = {}
    for result in load_results(path):
        kept = found.setdefault(result.name, {})
        for counter in KEPT:
            if result.get(counter) is not None:
                kept.setdefault(counter, []).append(result[counter])
    return found


def entry(path):
    context = load_json(path)["context"]
    return {
        "commit": git("rev-parse", "HEAD"),
        "changed": bool(git("status", "--porcelain", "--untracked-files=no")),
        "date": datetime.datetime.now(datetime.timezone.utc).isoformat(timespec="seconds"),
        "cpus": context.get("num_cpus"),
        "mhz": context.get("mhz_per_cpu"),
        "benchmarks": samples(path),
    }


def append(result, log):
    """One whole line at the end of the log."""
    line = json.dumps(entry(result), separators=(",", ":")) + "\n"
    log.parent.mkdir(parents=True, exist_ok=True)
    with open(log, "a", encoding="utf-8") as file:
        file.write(line)
        file.flush()
        os.fsync(file.fileno())


def load(source):
    """Benchmarks of a result file, or of a line of a log."""
    path, colon, commit = source.rpartition(":")
    if not colon:
        return samples(source)
    try:
        lines = pathlib.Path(path).read_text(encoding="utf-8").splitlines()
        entries = [json.loads(line) for line in lines if line]
    except (OSError, ValueError) as error:
        sys.exit(f"{path}: {error}")
    if commit != "-1":
        entries = [e for e in entries if commit and e["commit"].startswith(commit)]
    if not entries:
        sys.exit(f"{path}: no line of commit '{commit}'")
    return entries[-1]["benchmarks"]


def compare(old, new, alpha):
    """Prints a table; returns how many benchmarks are slower for certain."""
    names = [name for name in old if name in new]
    if not names:
        sys.exit("the two have no benchmark in common")
    print("| benchmark | old ratio | new ratio | change | p | |")
    print("| --- | ---: | ---: | ---: | ---: | --- |")
    slower = 0
    for name in names:
        a, b = old[name]["ratio"], new[name]["ratio"]
        before, after, p = statistics.median(a), statistics.median(b), u_test(a, b)
        verdict = "" if p >= alpha else "slower" if after > before else "faster"
        slower += verdict == "slower"
        print(f"| {name} | {before:.3g} | {after:.3g} | {100 * (after / before - 1):+.1f} % "
              f"| {p:.2g} | {verdict} |")
    return slower


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    add = commands.add_parser("append")
    add.add_argument("result")
    add.add_argument("--log", type=pathlib.Path, default=pathlib.Path("out/bench/log.jsonl"))
    two = commands.add_parser("compare")
    two.add_argument("old")
    two.add_argument("new")
    two.add_argument("--alpha", type=float, default=0.05)
    options = parser.parse_args()
    if options.command == "append":
        append(options.result, options.log)
        return 0
    return SLOWER if compare(load(options.old), load(options.new), options.alpha) else 0


if __name__ == "__main__":
    sys.exit(main())
