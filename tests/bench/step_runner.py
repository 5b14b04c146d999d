"""Runs the steps of sequences/benchmark one after another: restartable, with time left."""

import hashlib
import json
import os
import pathlib
import shlex
import signal
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
POLL_SECONDS = 2.0
SHOWN_WIDTH = 110  # columns


class Command:
    """A program with its words, run in ROOT; what it prints goes to the file `target`, if any."""

    def __init__(self, words, target=None, environment=None):
        self.words = [str(word) for word in words]
        self.target, self.environment = target, environment or {}

    def shown(self, replaced=()):
        """As one types it, over several lines if it is long. `replaced` are pairs of texts."""
        lines = [""]
        for word in [f"{name}={shlex.quote(value)}" for name, value in sorted(self.environment.items())] + [
                shlex.quote(word) for word in self.words]:
            for text, by in replaced:
                word = word.replace(text, by)
            if len(lines[-1]) + len(word) > SHOWN_WIDTH and lines[-1].strip():
                lines[-1] += " \\"
                lines.append(" ")
            lines[-1] += f" {word}" if lines[-1] else word
        return "\n".join(lines)


class Section:
    """A section of docs/measurements.md: what `commands` print, below a few words. `pictures`, given
    the folder docs, writes them there and returns pairs of description and path within it."""

    def __init__(self, title, words, commands, pictures=lambda docs: []):
        self.title, self.words, self.commands, self.pictures = title, words, commands, pictures


class Step:
    """Commands that leave results, the sections that show them, and the programs they time."""

    def __init__(self, name, minutes, programs, sections):
        self.name, self.minutes, self.programs, self.sections = name, minutes, programs, sections
        self.commands = []
        for command in (command for section in sections for command in section.commands):
            if command not in self.commands:
                self.commands.append(command)

    def key(self):
        """Changes with the commands and with the programs that they time."""
        told = [(c.words, str(c.target), sorted(c.environment.items())) for c in self.commands]
        digest = hashlib.sha256(repr(told).encode())
        for program in self.programs:
            digest.update(pathlib.Path(program).read_bytes())
        return digest.hexdigest()


class State:
    """Which steps are done, how long each took, and the facts of its run. Written in one step."""

    def __init__(self, path):
        self.path = path
        self.steps = json.loads(path.read_text()) if path.exists() else {}

    def is_done(self, step):
        return self.steps.get(step.name, {}).get("key") == step.key()

    def minutes(self, step):
        return self.steps.get(step.name, {}).get("minutes", step.minutes)

    def facts(self, step):
        return self.steps[step.name]["facts"]

    def done(self, step, minutes, facts):
        self.steps[step.name] = {"key": step.key(), "minutes": round(minutes, 2), "facts": facts}
        write_whole(self.path, json.dumps(self.steps, indent=1))


def write_whole(path, text):
    """In one step: the file is whole or as it was."""
    temporary = path.with_suffix(".part")
    temporary.write_text(text, encoding="utf-8")
    os.replace(temporary, path)


def say(text):
    print(f"benchmark: {text}", file=sys.stderr, flush=True)


def bar(done, total, left, name):
    """One line: share of the time, time left, step."""
    share = min(1.0, done / total) if total > 0.0 else 1.0
    cells = round(30 * share)
    return f"[{'#' * cells}{'.' * (30 - cells)}] {left:4.0f} min left, {name}"


class Runner:
    """Runs steps one after another with a bar over all of them; `facts()` tells the day and the like."""

    def __init__(self, state, steps, logs, facts=dict):
        self.state, self.logs, self.facts = state, logs, facts
        self.left = [step for step in steps if not state.is_done(step)]
        self.total = sum(map(state.minutes, self.left))
        self.before = 0.0  # minutes that finished steps were expected to take

    def run_all(self):
        while self.left:
            step = self.left[0]
            begin = time.monotonic()
            self.run(step, begin)
            self.before += self.state.minutes(step)
            self.state.done(step, (time.monotonic() - begin) / 60.0, self.facts())
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
        target = command.target
        stdout = open(f"{target}.part", "w", encoding="utf-8") if target else out
        environment = dict(os.environ, **command.environment)
        # A group of its own, so that all of it ends with this program.
        process = subprocess.Popen(command.words, cwd=ROOT, stdout=stdout, stderr=out, env=environment,
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
            raise SystemExit(f"\nbenchmark: {step.name}: '{shlex.join(command.words)}' ended with "
                             f"{process.returncode}; what it printed: {out.name}")
        if target:
            os.replace(f"{target}.part", target)
