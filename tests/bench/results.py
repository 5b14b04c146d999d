"""Results of google/benchmark as the programs in this folder write them."""

import json
import re
import sys

NAME = re.compile(r"(\w+)/height:(\d+)/(bases|radius):(\d+)/threads:(\d+)/target:(\d+)")
WITHOUT_BASES = {"innovation", "budget", "atrous", "soft_atrous", "guided"}


class Result:
    """One measurement: what was timed, under which arguments, and its counters."""

    def __init__(self, entry):
        self.name = re.sub(r"/manual_time$", "", entry["run_name"])
        stage, height, kind, value, threads, target = NAME.match(self.name).groups()
        self.stage, self.kind, self.value = stage, kind, int(value)
        self.height, self.threads, self.target = int(height), int(threads), int(target)
        self.target_name = entry["label"]
        self.counters = entry

    def __getitem__(self, counter):
        return self.counters[counter]

    def get(self, counter):
        return self.counters.get(counter)

    @property
    def pixels(self):
        return self.height * 16 // 9 * self.height

    @property
    def size(self):
        return f"{self.height * 16 // 9}x{self.height}"

    @property
    def bases(self):
        return "" if self.stage in WITHOUT_BASES else str(self.value)


def load_json(path):
    """The object in a file; ends the program with one line if it cannot be read."""
    try:
        with open(path, encoding="utf-8") as file:
            return json.load(file)
    except OSError as error:
        sys.exit(f"{path}: {error.strerror}")
    except ValueError as error:
        sys.exit(f"{path}: no JSON: {error}")


def load_results(path):
    """All measurements of stages in a file, repetitions one by one. Ends the program on a failed one."""
    found = []
    for entry in load_json(path).get("benchmarks", []):
        if entry.get("error_occurred"):
            sys.exit(f"{path}: {entry['name']}: {entry['error_message']}")
        if entry.get("run_type") == "iteration" and NAME.match(entry["name"]):
            found.append(Result(entry))
    if not found:
        sys.exit(f"{path}: no measurement of a stage")
    return found
