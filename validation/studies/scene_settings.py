"""Settings in which the study solves a scene: numerical settings, and choices that the data leave open.

tolerance   1e-3, 1e-6, 1e-9 of [accuracy]
cut         half and twice the shortest wave: cutoff_short where the scene has it, else harmonics (or orders); of a scan
            also all waves above its noise floor, or all of the first `MOST_HARMONICS` where it shows no floor
detrending  other trends that leave a profile no more tilted than the scene's
window      other ways to continue a scan, with the shortest wave kept
part        first and second half of a scan, with the shortest wave kept
row         three other rows of a map, a quarter of it apart
noise       white noise of the scan's own noise floor added to its samples
seed        other realisations of a random profile
length      adhesion on the true or on the projected length (slope_term)

A scan that repeats as it is and whose ends another trend, part or row parts is followed by its mirror image there.
A setting is the tables of a scene.  A setting that the scene or the scan refuses has the reason instead.
"""

import copy
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from bem.geometry.arrays import FloatArray
from bem.scans.scan_keys import SCAN_KEYS
from bem.scene.atomic_file import write_atomically
from bem.scene.scene import Scene, SceneError, parse_scene
from validation.routes.scenes import changed

Tables = dict[str, Any]
TOLERANCES = (1e-3, 1e-6, 1e-9)
BASE, TOLERANCE, SEED = "as it is", "tolerance", "seed"
SOURCES = ("cut", "detrending", "window", "part", "row", "noise", SEED, "length")
DETRENDS = ("none", "mean", "line", "quadratic", "cubic")
PERIODICS = ("as_is", "mirror", "window")
CONTINUED = ("detrending", "part", "row")  # settings that may part the ends of a scan
LEAST_HARMONICS, MOST_HARMONICS = 3, 1000
TILTED = 3.0  # times the rms height that the scene's own detrending leaves
SAME_CUT = 1e-3  # format: cut-offs are written with four digits
LARGEST_JUMP = 5.0  # rms steps between the ends of a scan that is continued as it is


@dataclass(frozen=True)
class Setting:
    """Way to solve a scene.

    Attributes
    ----------
    source : kind of choice that is varied.
    name : value of the varied choice.
    tables : content of the scene file; empty if there is a reason.
    reason : why the setting is not solved.
    """

    source: str
    name: str
    tables: Tables = field(default_factory=dict)
    reason: str = ""

    @property
    def title(self) -> str:
        """Source and name."""
        return BASE if self.source == BASE else f"{self.source}: {self.name}"


def settings_of(scene: Scene, tables: Tables, base: Path, parts: Path, seeds: int) -> list[Setting]:
    """Return all settings of a scene, first the scene as it is, then the tolerances.

    Parameters
    ----------
    tables : tables of the scene file.
    base : folder in which file names of the scene begin.
    parts : folder for the files of changed scans.
    seeds : realisations besides the scene's own.
    """
    change = Change(scene, tables, base, parts)
    settings = [Setting(BASE, BASE, copy.deepcopy(tables))]
    for tolerance in TOLERANCES:
        settings.append(change.to(TOLERANCE, f"{tolerance:g}", {"accuracy": {"tolerance": tolerance}}))
    settings += change.cuts()
    if scene.scan is not None:
        settings += [
            *change.uncut(),
            *change.detrends(),
            *change.windows(),
            *change.halves(),
            *change.rows(),
            *change.noise(),
        ]
    if scene.profile.seed is not None:
        own = scene.profile.seed
        settings += [change.to(SEED, f"{k}", {"profile": {"seed": k}}) for k in range(own + 1, own + 1 + seeds)]
    if scene.adhesion is not None:
        term = not scene.adhesion.slope_term
        name = f"adhesion on the {'true' if term else 'projected'} length"
        settings.append(change.to("length", name, {"adhesion": {"slope_term": term}}))
    return settings


@dataclass(frozen=True)
class Change:
    """Maker of settings from one scene."""

    scene: Scene
    tables: Tables
    base: Path
    parts: Path

    def to(self, source: str, name: str, values: Mapping[str, Mapping[str, Any]], *, recut: bool = False) -> Setting:
        """Return the setting with these keys (None: left out); with `recut` its harmonics keep the shortest wave."""
        tables = changed(self.tables, values)
        try:
            if source in CONTINUED and self._parts_company(tables):
                tables["profile"] |= {"periodic": "mirror"}
                tables["profile"].pop("period", None)
                name = f"{name}, then its mirror image"
            if recut:
                tables["profile"].pop("harmonics", None)
                scan, profile = parse_scene(tables, self.base).scan, self.scene.profile
                if scan is not None:
                    shortest = float(profile.period or 1.0) / self._harmonics
                    tables["profile"]["harmonics"] = max(1, min(round(scan.period / shortest), scan.max_harmonics))
            parse_scene(tables, self.base)
        except SceneError as error:
            return Setting(source, name, reason=str(error))
        return Setting(source, name, tables)

    def _parts_company(self, tables: Tables) -> bool:
        """Return whether a scan that repeats as it is would have a step between its ends that the scene's has not."""
        own, other = self.scene.scan, parse_scene(tables, self.base)
        if own is None or other.scan is None or other.profile.periodic != "as_is":
            return False
        return own.end_jump <= LARGEST_JUMP < other.scan.end_jump

    @property
    def _harmonics(self) -> int:
        return int(self.scene.profile.harmonics or 1)

    def cuts(self) -> Iterator[Setting]:
        """Yield half and twice the shortest wave."""
        profile = self.scene.profile
        if profile.cutoff_short is not None:
            for factor in (0.5, 2.0):
                length = factor * profile.cutoff_short
                yield self.to("cut", f"cutoff_short {length:.4g} m", {"profile": {"cutoff_short": length}})
        elif profile.orders is not None and profile.amplitudes is not None and profile.phases is not None:
            low = [k for k, order in enumerate(profile.orders) if order <= max(profile.orders) / 2]
            name = f"orders up to {max(profile.orders) / 2:g}"
            lists = {"orders": profile.orders, "amplitudes": profile.amplitudes, "phases": profile.phases}
            lower = {key: [values[k] for k in low] for key, values in lists.items()}
            yield self.to("cut", name, {"profile": lower}) if low else Setting("cut", name, reason="no order is left")
        else:
            most = np.inf if self.scene.scan is None else self.scene.scan.max_harmonics
            for harmonics in (self._harmonics // 2, int(min(2 * self._harmonics, most))):
                name = f"{harmonics} harmonics"
                if harmonics == self._harmonics:
                    yield Setting("cut", name, reason="the scan holds no more")
                elif harmonics < LEAST_HARMONICS:
                    yield Setting("cut", name, reason=f"fewer than {LEAST_HARMONICS}")
                else:
                    yield self.to("cut", name, {"profile": {"harmonics": harmonics}})

    def uncut(self) -> Iterator[Setting]:
        """Yield the scan with all waves above its noise floor, at most `MOST_HARMONICS`, unless the scene has them."""
        scan, cutoff = self.scene.scan, self.scene.profile.cutoff_short
        assert scan is not None
        floor = scan.spectrum.crossing
        most = min(scan.max_harmonics, MOST_HARMONICS)
        if floor is not None:
            if cutoff is None or floor < cutoff * (1 - SAME_CUT):
                name = f"to the noise floor, cutoff_short {floor:.4g} m"
                yield self.to("cut", name, {"profile": {"cutoff_short": floor, "harmonics": None}})
        elif cutoff is not None or most > 2 * self._harmonics:
            yield self.to("cut", f"none, {most} harmonics", {"profile": {"cutoff_short": None, "harmonics": most}})

    def detrends(self) -> Iterator[Setting]:
        """Yield other trends, except trends that leave the profile tilted."""
        level = _left_by_detrending(self.scene)
        for method in DETRENDS:
            same = {method, self.scene.profile.detrend} <= {"none", "mean"}  # a constant height changes nothing
            if method == self.scene.profile.detrend or same:
                continue
            setting = self.to("detrending", method, {"profile": {"detrend": method}})
            left = _left_by_detrending(parse_scene(setting.tables, self.base)) if setting.tables else 0.0
            tilted = f"leaves {left:.2g} m rms, {level:.2g} m of it rough"
            yield Setting("detrending", method, reason=tilted) if left > TILTED * level else setting

    def windows(self) -> Iterator[Setting]:
        """Yield other continuations, except as it is where the ends do not meet."""
        for method in PERIODICS:
            if method == self.scene.profile.periodic:
                continue
            setting = self.to("window", method, {"profile": {"periodic": method, "period": None}}, recut=True)
            scan = parse_scene(setting.tables, self.base).scan if setting.tables and method == "as_is" else None
            apart = scan is not None and scan.end_jump > LARGEST_JUMP
            yield Setting("window", method, reason="the ends of the scan do not meet") if apart else setting

    def halves(self) -> Iterator[Setting]:
        """Yield both halves of the scan."""
        x, h = self._measured
        middle = h.size // 2
        yield self._from_file("part", "first half", x[:middle], h[:middle])
        yield self._from_file("part", "second half", x[middle:], h[middle:])

    def rows(self) -> Iterator[Setting]:
        """Yield three other rows of a map, a quarter of it apart; nothing where the file is no map."""
        row = self.scene.profile.row
        if row is None:
            return
        own = row if isinstance(row, int) else 0
        count = int(self.scene.preparation()[0]["rows"])
        for other in dict.fromkeys((own + quarter * count // 4) % count for quarter in (1, 2, 3)):
            if other != row:
                yield self.to("row", f"{other}", {"profile": {"row": other}})

    def noise(self) -> Iterator[Setting]:
        """Yield the scan with noise of its own floor added, once; nothing where the scan shows no floor."""
        scan = self.scene.scan
        rms = 0.0 if scan is None else scan.spectrum.noise_rms
        if rms > 0:
            x, h = self._measured
            noisy = h + np.random.default_rng(0).normal(0.0, rms, h.size)
            yield self._from_file("noise", f"{rms:.2g} m rms added", x, noisy)

    @property
    def _measured(self) -> tuple[FloatArray, FloatArray]:
        assert self.scene.scan is not None
        return self.scene.scan.measured.x, self.scene.scan.measured.h

    def _from_file(self, source: str, name: str, x: FloatArray, h: FloatArray) -> Setting:
        """Write samples as a text file in m, and return the setting that reads them."""
        path = self.parts / f"{source}-{name.split()[0]}.txt"
        path.parent.mkdir(parents=True, exist_ok=True)
        rows = zip(x.tolist(), h.tolist(), strict=True)
        write_atomically(path, "".join(f"{a!r}\t{'nan' if np.isnan(b) else repr(b)}\n" for a, b in rows))
        keys: dict[str, Any] = {**dict.fromkeys((*SCAN_KEYS, "period")), "file": str(path.resolve())}
        return self.to(source, name, {"profile": keys | {"unit_x": "m", "unit_h": "m"}}, recut=True)


def _left_by_detrending(scene: Scene) -> float:
    """Return the rms height of a scan after its trend is subtracted, m."""
    step = next(step for step in scene.preparation() if step["step"] == "detrend")
    return float(step["rms_height"][1])
