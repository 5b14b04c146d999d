#!/usr/bin/env python3
"""Checks the shape of the code: check.py ROOT prints each fault as file:line: what, and exits 1.

Folders include downwards only, third-party libraries stay behind the files that are meant to
include them, files and functions stay short, headers have #pragma once, no flag that changes
floating point, and every source is formatted as .clang-format says.
"""

import collections
import fnmatch
import pathlib
import re
import shutil
import subprocess
import sys

# Rooms: folders, and single headers that stand below the rest of their folder. A file belongs to the
# longest room that its path starts with, and may include that room, those named here, and whatever
# these may include.
ROOMS = {
    "frame": [],
    "reproject": ["frame"],
    "spatial": ["frame"],
    "spatial/rivals": ["spatial"],
    "spatial/training": ["spatial/rivals"],
    "temporal/frame_report.h": [],
    "temporal/denoiser.h": ["frame", "temporal/frame_report.h"],
    "temporal/stage_clock.h": ["temporal/denoiser.h"],
    "temporal/bases": ["reproject"],
    "temporal/change": ["spatial", "temporal/bases"],
    "temporal/samples": ["temporal/bases", "temporal/stage_clock.h"],
    "temporal/eigen": ["temporal/change", "temporal/samples"],
    "temporal/gather": ["spatial", "temporal/stage_clock.h"],
    "temporal/baselines": ["spatial/rivals", "temporal/samples"],
    "temporal": ["temporal/eigen", "temporal/baselines"],
    "render/scene": ["frame"],
    "render/loading": ["render/scene", "sequences/exr"],
    "render/builtin": ["render/scene"],
    "render/rays": ["render/scene"],
    "render/lights": ["render/rays"],
    "render/paths": ["render/lights"],
    "render/antialias": ["render/paths"],
    "render": ["render/antialias", "render/builtin", "render/loading"],
    "sequences/files/atomic_file.h": [],
    "sequences/exr": ["frame", "sequences/files/atomic_file.h"],
    "sequences/files": ["sequences/exr"],
    "sequences/conventions": ["frame"],
    "sequences/runs": ["sequences/files", "render", "temporal"],
    "sequences/metrics": ["sequences/files"],
    "sequences/stress": ["sequences/runs"],
    "sequences/pages": ["sequences/metrics", "temporal/frame_report.h"],
    "sequences/layers": ["sequences/exr"],
    "sequences/denoise": ["sequences/conventions", "sequences/layers", "sequences/pages",
                          "temporal/gather"],
    "sequences/compare": ["sequences/denoise", "sequences/runs"],
    "sequences/lab": ["sequences/compare", "sequences/stress", "spatial/training"],
    "sequences/cli": ["sequences/lab"],
    "tests": ["sequences/cli", "sequences/conventions"],
}
FOLDERS = sorted({room.split("/")[0] for room in ROOMS})

THIRD_PARTY = [  # (includes, files that may have them)
    (r"(tbb|oneapi)/", ["frame/tiles.cpp"]),
    (r"embree\d/", ["render/rays/embree_*"]),
    (r"assimp/", ["render/loading/scene_file*"]),
    (r"OpenImageIO/", ["sequences/files/ldr_image.cpp", "render/loading/image_file.cpp"]),
    (r"(OpenEXR|Imath)/", ["sequences/exr/*"]),
    (r"hwy/", ["*_simd.cpp", "*-inl.h"]),
    (r"fmt/", ["*.cpp"]),  # headers that others include need no fmt
    (r"CLI/", ["sequences/cli/*"]),
    (r"nlohmann/", ["sequences/*", "render/loading/scene_file*"]),
    (r"xxhash", ["sequences/*"]),
]

MAX_LINES = 300
MAX_FUNCTION = 40  # lines, from the name to the closing brace
MAX_SOURCES = 40  # that stand directly in one folder
INCLUDE = re.compile(r'^\s*#\s*include\s+(?:"([^"]+)"|<([^>]+)>)')
BANNED_FLAG = re.compile(r"-ffast-math|-Ofast|-march|-funsafe-math")


def cpp_files(root):
    for folder in FOLDERS:
        for path in sorted((root / folder).rglob("*")):
            if path.suffix in (".h", ".cpp"):
                yield path, path.relative_to(root).as_posix()


def room_of(name):
    """The longest room that `name` starts with, or None."""
    while name and name not in ROOMS:
        name = name.rpartition("/")[0]
    return name or None


def reachable(room):
    """All rooms that `room` may include: itself, and those below it."""
    found, waiting = set(), [room]
    while waiting:
        here = waiting.pop()
        if here not in found:
            found.add(here)
            waiting += ROOMS[here]
    return found


def include_faults(name, lines):
    room = room_of(name)
    below = reachable(room) if room else set()
    for number, line in enumerate(lines, 1):
        match = INCLUDE.match(line)
        if not match:
            continue
        ours, theirs = match.groups()
        if ours and ours.split("/")[0] not in FOLDERS:
            yield f'{name}:{number}: "{ours}" does not start at the root of the project'
        elif ours and room_of(ours) not in below:
            yield f"{name}:{number}: {room}/ must not include {room_of(ours) or ours}/"
        included = ours or theirs
        for pattern, allowed in THIRD_PARTY:
            # Tests may look at files with whatever reads them.
            if room == "tests" or not re.match(pattern, included):
                continue
            if not any(fnmatch.fnmatch(name, entry) for entry in allowed):
                yield f"{name}:{number}: <{included}> belongs in {', '.join(allowed)} only"


def crowding_faults(names):
    count = collections.Counter(name.rpartition("/")[0] for name in names)
    for folder, sources in sorted(count.items()):
        if sources > MAX_SOURCES:
            yield f"{folder}:1: {sources} sources in one folder, at most {MAX_SOURCES}"


def length_faults(name, lines):
    if len(lines) > MAX_LINES:
        yield f"{name}:{len(lines)}: longer than {MAX_LINES} lines"


def indentation(line):
    return len(line) - len(line.lstrip())


def functions(lines):
    """(first, last) line number from 0 of each function, told by indentation as clang-format sets
    it: the last is a lone brace, the first the nearest line before that stands no further right.
    Classes, tables and lambdas end with "};" and so are none."""
    last = len(lines) - 1
    while last > 0:
        first = last - 1
        if lines[last].strip() == "}":
            edge = indentation(lines[last])
            while first > 0 and (not lines[first].strip() or lines[first].startswith("#")
                                 or indentation(lines[first]) > edge):
                first -= 1
            yield first, last
            first -= 1
        last = first


def function_faults(name, lines):
    for first, last in functions(lines):
        count = last - first + 1
        if count > MAX_FUNCTION:
            title = lines[first].strip().removesuffix(" {")
            yield f"{name}:{first + 1}: {count} lines in one function, at most {MAX_FUNCTION}: {title}"


def header_faults(name, lines):
    # Headers named -inl.h are compiled once for each instruction set, as Highway's own are.
    once = name.endswith("-inl.h") or "#pragma once" in (line.strip() for line in lines)
    if name.endswith(".h") and not once:
        yield f"{name}:1: no #pragma once"


TYPE = re.compile(r"(?:struct|class) (\w+)(?: final)?(?: : [^;]*)? \{")


def type_faults(sources):
    """Two headers that define one name: no compiler sees both, and the linker takes either."""
    homes = collections.defaultdict(list)
    for name, lines in sources.items():
        if not name.endswith(".h") or name.startswith("tests/"):
            continue
        for number, line in enumerate(lines, 1):
            if match := TYPE.match(line):
                homes[match.group(1)].append(f"{name}:{number}")
    for title, places in sorted(homes.items()):
        for place in places[1:]:
            yield f"{place}: {title} is defined in {places[0]} as well"


def stem(name):
    """The name of a source without folder, ending, and what kernel files add to it."""
    return re.sub(r"(_kernel|_simd|_test)?\.(h|cpp)$", "", name.rpartition("/")[2])


def own_stems(name, lines):
    """The stem of a source, and those of the headers that it includes from its own folder (a test:
    from the folder that it mirrors)."""
    folder = name.rpartition("/")[0].removeprefix("tests/")
    included = (match.group(1) for match in map(INCLUDE.match, lines) if match)
    headers = {stem(i) for i in included if i and i.rpartition("/")[0] == folder}
    return headers | {stem(name)}


def kernel_faults(sources):
    """Each file of vector kernels needs an EL_KERNEL_TEST (tests/support/kernel_test.h) in the
    folder of its tests, in a file that includes its header or one whose name starts alike.
    `sources` are the lines of all files by name."""
    tested = collections.defaultdict(set)  # stems by folder
    for name, lines in sources.items():
        if name.startswith("tests/") and any(line.startswith("EL_KERNEL_TEST(") for line in lines):
            tested[name.rpartition("/")[0].removeprefix("tests/")] |= own_stems(name, lines)
    for name, lines in sources.items():
        if name.startswith("tests/") or not any("HWY_EXPORT(" in line for line in lines):
            continue
        folder, stems = name.rpartition("/")[0], own_stems(name, lines)
        if not any(f"{own}_".startswith(f"{other}_") for own in stems for other in tested[folder]):
            yield f"{name}:1: no EL_KERNEL_TEST in tests/{folder}/ includes its header"


def flag_faults(root):
    files = [p for p in root.rglob("CMakeLists.txt")] + list(root.rglob("*.cmake"))
    files.append(root / "CMakePresets.json")
    for path in sorted(files):
        name = path.relative_to(root).as_posix()
        if name.startswith(("build/", "out/")) or not path.exists():
            continue
        for number, line in enumerate(path.read_text().splitlines(), 1):
            code = line.split("#")[0]
            if BANNED_FLAG.search(code):
                yield f"{name}:{number}: a flag that changes floating point or needs a certain CPU"


def format_faults(root, paths):
    if not paths or not shutil.which("clang-format"):
        return
    command = ["clang-format", "--dry-run", "--ferror-limit=1", "-Werror"]
    result = subprocess.run(command + paths, cwd=root, capture_output=True, text=True, check=False)
    for line in result.stderr.splitlines():
        if ": error: " in line:
            yield line.split(": error: ")[0] + ": not formatted (clang-format -i)"


def faults(root):
    names, sources = [], {}
    for path, name in cpp_files(root):
        lines = path.read_text().splitlines()
        names.append(name)
        sources[name] = lines
        yield from include_faults(name, lines)
        yield from length_faults(name, lines)
        yield from function_faults(name, lines)
        yield from header_faults(name, lines)
    if not names:
        yield f"{root}: no source file found"
    yield from crowding_faults(names)
    yield from kernel_faults(sources)
    yield from type_faults(sources)
    yield from flag_faults(root)
    yield from format_faults(root, names)


def main():
    found = list(faults(pathlib.Path(sys.argv[1]).resolve()))
    print("\n".join(found) if found else "no faults")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
