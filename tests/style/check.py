#!/usr/bin/env python3
"""Checks the shape of the code: check.py ROOT prints each fault as file:line: what, and exits 1.

Folders include downwards only, third-party libraries stay behind the files that are meant to
include them, files stay short, headers have #pragma once, no flag that changes floating point, and
every source is formatted as .clang-format says.
"""

import fnmatch
import pathlib
import re
import shutil
import subprocess
import sys

FOLDERS = {  # folder: those of ours that it may include besides itself
    "frame": set(),
    "render": {"frame"},
    "reproject": {"frame"},
    "spatial": {"frame"},
    "temporal": {"frame", "reproject", "spatial"},
    "sequences": {"frame", "render", "reproject", "spatial", "temporal"},
    "tests": {"frame", "render", "reproject", "spatial", "temporal", "sequences"},
}

THIRD_PARTY = [  # (includes, files that may have them)
    (r"(tbb|oneapi)/", ["frame/tiles.cpp"]),
    (r"embree\d/", ["render/embree_*"]),
    (r"assimp/", ["render/scene_file*"]),
    (r"OpenImageIO/", ["sequences/exr_io.cpp", "sequences/ldr_image.cpp", "render/image_file.cpp"]),
    (r"hwy/", ["*_simd.cpp"]),
    (r"CLI/", ["sequences/*"]),
    (r"nlohmann/", ["sequences/*", "render/scene_file*"]),
    (r"xxhash", ["sequences/*"]),
]

MAX_LINES = 400
INCLUDE = re.compile(r'^\s*#\s*include\s+(?:"([^"]+)"|<([^>]+)>)')
BANNED_FLAG = re.compile(r"-ffast-math|-Ofast|-march|-funsafe-math")


def cpp_files(root):
    for folder in FOLDERS:
        for path in sorted((root / folder).rglob("*")):
            if path.suffix in (".h", ".cpp"):
                yield path, path.relative_to(root).as_posix()


def include_faults(name, lines):
    folder = name.split("/")[0]
    for number, line in enumerate(lines, 1):
        match = INCLUDE.match(line)
        if not match:
            continue
        ours, theirs = match.groups()
        if ours:
            target = ours.split("/")[0]
            # Highway names a file to itself again in this way.
            if target not in FOLDERS:
                yield f'{name}:{number}: "{ours}" does not start at the root of the project'
            elif target != folder and target not in FOLDERS[folder]:
                yield f"{name}:{number}: {folder}/ must not include {target}/"
        included = ours or theirs
        for pattern, allowed in THIRD_PARTY:
            # Tests may look at files with whatever reads them.
            if folder == "tests" or not re.match(pattern, included):
                continue
            if not any(fnmatch.fnmatch(name, entry) for entry in allowed):
                yield f"{name}:{number}: <{included}> belongs in {', '.join(allowed)} only"


def length_faults(name, lines):
    if len(lines) > MAX_LINES:
        yield f"{name}:{len(lines)}: longer than {MAX_LINES} lines"


def header_faults(name, lines):
    if name.endswith(".h") and "#pragma once" not in (line.strip() for line in lines):
        yield f"{name}:1: no #pragma once"


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
    names = []
    for path, name in cpp_files(root):
        lines = path.read_text().splitlines()
        names.append(name)
        yield from include_faults(name, lines)
        yield from length_faults(name, lines)
        yield from header_faults(name, lines)
    if not names:
        yield f"{root}: no source file found"
    yield from flag_faults(root)
    yield from format_faults(root, names)


def main():
    found = list(faults(pathlib.Path(sys.argv[1]).resolve()))
    print("\n".join(found) if found else "no faults")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
