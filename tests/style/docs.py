#!/usr/bin/env python3
"""Checks the Markdown pages: docs.py ROOT prints each fault as file:line: what, and exits 1.

The README and those of folders stay short. Every relative link points to a file that exists, a
`#fragment` to a heading of that page, and `#L12` to a line of that file; identifiers in backticks in
the text of such a link stand within a few lines of it. Every page is linked from another.

docs.py ROOT --mend moves links whose line does not name the identifier in their text to where it
stands now: to its definition, if there is one, and of several to the nearest. `#L0` asks for the first.
"""

import pathlib
import re
import sys

ROOT_LINES, FOLDER_LINES = 149, 79  # of the README, and of those of folders
COLUMNS = 120                       # of lines of the README that are not rows of a table
NEAR = 4                            # lines between a linked line and the identifier that names it
SKIPPED = ("build", "out", ".git")
FENCE = re.compile(r"^\s*(```|~~~)")
LINK = re.compile(r"!?\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^()\s]*(?:\([^()]*\))?[^()\s]*)\)")
LINES = re.compile(r"L(\d+)(?:-L(\d+))?$")
IDENTIFIER = re.compile(r"[A-Za-z_]\w*")


def pages(root):
    for path in sorted(root.rglob("*.md")):
        name = path.relative_to(root)
        if name.parts[0] not in SKIPPED:
            yield path, name.as_posix()


def prose(text):
    """(number, line) of the lines outside code blocks."""
    is_code = False
    for number, line in enumerate(text.splitlines(), 1):
        if FENCE.match(line):
            is_code = not is_code
        elif not is_code:
            yield number, line


def anchor(heading):
    """The fragment that GitHub gives a heading."""
    words = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).replace("`", "").strip().lower()
    return re.sub(r"[^\w\- ]", "", words).replace(" ", "-")


def anchors(path):
    return {anchor(line.lstrip("#")) for _, line in prose(path.read_text()) if re.match(r"#+ ", line)}


def links(text):
    """(line number, text, target) of each link outside code; its text may go on in the next line."""
    lines = dict(prose(text))
    joined = "\n".join(lines.get(n, "") for n in range(1, text.count("\n") + 2))
    code = [match.span() for match in re.finditer(r"(`+)(?:(?!\1|\n\n).)*\1", joined, re.DOTALL)]
    for match in LINK.finditer(joined):
        if not any(start <= match.start() and match.end() <= end for start, end in code):
            yield joined.count("\n", 0, match.start()) + 1, match.group(1), match.group(2)


def identifiers(words):
    """The last names of what stands in backticks: b of `A::b(c)`. A file, `a.h`, is no identifier."""
    for quoted in re.findall(r"`([^`]+)`", words):
        names = IDENTIFIER.findall(quoted.split("(")[0])
        if names and not re.search(r"\.\w+$", quoted):
            yield names[-1]


def line_faults(path, words, fragment):
    """What is wrong with a link to lines of `path`."""
    first, last = (int(n) if n else None for n in LINES.match(fragment).groups())
    lines = path.read_text().splitlines()
    last = last or first
    if not 1 <= first <= last <= len(lines):
        yield f"#{fragment}: {path.name} has {len(lines)} lines"
        return
    near = "\n".join(lines[max(first - 1 - NEAR, 0):last + NEAR])
    for name in identifiers(words):
        if not re.search(rf"\b{name}\b", near):
            yield f"#{fragment}: no `{name}` within {NEAR} lines of it in {path.name}"


def line_of(lines, name, wanted):
    """The number of the line that defines `name`, or that names it; of several the one nearest to
    `wanted`. None without any."""
    code = [line.split("//")[0] for line in lines]
    # From the best place to the worst: types, functions of a file, members, other code, comments.
    for pattern, text in ((rf"\s*(struct|class|enum class) {name}\b(?!;)", code), (rf"\S.*\b{name}\(", code),
                          (rf"\s*(\[\[nodiscard\]\] )?[\w:<>&*]+ {name}\(", code), (rf".*\b{name}\b", code),
                          (rf".*\b{name}\b", lines)):
        found = [n for n, line in enumerate(text, 1) if re.match(pattern, line)]
        if found:
            return min(found, key=lambda n: abs(n - wanted))
    return None


def mend_link(path, match):
    """The link with its line as it should be, as far as that can be told."""
    words, target = match.groups()
    file, _, fragment = target.partition("#")
    to = path.parent / file
    names = list(identifiers(words))
    if not LINES.match(fragment) or not to.is_file() or not names:
        return match.group()
    lines = to.read_text().splitlines()
    wanted = int(LINES.match(fragment).group(1))
    if 1 <= wanted <= len(lines) and any(re.search(rf"\b{n}\b", lines[wanted - 1]) for n in names):
        return match.group()
    line = line_of(lines, names[0], wanted)
    return match.group().replace(f"#{fragment})", f"#L{line})") if line else match.group()


def mend(root):
    for path, name in pages(root):
        text = path.read_text()
        mended = LINK.sub(lambda match: mend_link(path, match), text)
        if mended != text:
            path.write_text(mended)
            print(f"mended {name}")


def link_faults(root, path, words, target):
    file, _, fragment = target.partition("#")
    if re.match(r"[a-z][a-z0-9+.-]*:", target):
        return
    to = (path.parent / file).resolve() if file else path
    if not to.exists():
        yield f"'{target}' does not exist"
    elif not to.is_relative_to(root):
        yield f"'{target}' leads out of the project"
    elif LINES.match(fragment) and to.is_file():
        yield from line_faults(to, words, fragment)
    elif fragment and to.suffix == ".md" and fragment not in anchors(to):
        yield f"no heading #{fragment} in {to.relative_to(root)}"


def length_faults(name, lines):
    if not name.endswith("README.md") or name.startswith("docs/"):
        return
    most = ROOT_LINES if name == "README.md" else FOLDER_LINES
    if len(lines) > most:
        yield f"{name}:{len(lines)}: longer than {most} lines"
    for number, line in enumerate(lines, 1):
        if name == "README.md" and len(line) > COLUMNS and not line.startswith("|"):
            yield f"{name}:{number}: longer than {COLUMNS} columns"


def faults(root):
    root = root.resolve()
    names, linked = [], {"README.md"}
    for path, name in pages(root):
        names.append(name)
        text = path.read_text()
        yield from length_faults(name, text.splitlines())
        for number, words, target in links(text):
            yield from (f"{name}:{number}: {fault}" for fault in link_faults(root, path, words, target))
            to = (path.parent / target.partition("#")[0]).resolve()
            if to != path and to.is_relative_to(root):
                linked.add(to.relative_to(root).as_posix())
    if not names:
        yield f"{root}: no page found"
    yield from (f"{name}:1: no page links here" for name in names if name not in linked)


def main():
    if sys.argv[2:] == ["--mend"]:
        mend(pathlib.Path(sys.argv[1]))
    found = list(faults(pathlib.Path(sys.argv[1])))
    print("\n".join(found) if found else "no faults")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
