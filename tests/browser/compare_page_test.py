"""Drives the comparison page in headless Chromium: plots, table, slider, keys, colors.

Usage: compare_page_test.py MAKE_COMPARE_PAGE [--pictures DIR]
Exit status: 0, 1 on a failed check, 77 (skipped) without Chromium.
"""

import pathlib
import subprocess
import sys
import tempfile

import browser

CHECKS = pathlib.Path(__file__).with_name("compare_page_checks.js").read_text()


def main():
    if not browser.is_there():
        print("skipped: no chromium")
        return browser.SKIPPED
    pictures = browser.pictures_directory(sys.argv)
    with tempfile.TemporaryDirectory() as work:
        page = pathlib.Path(work) / "index.html"
        subprocess.run([sys.argv[1], str(page)], check=True, timeout=240)
        failed = browser.run_checks(page, "comparison", CHECKS)
        if pictures:
            browser.take_pictures(page, pictures)
    return browser.report(failed)


if __name__ == "__main__":
    sys.exit(main())
