"""A page in headless Chromium through its DevTools, over a pipe: the screen of a phone, clicks, what a reader hears.

Requests are JSON ended by a zero byte, on file descriptors 3 and 4 of the browser (`--remote-debugging-pipe`).
"""

import contextlib
import json
import os
import select
import subprocess
import sys
import time
from base64 import b64decode

from browser import BROWSER, QUIET

LIMIT = 120.0  # s, for one answer
ON_3_AND_4 = """
import os, sys
os.dup2(int(sys.argv[1]), 3)
os.dup2(int(sys.argv[2]), 4)
os.execv(sys.argv[3], sys.argv[3:])
"""


class Tab:
    """One page; `console` holds what was complained of, `requests` what was asked from elsewhere."""

    def __init__(self, write, read, target):
        self._write, self._read, self._rest, self._last = write, read, b"", 0
        self.console, self.requests, self._loaded, self._session = [], [], False, None
        created = self.ask("Target.createTarget", url="about:blank")
        attached = self.ask("Target.attachToTarget", targetId=created["targetId"], flatten=True)
        self._session = attached["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network", "Accessibility"):
            self.ask(f"{domain}.enable")
        self.target = target

    def ask(self, method, **parameters):
        """The answer to a command."""
        self._last += 1
        message = {"id": self._last, "method": method, "params": parameters}
        if self._session is not None:
            message["sessionId"] = self._session
        os.write(self._write, json.dumps(message).encode() + b"\0")
        while True:
            found = self._next()
            if found.get("id") == self._last:
                assert "error" not in found, f"{method}: {found['error']}"
                return found["result"]

    def show(self, width, height):
        """Load the page on a screen of this size."""
        self.ask(
            "Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=width < 600
        )
        self._loaded = False
        self.ask("Page.navigate", url=self.target)
        while not self._loaded:
            self._next()

    def find(self, script):
        """What a script leaves as its value."""
        found = self.ask("Runtime.evaluate", expression=script, returnByValue=True)
        assert "exceptionDetails" not in found, found["exceptionDetails"]
        return found["result"].get("value")

    def heard(self, *roles):
        """Role and name of what a screen reader meets, of these roles."""
        nodes = self.ask("Accessibility.getFullAXTree")["nodes"]
        kept = [node for node in nodes if not node["ignored"] and node["role"]["value"] in roles]
        return [(node["role"]["value"], node.get("name", {}).get("value", "")) for node in kept]

    def picture(self, whole=False):
        """A PNG of the screen, or of the whole page."""
        return b64decode(self.ask("Page.captureScreenshot", captureBeyondViewport=whole)["data"])

    def _next(self):
        """The next message; events are noted."""
        until = time.monotonic() + LIMIT
        while b"\0" not in self._rest:
            ready, _, _ = select.select([self._read], [], [], max(0.0, until - time.monotonic()))
            assert ready, "the browser does not answer"
            more = os.read(self._read, 1 << 16)
            assert more, "the browser has gone"
            self._rest += more
        text, _, self._rest = self._rest.partition(b"\0")
        message = json.loads(text)
        method, facts = message.get("method"), message.get("params", {})
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
        return message


@contextlib.contextmanager
def tab(path):
    """A tab for a file; load it with `show`."""
    inward, outward = os.pipe(), os.pipe()
    options = (*QUIET, f"--user-data-dir={path.parent / 'profile'}", "--remote-debugging-pipe", "about:blank")
    process = subprocess.Popen(
        [sys.executable, "-c", ON_3_AND_4, str(inward[0]), str(outward[1]), BROWSER, *options],
        pass_fds=(inward[0], outward[1]), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    os.close(inward[0])
    os.close(outward[1])
    try:
        yield Tab(inward[1], outward[0], path.as_uri())
    finally:
        os.close(inward[1])
        process.terminate()
        process.wait(30)
        os.close(outward[0])
