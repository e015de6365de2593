"""Texts of the terminal: progress on stderr, the resolved scene, the effects and the summary.

Progress is a bar over the targets on a terminal, else plain lines: every `LINE_SECONDS`, and when a new target is
approached, unless the last line is younger than `TARGET_SECONDS`.  The time left is what the way to the last target
takes at the pace of the way behind.
"""

from __future__ import annotations

import argparse
import io
import json
import math
import os
import sys
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any, Protocol, TextIO

from bem.command_line.answer_table import readable
from bem.scene.memory_estimate import MemoryEstimate
from bem.scene.plausibility import MEANINGS
from bem.scene.progress import Progress
from bem.scene.result import Caution, Effect, Result

LINE_SECONDS = 5.0  # format: s between lines of progress
TARGET_SECONDS = 0.5  # format: s, the same at targets
BAR_SECONDS = 0.2  # format: s between redraws of the bar
MINUTES = 3  # format: time left from which on it is told in minutes
LEAST_DONE = 0.1  # format: of the way, before which the pace says little


def positive(text: str) -> int:
    """Return the whole number > 0 of an argument."""
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text!r}: an integer >= 1 is needed")
    return int(text)


def usable_streams() -> None:
    """Make output safe: characters that a stream cannot encode are escaped, and a closed stream is ignored."""
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:
            setattr(sys, name, Path(os.devnull).open("w"))  # noqa: SIM115  (until the end of the process)
        elif isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


class Reporter(Protocol):
    """Receiver of progress reports; closed at the end."""

    def __call__(self, report: Progress) -> None:
        """Show a report, unless another one was shown just before."""

    def close(self) -> None:
        """Restore the terminal."""


def described(report: Progress) -> str:
    """Return the state of a run in a few words.

    Examples
    --------
    >>> described(Progress(1250.0, 0.0123, 7, 42, 3, 310, 0, 5))
    '1.250 kPa, contact fraction 0.01230, 7 patches, 42 increments (3 rejected), 310 evaluations'
    """
    pressure = readable(report.mean_pressure, "Pa", 4)
    return (
        f"{pressure}, contact fraction {report.contact_fraction:.5f}, {report.n_patches} patches, "
        f"{report.increments_accepted} increments ({report.increments_rejected} rejected), "
        f"{report.evaluations} evaluations"
    )


class TimeLeft:
    """Seconds that a run has still to go, by the pace of the run itself.

    The way is measured in the controlled quantity, from its value at the first report to the first target and from
    target to target.  Where the way has no length, targets are counted.
    """

    def __init__(self, targets: Sequence[float], clock: Callable[[], float] = time.monotonic) -> None:
        self.targets, self.clock = targets, clock
        self.first: tuple[float, float, float] | None = None  # controlled value, way done and time at the first report

    def words(self, report: Progress) -> str:
        """Return the time left in words, empty at the beginning, where no pace is known yet."""
        now = self.clock()
        start = self.first[0] if self.first else report.value
        done = self._done(report, start)
        if self.first is None:
            self.first = start, done, now
        _, before, begun = self.first
        if done - before < LEAST_DONE:
            return ""
        left = (now - begun) * (1 - done) / (done - before)
        words = f"{left:.0f} s" if left < MINUTES * 60 else f"{left / 60:.0f} min"
        return f", about {words} to go" if left >= 0.5 else ""

    def _done(self, report: Progress, start: float) -> float:
        """Return the share of the way that is done."""
        stops = [start, *self.targets]
        legs = [abs(b - a) for a, b in pairwise(stops)]
        passed = abs(report.value - stops[report.target_index])
        if not math.isfinite(passed) or sum(legs) == 0:
            return report.target_index / report.n_targets
        return (sum(legs[: report.target_index]) + min(passed, legs[report.target_index])) / sum(legs)


class SilentReporter:
    """Reporter that prints nothing."""

    def __call__(self, report: Progress) -> None:
        """Ignore the report."""

    def close(self) -> None:
        """Do nothing."""


class LineReporter:
    """Reporter of a line at new targets and every `LINE_SECONDS`, at most one every `TARGET_SECONDS`."""

    def __init__(
        self, stream: TextIO, clock: Callable[[], float] = time.monotonic, left: TimeLeft | None = None
    ) -> None:
        self.stream, self.clock, self.left = stream, clock, left
        self.target, self.shown_at = -1, -LINE_SECONDS

    def __call__(self, report: Progress) -> None:
        """Print a line when one is due."""
        now = self.clock()
        pause = LINE_SECONDS if report.target_index == self.target else TARGET_SECONDS
        if now - self.shown_at < pause:
            return
        self.target, self.shown_at = report.target_index, now
        left = "" if self.left is None else self.left.words(report)
        text = f"towards target {report.target_index + 1} of {report.n_targets}: {described(report)}{left}"
        print(text, file=self.stream, flush=True)

    def close(self) -> None:
        """Do nothing."""


class BarReporter:
    """Reporter of a bar over the targets, for a terminal."""

    def __init__(self, stream: TextIO, left: TimeLeft | None = None) -> None:
        from tqdm import tqdm

        self.left = left
        self.bar = tqdm(total=None, file=stream, unit="target", mininterval=BAR_SECONDS, dynamic_ncols=True)

    def __call__(self, report: Progress) -> None:
        """Move the bar to the target being approached."""
        self.bar.total = report.n_targets
        left = "" if self.left is None else self.left.words(report)
        self.bar.set_postfix_str(described(report) + left, refresh=False)
        moved = report.target_index - self.bar.n
        self.bar.update(moved)
        if moved <= 0 and time.time() - self.bar.last_print_t > BAR_SECONDS:
            self.bar.last_print_t = time.time()
            self.bar.refresh()

    def close(self) -> None:
        """Leave the last state of the bar on the terminal."""
        self.bar.close()


def reporter(stream: TextIO, quiet: bool, targets: Sequence[float] = ()) -> Reporter:
    """Return the reporter for a stream; with the targets of the scene the reporter also estimates the time left."""
    if quiet:
        return SilentReporter()
    left = TimeLeft(targets) if targets else None
    return BarReporter(stream, left) if stream.isatty() else LineReporter(stream, left=left)


def summary(result: Result, folder: str, targets: int) -> dict[str, Any]:
    """Return the summary of a run as plain values; `targets` is the number of targets of the scene."""
    states = [state for state in result.states if state.found]
    last = states[-1] if states else None
    return {
        "status": result.status,
        "answered": result.answered,
        "failure": result.failure,
        "targets": targets,
        "target_states": sum(state.target for state in states),
        "missed_targets": [
            reason for state in result.states if not state.found for reason in state.certificate.reasons
        ],
        "states": len(states),
        "certified": sum(state.certificate.ok for state in states),
        "events": len(result.events),
        "mean_pressure": None if last is None or math.isnan(last.mean_pressure) else last.mean_pressure,
        "contact_fraction": None if last is None else last.contact_fraction,
        "n_patches": None if last is None else last.n_patches,
        "evaluations": sum(state.evaluations for state in result.states),
        "cpu_seconds": sum(state.cpu_seconds for state in result.states),
        "out": folder,
    }


def summary_line(facts: Mapping[str, Any]) -> str:
    """Return the summary on one line."""
    end = ""
    if facts["contact_fraction"] is not None:
        pressure = "any pressure" if facts["mean_pressure"] is None else f"{facts['mean_pressure']:.6g} Pa"
        end = f"last at {pressure}, contact fraction {facts['contact_fraction']:.6g}; "
    why = "" if facts["failure"] is None else f" ({facts['failure']})"
    how = f"{facts['status']}{why}"
    if facts["answered"] and facts["missed_targets"]:
        beyond = f"{len(facts['missed_targets'])} of the targets being tensions beyond that"
        how = f"{facts['status']}, answered: pulled off, {beyond}"
    return (
        f"{how}: "
        f"{facts['target_states']} states at targets ({facts['targets']} targets in the scene), "
        f"{facts['certified']} of {facts['states']} states certified, {facts['events']} events; {end}"
        f"{facts['evaluations']} evaluations, {facts['cpu_seconds']:.1f} s -> {facts['out']}"
    )


def scene_text(resolved: Mapping[str, Any]) -> str:
    """Return a resolved scene as TOML, absent tables as comments.

    Examples
    --------
    >>> print(scene_text({"title": "wave", "layer": None, "solid": {"poisson_ratio": 0.5}}))
    title = "wave"
    # [layer] absent
    [solid]
    poisson_ratio = 0.5
    """
    lines = []
    for name, table in resolved.items():
        if table is None:
            lines.append(f"# [{name}] absent")
        elif isinstance(table, Mapping):
            lines += [f"[{name}]", *(f"{key} = {toml_text(value)}" for key, value in table.items())]
        else:
            lines.append(f"{name} = {toml_text(table)}")
    return "\n".join(lines)


def groups_text(groups: Mapping[str, float], cautions: Iterable[Caution]) -> str:
    """Return the groups of a scene with their meanings, and the warnings."""
    texts = {name: f"# {name} = {value:.4g}" for name, value in groups.items()}
    width = max(map(len, texts.values()), default=0)
    lines = [f"{texts[name]:<{width}}  {MEANINGS.get(name, '')}" for name in texts]
    return "\n".join([*lines, *(f"warning: {caution.about}: {caution.message}" for caution in cautions)])


def effects_text(effects: Iterable[Effect]) -> str:
    """Return a table of effects: on or off, and the reason."""
    listed = tuple(effects)
    width = max(len(effect.name) for effect in listed)
    return "\n".join(
        f"{effect.name:<{width}}  {'on ' if effect.active else 'off'}  {effect.reason}" for effect in listed
    )


def size_text(estimate: MemoryEstimate) -> str:
    """Return the unknowns and the memory of a scene.

    Examples
    --------
    >>> size_text(MemoryEstimate(5128, 1.17e8)).partition(" GB")[0]
    'about 5,100 unknowns and 0.12'
    """
    unknowns = float(f"{estimate.unknowns:.2g}")
    return f"about {unknowns:,.0f} unknowns and {estimate.bytes / 1e9:.2g} GB of memory"


def toml_text(value: Any) -> str:
    """Return a plain value as TOML."""
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{key} = {toml_text(item)}" for key, item in value.items()) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(toml_text, value)) + "]"
    return json.dumps(value, ensure_ascii=False)
