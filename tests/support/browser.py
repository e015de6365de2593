"""Headless Chromium: where it is, how it is started, and pages that allow what a test has put into them."""

import re
import shutil
from base64 import b64encode
from hashlib import sha256

BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome", "chrome"))), None)

QUIET = (
    *("--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-dev-shm-usage"),
    *("--disable-background-networking", "--disable-component-update", "--disable-sync", "--disable-extensions"),
    *("--host-resolver-rules=MAP * ~NOTFOUND", "--enable-logging=stderr", "--log-level=0"),
)


def allowing(text):
    """The page with a policy that knows what a test has changed: all scripts and style sheets as they now stand."""
    for kind in ("script", "style"):
        inline = re.findall(f"<{kind}>(.*?)</{kind}>", text, re.DOTALL)
        known = " ".join(f"'sha256-{b64encode(sha256(one.encode()).digest()).decode()}'" for one in inline)
        text, count = re.subn(f"{kind}-src [^;]*;", lambda _, kind=kind, known=known: f"{kind}-src {known};", text)
        assert count == 1
    return text
