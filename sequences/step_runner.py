"""Runs the steps of sequences/benchmark one after another: resumable, with time left."""

import hashlib
import json
import os
import pathlib
import shlex
import signal
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
POLL_SECONDS = 2.0


class Step:
    """Commands that leave a result, and what it depends on."""

    def __init__(self, name, minutes, programs, commands, environment=None):
        self.name, self.minutes, self.programs = name, minutes, programs
        self.commands, self.environment = commands, environment or {}

    def key(self):
        """Changes with the commands and with the programs that they time."""
        digest = hashlib.sha256(repr((self.commands, sorted(self.environment.items()))).encode())
        for program in self.programs:
            digest.update(pathlib.Path(program).read_bytes())
        return digest.hexdigest()


class State:
    """Which steps are done, and how long each took. Written in one step."""

    def __init__(self, path):
        self.path = path
        self.steps = json.loads(path.read_text()) if path.exists() else {}

    def is_done(self, step):
        return self.steps.get(step.name, {}).get("key") == step.key()

    def minutes(self, step):
        return self.steps.get(step.name, {}).get("minutes", step.minutes)

    def done(self, step, minutes):
        self.steps[step.name] = {"key": step.key(), "minutes": round(minutes, 2)}
        temporary = self.path.with_suffix(".part")
        temporary.write_text(json.dumps(self.steps, indent=1))
        os.replace(temporary, self.path)


def say(text):
    print(f"benchmark: {text}", file=sys.stderr, flush=True)


def bar(done, total, left, name):
    """One line: share of the time, time left, step."""
    share = min(1.0, done / total) if total > 0.0 else 1.0
    cells = round(30 * share)
    return f"[{'#' * cells}{'.' * (30 - cells)}] {left:4.0f} min left, {name}"


class Runner:
    """Runs steps one after another with a bar over all of them."""

    def __init__(self, state, steps, logs):
        self.state, self.logs = state, logs
        self.left = [step for step in steps if not state.is_done(step)]
        self.total = sum(map(state.minutes, self.left))
        self.before = 0.0  # minutes that finished steps were expected to take

    def run_all(self):
        while self.left:
            step = self.left[0]
            begin = time.monotonic()
            self.run(step, begin)
            self.before += self.state.minutes(step)
            self.state.done(step, (time.monotonic() - begin) / 60.0)
            self.left.pop(0)

    def show(self, step, begin):
        spent = min((time.monotonic() - begin) / 60.0, self.state.minutes(step))
        left = sum(map(self.state.minutes, self.left)) - spent
        line = bar(self.before + spent, self.total, left, step.name)
        if sys.stderr.isatty():
            print(f"\r\033[K{line}", end="", file=sys.stderr, flush=True)
        return line

    def run(self, step, begin):
        line = self.show(step, begin)
        if not sys.stderr.isatty():
            say(line)
        log = self.logs / f"{step.name}.log"
        with open(log, "w", encoding="utf-8") as out:
            for command in step.commands:
                self.run_command(step, command, begin, out)
        if sys.stderr.isatty():
            print("\r\033[K", end="", file=sys.stderr)

    def run_command(self, step, command, begin, out):
        words, target = command if isinstance(command, tuple) else (command, None)
        stdout = open(f"{target}.part", "w", encoding="utf-8") if target else out
        environment = dict(os.environ, **step.environment)
        # A group of its own, so that all of it ends with this program.
        process = subprocess.Popen(words, cwd=ROOT, stdout=stdout, stderr=out, env=environment,
                                   stdin=subprocess.DEVNULL, start_new_session=True)
        try:
            while process.poll() is None:
                self.show(step, begin)
                try:
                    process.wait(POLL_SECONDS)
                except subprocess.TimeoutExpired:
                    pass
        except KeyboardInterrupt:
            os.killpg(process.pid, signal.SIGTERM)
            process.wait()
            raise
        finally:
            if target:
                stdout.close()
        if process.returncode != 0:
            raise SystemExit(f"\nbenchmark: {step.name}: '{shlex.join(words)}' ended with "
                             f"{process.returncode}; what it printed: {out.name}")
        if target:
            os.replace(f"{target}.part", target)
