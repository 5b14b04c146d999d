"""Runs checks inside pages that headless Chromium has loaded, and takes their pictures."""

import json
import pathlib
import re
import shutil
import subprocess
import tempfile

SKIPPED = 77
# Errors of the page's own script come before the checks, so the trap goes first.
TRAP = "<script>window.pageErrors = []; addEventListener('error', (e) => pageErrors.push(e.message));</script>"


def is_there():
    return shutil.which("chromium") is not None


def chromium(arguments):
    program = shutil.which("chromium")
    with tempfile.TemporaryDirectory() as profile:
        return subprocess.run(
            [program, "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--hide-scrollbars",
             "--disable-background-networking", "--disable-component-update", "--disable-sync",
             f"--user-data-dir={profile}", *arguments],
            capture_output=True, text=True, timeout=240, check=True).stdout


def run_checks(page, what, script):
    """Appends `script`, which leaves its results in <pre id=results>; the failures, as lines."""
    tested = page.with_name("tested.html")
    text = page.read_text().replace("<head>", "<head>" + TRAP, 1)
    tested.write_text(text.replace("</body>", f"<script>{script}</script></body>"))
    shown = chromium(["--window-size=1200,900", "--virtual-time-budget=15000", "--dump-dom", tested.as_uri()])
    found = re.search(r'<pre id="results">(.*?)</pre>', shown, re.S)
    if not found:
        return [f"{what}: the checks never finished"]
    results = json.loads(found.group(1).replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&"))
    print(f"{what}: {results['passed']} checks passed, {len(results['failed'])} failed")
    return [f"{what}: {failure}" for failure in results["failed"]]


def take_pictures(page, directory, height=1900):
    directory.mkdir(parents=True, exist_ok=True)
    for name, width, dark in [("light", 1200, False), ("dark", 1200, True), ("phone", 500, False)]:
        options = ["--force-dark-mode", "--blink-settings=preferredColorScheme=0"] if dark else []
        size = f"--window-size={width},{height if width > 1000 else 3 * height // 2}"
        chromium([*options, size, f"--screenshot={directory / (name + '.png')}", "--virtual-time-budget=5000",
                  page.as_uri()])


def pictures_directory(arguments):
    """Where --pictures asks for pictures, or None."""
    if "--pictures" not in arguments:
        return None
    return pathlib.Path(arguments[arguments.index("--pictures") + 1])


def report(failed):
    for what in failed:
        print("FAILED", what)
    return 1 if failed else 0
