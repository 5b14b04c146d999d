"""Runs checks inside pages that headless Chromium has loaded, and takes screenshots of them."""

import html
import json
import pathlib
import re
import shutil
import subprocess
import tempfile

SKIPPED = 77
# Goes before all scripts of the page: collects errors, warnings and pictures that do not load.
TRAP = """<script>
window.pageErrors = [];
addEventListener("error", (e) => pageErrors.push(e.message || `cannot load ${String(e.target.src).slice(0, 80)}`), true);
addEventListener("unhandledrejection", (e) => pageErrors.push(`${e.reason}`));
for (const kind of ["error", "warn"]) console[kind] = (...words) => pageErrors.push(words.join(" "));
</script>"""


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


def framed(page, width, height):
    """A file beside `page` that shows it in a frame: a window of Chromium is at least 500 pixels wide.
    It receives the results of checks and puts them into <pre id=results>."""
    frame = page.with_name("frame.html")
    frame.write_text(f"""<!DOCTYPE html><meta name="color-scheme" content="light dark">
<body style="margin: 0"><iframe src="{page.name}" style="border: 0; width: {width}px; height: {height}px"></iframe>
<script>
addEventListener("message", (e) => {{
  const out = document.body.appendChild(document.createElement("pre"));
  out.id = "results";
  out.textContent = e.data;
}});
</script>""")
    return frame.as_uri()


def scheme_options(scheme):
    return ["--blink-settings=preferredColorScheme=0"] if scheme == "dark" else []


def run_checks(page, what, script, width, scheme):
    """Runs `script`, which posts its results to the parent, in a copy of the page; returns the failures
    as lines. `scheme` is light or dark."""
    tested = page.with_name("tested.html")
    text = page.read_text().replace("<head>", "<head>" + TRAP, 1)
    tested.write_text(text.replace("</body>", f"<script>{script}</script></body>"))
    shown = chromium([*scheme_options(scheme), f"--window-size={width},900", "--virtual-time-budget=15000",
                      "--dump-dom", framed(tested, width, 900)])
    found = re.search(r'<pre id="results">(.*?)</pre>', shown, re.S)
    if not found:
        return [f"{what}: the checks never finished"]
    results = json.loads(html.unescape(found.group(1)))
    print(f"{what}: {results['passed']} checks passed, {len(results['failed'])} failed")
    return [f"{what}: {failure}" for failure in results["failed"]]


def take_pictures(page, directory):
    """light and dark at 1400 pixels, light-narrow and dark-narrow at 400 pixels"""
    directory.mkdir(parents=True, exist_ok=True)
    for width, height, suffix in ((1400, 2200, ""), (400, 3400, "-narrow")):
        for scheme in ("light", "dark"):
            chromium([*scheme_options(scheme), f"--window-size={width},{height}", "--virtual-time-budget=5000",
                      f"--screenshot={directory / (scheme + suffix + '.png')}", framed(page, width, height)])


def pictures_directory(arguments):
    """The directory that --pictures names, or None."""
    if "--pictures" not in arguments:
        return None
    return pathlib.Path(arguments[arguments.index("--pictures") + 1])
