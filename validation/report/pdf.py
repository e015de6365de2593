"""report.pdf from report.html, with a bookmark for every heading: printed by the Chromium or Chrome that is installed.

The page brings its own rules for paper (`@media print` of style.css); the browser makes bookmarks of its headings.
"""

import os
import shutil
import subprocess
import tempfile
from pathlib import Path

from bem.scene.atomic_file import write_atomically
from validation.report.pages import PAGE, ReportError

PRINTED = "report.pdf"
BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome", "msedge")
LONGEST = 600.0  # s
OPTIONS = ("--headless", "--disable-gpu", "--no-first-run", "--no-pdf-header-footer", "--generate-pdf-document-outline")


def write_pdf(folder: Path) -> Path:
    """Print folder/report.html to folder/report.pdf; its path.

    ReportError where no browser is installed, or it did not print.
    """
    browser = next(filter(None, map(shutil.which, BROWSERS)), None)
    if browser is None:
        raise ReportError(f"--pdf: no browser that prints; needed is one of {', '.join(BROWSERS)} on the PATH")
    alone = ("--no-sandbox",) if hasattr(os, "geteuid") and os.geteuid() == 0 else ()  # Chromium refuses it to root
    with tempfile.TemporaryDirectory() as scratch:
        made = Path(scratch) / PRINTED
        command = [browser, *OPTIONS, *alone, f"--user-data-dir={scratch}/profile", f"--print-to-pdf={made}"]
        try:
            done = subprocess.run([*command, (folder / PAGE).resolve().as_uri()], capture_output=True, timeout=LONGEST)
        except subprocess.TimeoutExpired as error:
            raise ReportError(f"--pdf: {browser} did not print within {LONGEST:g} s") from error
        if not made.exists():
            raise ReportError(f"--pdf: {browser} did not print: {done.stderr.decode(errors='replace').strip()[-300:]}")
        write_atomically(folder / PRINTED, made.read_bytes())
    return folder / PRINTED
