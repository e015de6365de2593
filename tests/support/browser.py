"""A page in headless Chromium: what the browser printed, and what a script found inside it at a given width."""

import json
import re
import shutil
import subprocess
from base64 import b64encode
from hashlib import sha256
from html import unescape

BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome", "chrome"))), None)

QUIET = (
    *("--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-dev-shm-usage"),
    *("--disable-background-networking", "--disable-component-update", "--disable-sync", "--disable-extensions"),
    *("--host-resolver-rules=MAP * ~NOTFOUND", "--enable-logging=stderr", "--log-level=0"),
)

FRAME = """<!DOCTYPE html><title>frame</title>
<script>
addEventListener("message", (event) => {
  const note = document.createElement("output");
  note.id = "found-by-test";
  note.textContent = event.data;
  document.body.append(note);
});
</script>
<iframe src="page.html" style="width: WIDTHpx; height: 844px; border: 0"></iframe>
"""


def allowing(text):
    """The page with a policy that knows what a test has changed: all scripts and style sheets as they now stand."""
    for kind in ("script", "style"):
        inline = re.findall(f"<{kind}>(.*?)</{kind}>", text, re.DOTALL)
        known = " ".join(f"'sha256-{b64encode(sha256(one.encode()).digest()).decode()}'" for one in inline)
        text, count = re.subn(f"{kind}-src [^;]*;", lambda _, kind=kind, known=known: f"{kind}-src {known};", text)
        assert count == 1
    return text


def browse(folder, text, *options):
    """Open a page: what the browser printed."""
    path = folder / "page.html"
    path.write_text(text, "utf-8")
    return opened(path, *options)


def opened(path, *options):
    """Open a file: what the browser printed."""
    command = [BROWSER, *QUIET, f"--user-data-dir={path.parent / 'profile'}", *options, path.as_uri()]
    return subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)


def console_of(done):
    return [line for line in done.stderr.splitlines() if "CONSOLE" in line]


def found_at(folder, text, look, width):
    """What a script leaves in `found` in a page of this width, also below that of the narrowest window; the console."""
    script = f"<script>const found = {{}}; {look} parent.postMessage(JSON.stringify(found), '*');</script></body>"
    (folder / "page.html").write_text(allowing(text.replace("</body>", script)), "utf-8")
    (folder / "frame.html").write_text(FRAME.replace("WIDTH", str(width)))
    done = opened(folder / "frame.html", "--dump-dom", "--virtual-time-budget=10000", "--window-size=1400,1000")
    found = re.search(r'<output id="found-by-test">(.*?)</output>', done.stdout, re.DOTALL)
    assert found, done.stderr[-2000:]
    return json.loads(unescape(found[1])), console_of(done)
