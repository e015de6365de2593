"""Pages in headless Chromium through its DevTools, over a pipe: screens, clicks, what a reader hears.

Requests are JSON ended by a zero byte, on file descriptors 3 and 4 of the browser (`--remote-debugging-pipe`).  One
browser serves all tests of a process; each tab has a profile of its own.
"""

import atexit
import contextlib
import json
import os
import select
import subprocess
import sys
import tempfile
import time
from functools import cache

from browser import BROWSER, QUIET

LIMIT = 120.0  # s, for one answer
ON_3_AND_4 = """
import os, sys
os.dup2(int(sys.argv[1]), 3)
os.dup2(int(sys.argv[2]), 4)
os.execv(sys.argv[3], sys.argv[3:])
"""


class Browser:
    """The process, and what it says; `hearers` are told the events of their sessions."""

    def __init__(self):
        inward, outward = os.pipe(), os.pipe()
        self._profile = tempfile.TemporaryDirectory()
        options = (*QUIET, f"--user-data-dir={self._profile.name}", "--remote-debugging-pipe", "about:blank")
        self._process = subprocess.Popen(
            [sys.executable, "-c", ON_3_AND_4, str(inward[0]), str(outward[1]), BROWSER, *options],
            pass_fds=(inward[0], outward[1]),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        os.close(inward[0])
        os.close(outward[1])
        self._write, self._read, self._rest, self._last = inward[1], outward[0], b"", 0
        self.hearers = {}

    def close(self):
        """End it."""
        os.close(self._write)
        self._process.terminate()
        self._process.wait(30)
        os.close(self._read)
        with contextlib.suppress(OSError):  # what it still writes there
            self._profile.cleanup()

    def ask(self, method, session=None, **parameters):
        """The answer to a command."""
        self._last += 1
        message = {"id": self._last, "method": method, "params": parameters}
        if session is not None:
            message["sessionId"] = session
        os.write(self._write, json.dumps(message).encode() + b"\0")
        while True:
            found = self.next()
            if found.get("id") == self._last:
                assert "error" not in found, f"{method}: {found['error']}"
                return found["result"]

    def next(self):
        """The next message."""
        until = time.monotonic() + LIMIT
        while b"\0" not in self._rest:
            ready, _, _ = select.select([self._read], [], [], max(0.0, until - time.monotonic()))
            assert ready, "the browser does not answer"
            more = os.read(self._read, 1 << 16)
            assert more, "the browser has gone"
            self._rest += more
        text, _, self._rest = self._rest.partition(b"\0")
        message = json.loads(text)
        if message.get("sessionId") in self.hearers:
            self.hearers[message["sessionId"]](message.get("method"), message.get("params", {}))
        return message


@cache
def browser():
    """That of this process, from when it is first asked for."""
    started = Browser()
    atexit.register(started.close)
    return started


class Tab:
    """One page; `console` holds what was complained of, `requests` what was asked from elsewhere."""

    def __init__(self, target):
        self.target, self._browser = target, browser()
        self.console, self.requests, self._loaded = [], [], False
        self._context = self._browser.ask("Target.createBrowserContext")["browserContextId"]
        created = self._browser.ask("Target.createTarget", url="about:blank", browserContextId=self._context)
        attached = self._browser.ask("Target.attachToTarget", targetId=created["targetId"], flatten=True)
        self._session = attached["sessionId"]
        self._browser.hearers[self._session] = self._hear
        for domain in ("Page", "Runtime", "Log", "Network", "Accessibility"):
            self.ask(f"{domain}.enable")
        self.ask("Emulation.setFocusEmulationEnabled", enabled=True)

    def close(self):
        """Close it, with its profile."""
        del self._browser.hearers[self._session]
        self._browser.ask("Target.disposeBrowserContext", browserContextId=self._context)

    def ask(self, method, **parameters):
        """The answer to a command."""
        return self._browser.ask(method, self._session, **parameters)

    def show(self, width, height, phone=None):
        """Load the page on a screen of this size; a narrow one is that of a phone, which shrinks what is too wide."""
        phone = width < 600 if phone is None else phone
        self.ask("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=phone)
        self._loaded = False
        self.ask("Page.navigate", url=self.target)
        while not self._loaded:
            self._browser.next()

    def find(self, script):
        """What a script leaves as its value."""
        found = self.ask("Runtime.evaluate", expression=script, returnByValue=True)
        assert "exceptionDetails" not in found, found["exceptionDetails"]
        return found["result"].get("value")

    def heard(self, *roles):
        """Return role and name, white space joined, of what a screen reader meets, of these roles."""
        nodes = self.ask("Accessibility.getFullAXTree")["nodes"]
        kept = [node for node in nodes if not node["ignored"] and node["role"]["value"] in roles]
        return [(node["role"]["value"], " ".join(node.get("name", {}).get("value", "").split())) for node in kept]

    def _hear(self, method, facts):
        if method == "Page.loadEventFired":
            self._loaded = True
        elif method in ("Runtime.exceptionThrown", "Runtime.consoleAPICalled"):
            self.console.append(facts)
        elif method == "Log.entryAdded":
            self.console.append(facts["entry"]["text"])
        elif method == "Network.requestWillBeSent" and not facts["request"]["url"].startswith(
            ("file:", "data:", "about:")
        ):
            self.requests.append(facts["request"]["url"])


@contextlib.contextmanager
def tab(path):
    """A tab for a file; load it with `show`."""
    opened = Tab(path.as_uri())
    try:
        yield opened
    finally:
        opened.close()


def found_at(folder, text, look, width):
    """What a script leaves in `found` in a page in a window of this width; the console."""
    path = folder / "page.html"
    path.write_text(text, "utf-8")
    with tab(path) as opened:
        opened.show(width, 844, phone=False)
        return opened.find(f"(() => {{ const found = {{}}; {look} return found; }})()"), opened.console
