"""Drives a page in headless Chromium: loads it, clicks, drags, presses keys, and reads what it shows.

Usage: page_test.py MAKE_PAGES run|denoise|compare|paper [--pictures DIR]
Each page is checked in a wide, light window and in a narrow, dark one. Exit status: 0, 1 if a check fails, 77
(skipped) without Chromium. --pictures writes screenshots of the pages to DIR.
"""

import pathlib
import subprocess
import sys
import tempfile

import browser

FOLDER = pathlib.Path(__file__).parent
# The pages of each kind, and the most kilobytes that one may have: few more than it has today.
PAGES = {
    "run": {"run-1": 100, "run-12": 650, "run-300": 8000},
    "denoise": {"denoise": 250},
    "compare": {"compare": 110},
    "paper": {"paper": 45},
}


def main():
    if not browser.is_there():
        print("skipped: no chromium")
        return browser.SKIPPED
    maker, kind = sys.argv[1:3]
    pictures = browser.pictures_directory(sys.argv)
    checks = "".join((FOLDER / name).read_text() for name in ("checks.js", f"{kind}_page_checks.js"))
    failed = []
    with tempfile.TemporaryDirectory() as work:
        for name, most_kilobytes in PAGES[kind].items():
            page = pathlib.Path(work) / name / "index.html"
            subprocess.run([maker, name, str(page.parent)], check=True, timeout=240)
            kilobytes = page.stat().st_size / 1000
            if kilobytes > most_kilobytes:
                failed.append(f"{name}: the page has {kilobytes:.0f} kB, at most {most_kilobytes} kB")
            for width, scheme in ((1400, "light"), (400, "dark")):
                wanted = f'const wanted = {{ width: {width}, scheme: "{scheme}" }};\n'
                failed += browser.run_checks(page, f"{name}, {width} px, {scheme}, {kilobytes:.0f} kB",
                                             wanted + checks, width, scheme)
            if pictures:
                browser.take_pictures(page, pictures / name)
    for what in failed:
        print("FAILED", what)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
