"""Drives the report page in headless Chromium: loads, clicks, drags, and reads what the page shows.

Usage: report_page_test.py MAKE_PAGE [--pictures DIR]
Exit status: 0, 1 on a failed check, 77 (skipped) without Chromium.
"""

import pathlib
import subprocess
import sys
import tempfile

import browser

CHECKS = pathlib.Path(__file__).with_name("report_page_checks.js").read_text()


def main():
    if not browser.is_there():
        print("skipped: no chromium")
        return browser.SKIPPED
    failed = []
    pictures = browser.pictures_directory(sys.argv)
    with tempfile.TemporaryDirectory() as work:
        for frames in (1, 12, 300):
            directory = pathlib.Path(work) / str(frames)
            subprocess.run([sys.argv[1], str(directory), str(frames)], check=True, timeout=240)
            page = directory / "index.html"
            failed += browser.run_checks(page, f"{frames} frames", f"const expectedFrames = {frames};\n{CHECKS}")
            if pictures:
                browser.take_pictures(page, pictures / str(frames))
    return browser.report(failed)


if __name__ == "__main__":
    sys.exit(main())
