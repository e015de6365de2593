"""Rules of a scene beyond the type and range of each key: keys that need, exclude or bound one another.

The rules take the plain values of the keys that are valid by themselves (`values`), and the names of all keys present
(`given`).  So one mistake does not hide another.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Any

from bem.geometry.ranges import Mistake, as_said, harmonic_mistakes, shown
from bem.scans.scan_keys import CUTOFFS, DEFAULTS, SCAN_KEYS

REQUIRED = {
    "self_affine": ("period", "hurst", "rms_height", "harmonics"),
    "harmonics": ("period", "orders", "amplitudes", "phases"),
    "samples": ("file",),
}
OPTIONAL = {
    "self_affine": ("seed",),
    "harmonics": (),
    "samples": ("period", "harmonics", *SCAN_KEYS, *DEFAULTS, *CUTOFFS),
}
FLAWS = (1e-12, 0.95)  # limit: loading.flaw over the period: what is left in contact beside a wider one is no flaw
RANGE = ("start", "stop", "count")
QUESTIONS = ("title", "loading", "accuracy", "output")  # of a scene; all other tables say what is in contact


def profile_mistakes(values: Mapping[str, Any], given: Collection[str]) -> Iterator[Mistake]:
    """Yield missing keys and unused keys of the kind of profile, and lists that do not match."""
    kind = values.get("kind")
    if kind is None:
        return
    for key in REQUIRED[kind]:
        if key not in given:
            yield Mistake(f"profile.{key}", "is missing", f'kind = "{kind}" needs it')
    used = ("kind", *REQUIRED[kind], *OPTIONAL[kind])
    for key in given:
        if key in values and key not in used:
            yield Mistake(f"profile.{key}", f"= {shown(values[key])}", f'kind = "{kind}" uses {", ".join(used)} only')
    if "every" in values and values.get("row") != "all":
        yield Mistake("profile.every", f"= {shown(values['every'])}", 'row = "all" beside it, or leave it out')
    if kind == "self_affine" and values.get("harmonics") == "all":
        yield Mistake("profile.harmonics", '= "all"', "an integer >= 1: only samples have a last one")
    if kind != "harmonics":
        return
    yield from harmonic_mistakes(values)


def loading_mistakes(
    values: Mapping[str, Any], given: Collection[str], tables: Collection[str], period: float | None
) -> Iterator[Mistake]:
    """Yield mistakes of the path, of the signs of separations, and of the needs of the control and the initial state.

    `values` and `given` are of [loading], `tables` are the names of the tables present; `period` is profile.period, if
    known.
    """
    yield from _path_mistakes(values, given)
    control = values.get("control")
    if control == "separation":
        for key in ("targets", "start", "stop", "then_back_to"):
            yield from _negative(f"loading.{key}", values.get(key))
    if control == "total_displacement" and "layer" not in tables:
        yield Mistake(
            "loading.control",
            '= "total_displacement" has no meaning on a half-space',
            '"separation", "penetration" or "mean_pressure", or add [layer]',
        )
    flaw_needed = control == "mean_pressure" and values.get("initial") == "complete_contact" and "adhesion" in tables
    if flaw_needed and "flaw" not in given:
        yield Mistake(
            "loading.flaw",
            "is missing",
            "a number > 0 (m): mean-pressure control from complete contact with adhesion needs it",
        )
    flaw = values.get("flaw")
    lowest, highest = (as_said(share * (period or 1.0)) for share in FLAWS)
    if flaw is not None and period is not None and not lowest <= flaw <= highest:
        allowed = f"a number from {lowest:g} to {highest:g} (m), {FLAWS[0]:g} to {FLAWS[1]:g} times profile.period"
        yield Mistake("loading.flaw", f"= {flaw:g}", allowed)


def _path_mistakes(values: Mapping[str, Any], given: Collection[str]) -> Iterator[Mistake]:
    """Yield mistakes of the path, which is given by targets, or by start, stop, count and perhaps then_back_to."""
    ranged = [key for key in (*RANGE, "then_back_to") if key in given]
    if "targets" in given and ranged:
        yield Mistake("loading.targets", f"and {', '.join(ranged)} are both given", "targets, or start, stop and count")
    elif "targets" not in given and not ranged:
        yield Mistake("loading.targets", "is missing", "targets, or start, stop and count: the path is empty")
    elif ranged:
        for key in RANGE:
            if key not in given:
                yield Mistake(f"loading.{key}", "is missing", "start, stop and count together, or targets")
    start, stop, back = (values.get(key) for key in ("start", "stop", "then_back_to"))
    if start is not None and stop is not None:
        if start == stop:
            yield Mistake("loading.stop", f"= {stop:g} equals start", "a value other than start, or targets")
        elif back is not None and (back - stop) * (start - stop) <= 0:
            yield Mistake(
                "loading.then_back_to", f"= {back:g}", f"a value on the same side of stop = {stop:g} as start"
            )


def _negative(path: str, value: float | Sequence[float] | None) -> Iterator[Mistake]:
    """Yield separations below zero."""
    allowed = "a separation > 0 (m), or exactly 0 for complete contact"
    if isinstance(value, list | tuple):
        for k, item in enumerate(value):
            if item < 0:
                yield Mistake(f"{path}[{k}]", f"= {item:g}", allowed)
    elif isinstance(value, int | float) and value < 0:
        yield Mistake(path, f"= {value:g}", allowed)
