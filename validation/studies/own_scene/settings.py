"""What is varied in a scene: the numerical settings, what the question leaves open, and what the model decides.

In the words of ASME V&V 20 (2009): numerical error is what another tolerance or increment changes; input uncertainty is
what another cut, detrending, window, part of the scan or realisation changes, all of which the question may mean as
well; the model is what the equations leave out, of which only the length that adhesion counts on can be varied here.
Every setting is the tables of a scene; one that a scene does not have is listed with the reason.
"""

import copy
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import numpy as np

from bem.geometry.table import plain
from bem.scans.read_scan import RawScan, read_scan
from bem.scans.scan_keys import SCAN_KEYS
from bem.scene.atomic_file import write_atomically
from bem.scene.scene import Scene, parse_scene
from validation.routes.scenes import changed

LARGEST_JUMP = 3.0  # rms steps at the end of the period
TILTED = 2.0  # rms heights without the tilt; a wave of one period has 1.6
Kind = Literal["base", "numerical", "input", "model"]
Tables = dict[str, Any]

BASE, FINEST = "as it is", "finest"
TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-6, 1e-9, 1e-12)
INCREMENTS = (8.0, 4.0, 2.0, 0.5, 0.25)  # of the scene's
FINEST_TOLERANCE, FINEST_INCREMENT = 1e-12, 0.25
CUTS = (0.25, 0.5, 2.0)  # of the scene's harmonics
DETRENDS = ("none", "mean", "line", "quadratic", "cubic")
PERIODICS = ("as_is", "mirror", "window")
LEAST_HARMONICS = 3
NO_SCAN = "the profile is not a scan"


@dataclass(frozen=True)
class Setting:
    """One way to solve a scene."""

    kind: Kind
    source: str  # what is varied: "tolerance", "cut", ...
    name: str  # how: "1e-08", "line", ...
    # of the scene, as of a scene file; empty where it has no such setting
    tables: Tables = field(default_factory=dict, compare=False)
    why_not: str = ""  # why it has none

    @property
    def title(self) -> str:
        """Source and name, said once."""
        return self.name if self.kind == "base" else f"{self.source} {self.name}"


def settings_of(scene: Scene, tables: Tables, places: tuple[Path, Path], seeds: int, quick: bool) -> list[Setting]:
    """All settings of a scene, of which the tables of its file are given: as it is, the finest, then by source.

    The places are the folder in which file names of the scene begin, and one for the parts of a scan; `seeds` counts
    realisations besides the scene's own. Quick: two settings of each numerical source instead of five.
    """
    accuracy = {
        "tolerance": min(FINEST_TOLERANCE, scene.accuracy.tolerance),
        "max_increment": FINEST_INCREMENT * scene.accuracy.max_increment,
    }
    found = [
        Setting("base", BASE, BASE, copy.deepcopy(tables)),
        Setting(
            "numerical",
            FINEST,
            ", ".join(f"{key} {value:g}" for key, value in accuracy.items()),
            changed(tables, {"accuracy": accuracy}),
        ),
    ]
    base = places[0]
    no_scan = NO_SCAN if scene.scan is None else ""
    no_path = "without adhesion no path is followed: each target is solved by itself" if scene.adhesion is None else ""
    not_random = "the profile is not a random one" if scene.profile.seed is None else ""
    sources: tuple[tuple[Kind, str, str, Changes], ...] = (
        ("numerical", "tolerance", "", _tolerances(scene, quick)),
        ("numerical", "max_increment", no_path, _increments(scene, quick)),
        ("input", "cut", "", _cuts(scene)),
        ("input", "detrending", no_scan, _detrends(scene, tables, base)),
        ("input", "window", no_scan, _windows(scene, tables, base)),
        ("input", "period", no_scan, _periods(scene, places)),
        ("input", "seed", not_random, _seeds(scene, seeds)),
        ("model", "slope term", "no adhesion" if scene.adhesion is None else "", _lengths(scene)),
    )
    for kind, source, why_none, changes in sources:
        for name, change in (("", why_none),) if why_none else changes:
            if isinstance(change, str):
                found.append(Setting(kind, source, name, why_not=change))
            else:
                found.append(Setting(kind, source, name, changed(tables, change)))
    return found


Change = Mapping[str, Mapping[str, Any]]
Changes = Iterator[tuple[str, Change | str]]  # of a source: names, with what changes or why nothing can


def _tolerances(scene: Scene, quick: bool) -> Changes:
    for value in TOLERANCES[1:4:2] if quick else TOLERANCES:
        if value != scene.accuracy.tolerance:
            yield f"{value:g}", {"accuracy": {"tolerance": value}}


def _increments(scene: Scene, quick: bool) -> Changes:
    for factor in INCREMENTS[1::3] if quick else INCREMENTS:
        value = factor * scene.accuracy.max_increment
        yield f"{value:g}", {"accuracy": {"max_increment": value}}


def _cuts(scene: Scene) -> Changes:
    profile = scene.profile
    if profile.orders is not None and profile.amplitudes is not None and profile.phases is not None:
        low = [k for k, order in enumerate(profile.orders) if order <= max(profile.orders) / 2]
        if not low:
            yield "", "the profile has no order below half of its highest"
            return
        lists = {"orders": profile.orders, "amplitudes": profile.amplitudes, "phases": profile.phases}
        kept = {key: [values[k] for k in low] for key, values in lists.items()}
        yield f"orders up to {max(kept['orders'])}", {"profile": kept}
        return
    count = int(profile.harmonics or 0)
    most = math.inf if scene.scan is None else scene.scan.max_harmonics
    for factor in CUTS:
        asked = round(min(factor * count, most) if factor > 1 else factor * count)
        name = f"{asked} harmonics"
        if asked == count:
            yield name, "the scan holds no more"
        elif asked < LEAST_HARMONICS:
            yield name, f"fewer than {LEAST_HARMONICS}"
        else:
            yield name, {"profile": {"harmonics": asked}}


def _detrends(scene: Scene, tables: Tables, base: Path) -> Changes:
    """Other trends to subtract, but those that leave one which is no roughness: the scan has ruled them out."""
    level = _left_by_detrending(scene)
    for method in DETRENDS:
        if method == scene.profile.detrend:
            continue
        change = {"profile": {"detrend": method}}
        leaning = _left_by_detrending(parse_scene(changed(tables, change), base))
        if leaning > TILTED * level:
            yield method, f"the scan rules it out: it leaves {leaning:.2g} m rms, of which {level:.2g} m is rough"
        else:
            yield method, change


def _left_by_detrending(scene: Scene) -> float:
    """Rms height of a scan after its trend is subtracted, m."""
    step = next(step for step in scene.preparation() if step["step"] == "detrend")
    return float(step["rms_height"][1])


def _windows(scene: Scene, tables: Tables, base: Path) -> Changes:
    """Ways to make a scan periodic, with the same shortest wavelength: a mirrored one has twice the period.

    As it is, a scan is not periodic where its ends do not meet.
    """
    count, own = int(scene.profile.harmonics or 0), scene.profile.periodic
    for method in PERIODICS:
        if method != own:
            factor = {own == "mirror": 0.5, method == "mirror": 2.0}.get(True, 1.0)
            harmonics = max(1, round(factor * count))
            change = {"profile": {"periodic": method, "harmonics": harmonics, "period": None}}
            scan = parse_scene(changed(tables, change), base).scan if method == "as_is" else None
            if scan is not None and scan.end_jump > LARGEST_JUMP:
                yield method, f"the scan rules it out: its ends are {scan.end_jump:.2g} rms steps apart"
            else:
                yield method, change


def _periods(scene: Scene, places: tuple[Path, Path]) -> Changes:
    """Halves of a scan in place of the whole, with the same shortest wavelength."""
    base, parts = places
    raw = read_scan(base / str(scene.profile.file), plain(scene.profile))
    middle = raw.h.size // 2
    for name, part in (("first half", slice(0, middle)), ("second half", slice(middle, None))):
        path = parts / f"{name.replace(' ', '-')}.txt"
        _write_part(path, raw, part)
        keys: dict[str, Any] = {**dict.fromkeys((*SCAN_KEYS, "period")), "file": str(path.resolve()), "decimal": "."}
        keys |= {"unit_x": "m", "unit_h": "m", "harmonics": max(1, int(scene.profile.harmonics or 2) // 2)}
        yield name, {"profile": keys}


def _write_part(path: Path, raw: RawScan, part: slice) -> None:
    """A part of a scan as a text file in m, to the last bit."""
    path.parent.mkdir(parents=True, exist_ok=True)
    rows = zip(raw.x[part].tolist(), raw.h[part].tolist(), strict=True)
    write_atomically(path, "".join(f"{x!r}\t{'nan' if np.isnan(h) else repr(h)}\n" for x, h in rows))


def _seeds(scene: Scene, count: int) -> Changes:
    own = int(scene.profile.seed or 0)
    for seed in range(own + 1, own + 1 + count):
        yield f"{seed}", {"profile": {"seed": seed}}


def _lengths(scene: Scene) -> Changes:
    other = scene.adhesion is not None and not scene.adhesion.slope_term
    yield f"adhesion on the {'true' if other else 'projected'} length", {"adhesion": {"slope_term": other}}
