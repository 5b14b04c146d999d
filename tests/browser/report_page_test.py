"""Drives the report page in headless Chromium: loads, clicks, drags, and reads what the page shows.

A copy of the page gets a script of checks appended, and Chromium prints the page it ends with.
Usage: report_page_test.py MAKE_PAGE [--pictures DIR]
Exit status: 0, 1 on a failed check, 77 (skipped) without Chromium.
"""

import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

CHECKS = pathlib.Path(__file__).with_name("report_page_checks.js").read_text()
# Errors of the page's own script come before the checks, so the trap goes first.
TRAP = "<script>window.pageErrors = []; addEventListener('error', (e) => pageErrors.push(e.message));</script>"


def chromium(arguments):
    program = shutil.which("chromium")
    with tempfile.TemporaryDirectory() as profile:
        return subprocess.run(
            [program, "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--hide-scrollbars",
             "--disable-background-networking", "--disable-component-update", "--disable-sync",
             f"--user-data-dir={profile}", *arguments],
            capture_output=True, text=True, timeout=120, check=True).stdout


def run_checks(page, frames):
    text = page.read_text()
    script = f"<script>const expectedFrames = {frames};\n{CHECKS}</script>"
    tested = page.with_name("tested.html")
    tested.write_text(text.replace("<head>", "<head>" + TRAP, 1).replace("</body>", script + "</body>"))
    shown = chromium(["--window-size=1200,900", "--virtual-time-budget=15000", "--dump-dom", tested.as_uri()])
    found = re.search(r'<pre id="results">(.*?)</pre>', shown, re.S)
    if not found:
        return [f"{frames} frames: the checks never finished"]
    results = json.loads(found.group(1).replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&"))
    print(f"{frames} frames: {results['passed']} checks passed, {len(results['failed'])} failed")
    return [f"{frames} frames: {what}" for what in results["failed"]]


def take_pictures(page, directory):
    directory.mkdir(parents=True, exist_ok=True)
    for name, size, dark in [("light", "1200,1900", False), ("dark", "1200,1900", True),
                             ("phone", "500,2900", False)]:
        options = ["--force-dark-mode", "--blink-settings=preferredColorScheme=0"] if dark else []
        chromium([*options, f"--window-size={size}", f"--screenshot={directory / (name + '.png')}",
                  "--virtual-time-budget=5000", page.as_uri()])


def main():
    if not shutil.which("chromium"):
        print("skipped: no chromium")
        return 77
    failed = []
    with tempfile.TemporaryDirectory() as work:
        for frames in (1, 12, 300):
            directory = pathlib.Path(work) / str(frames)
            subprocess.run([sys.argv[1], str(directory), str(frames)], check=True, timeout=120)
            page = directory / "index.html"
            failed += run_checks(page, frames)
            if "--pictures" in sys.argv:
                target = pathlib.Path(sys.argv[sys.argv.index("--pictures") + 1])
                take_pictures(page, target / str(frames))
    for what in failed:
        print("FAILED", what)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
