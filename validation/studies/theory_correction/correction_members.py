"""The profiles on which the theory is corrected, and those on which it is judged, as scenes.

Every profile is scaled to the rms slope of the paper's, 0.272, so that the loads, 0.001 to 0.05 E*, mean the same
p/(E* h'_rms) for all: without adhesion nothing else of the amplitudes matters.  Adhesion is theta = gamma / U,
U = E* sum q_m h_m^2 / 8 the elastic energy of full contact per nominal area: the paper's 0.03 J/m^2 is theta = 0.027.

fit        H 0.3, 0.5, 0.7, 0.9; 30 to 1000 harmonics; no adhesion, which has a fit of its own (adhesive_edges.py)
hold-out   other H, other bandwidth, other seeds, other loads, theta to 0.06: self-affine; with a roll-off (equal
           heights up to order 16, then H = 0.8); not fractal (a Gaussian power spectrum, h_m ~ exp(-(m/40)^2/2); eight
           lines a factor 1.8 apart)

The split is this file: nothing of the hold-out enters a fit.  Large profiles have fewer realisations, the largest one,
without adhesion: cost grows as bandwidth^1.5 and more, and 3000 harmonics would take hours.  Source of the paper's
profile: Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65, arXiv:1006.0601.  Half-space, plane strain,
loading from first touch, no slope term.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from persson.spectrum import DiscreteSpectrum
from validation.harness.ensemble import Member, member_seed
from validation.references import paper_problem
from validation.references.paper_problem import MODULUS
from validation.studies.contact_slope import lines_of, shape_of

FIT_LOADS = (0.001, 0.002, 0.005, 0.01, 0.02, 0.03, 0.05)  # of E*
HOLD_OUT_LOADS = (0.0015, 0.003, 0.007, 0.014, 0.025, 0.04)
FIT_ROOT, HOLD_OUT_ROOT = 820, 821  # of the seeds
LINES = (1, 2, 3, 6, 10, 19, 34, 61)
DEEPEST = 1e-4  # separation in rms heights: the load stops the path long before


@dataclass(frozen=True)
class Group:
    """Realisations that differ in their phases alone.

    Parameters
    ----------
    part : "fit" or "hold-out"
    kind : "self-affine", "roll-off", "gaussian" or "lines"
    hurst : float
        nan where the spectrum has none.
    harmonics : int
        The highest order.
    theta : float
        Work of adhesion over the elastic energy of full contact; 0 for none.
    realisations : int
    """

    part: str
    kind: str
    hurst: float
    harmonics: int
    theta: float
    realisations: int

    @property
    def name(self) -> str:
        """Of its members, without their number."""
        exponent = "" if np.isnan(self.hurst) else f"-H{self.hurst:g}"
        return f"{self.part}-{self.kind}{exponent}-M{self.harmonics}-t{self.theta:g}"

    @property
    def loads(self) -> tuple[float, ...]:
        """Over E*."""
        return FIT_LOADS if self.part == "fit" else HOLD_OUT_LOADS

    @property
    def spectrum(self) -> dict[str, Any]:
        """As contact_slope.py takes it."""
        roll_off, breadth = 16, 40.0
        given = {
            "self-affine": [self.hurst, self.harmonics],
            "roll-off": [roll_off, self.hurst, self.harmonics],
            "gaussian": [breadth, self.harmonics],
            "lines": [LINES, 1.1],
        }
        return {"spectrum": self.kind, "parameters": given.get(self.kind, [1])}

    @property
    def lines(self) -> DiscreteSpectrum:
        """Of the rms slope that all share."""
        return lines_of(self.spectrum)

    @property
    def work_of_adhesion(self) -> float | None:
        """In J/m^2; None without adhesion."""
        return self.theta * MODULUS * self.lines.full_contact_energy if self.theta else None

    def member(self, k: int) -> Member:
        """Realisation k: from first touch to the highest load; without adhesion, with no path to follow, by loads."""
        seed = member_seed(FIT_ROOT if self.part == "fit" else HOLD_OUT_ROOT, k)
        orders, amplitudes = shape_of(self.spectrum)[0], self.lines.amplitudes
        phases = np.random.default_rng(seed).uniform(-np.pi, np.pi, orders.size)
        pressures = [load * MODULUS for load in self.loads]
        loading = {"control": "mean_pressure", "targets": pressures}
        if self.theta:
            loading = paper_problem.up_to(pressures, DEEPEST * self.lines.h_rms)
        scene = paper_problem.scene(
            f"theory correction: {self.name}, realisation {k}, seed {seed}",
            paper_problem.lines(orders, amplitudes, phases),
            loading,
            self.work_of_adhesion,
            accuracy={"tolerance": 1e-5},
            output={"pressure_distribution": True},
        )
        return Member(f"{self.name}-{k:02d}", scene)

    def members(self) -> list[Member]:
        """All realisations."""
        return [self.member(k) for k in range(self.realisations)]


def groups(quick: bool = False) -> tuple[Group, ...]:
    """All groups of the study, or a few small ones that show that everything runs."""
    return (*_fit(quick), *_hold_out(quick))


def _fit(quick: bool) -> Iterator[Group]:
    if quick:
        for hurst in (0.5, 0.8):
            yield Group("fit", "self-affine", hurst, 12, 0.0, 4)
        return
    for hurst in (0.3, 0.5, 0.7, 0.9):
        for harmonics, realisations in ((30, 16), (100, 8), (300, 6)):
            yield Group("fit", "self-affine", hurst, harmonics, 0.0, realisations)
    yield Group("fit", "self-affine", 0.7, 1000, 0.0, 1)


def _hold_out(quick: bool) -> Iterator[Group]:
    if quick:
        yield Group("hold-out", "lines", np.nan, LINES[-1], 0.0, 4)
        yield Group("hold-out", "self-affine", 0.6, 16, 0.05, 4)
        return
    for hurst in (0.4, 0.6, 0.8):
        for harmonics, realisations in ((64, 10), (200, 6), (500, 4)):
            yield Group("hold-out", "self-affine", hurst, harmonics, 0.0, realisations)
    for hurst, harmonics, theta, realisations in (
        (0.4, 64, 0.02, 6),
        (0.6, 200, 0.02, 4),
        (0.8, 64, 0.06, 6),
        (0.8, 200, 0.02, 4),
        (0.6, 64, 0.06, 6),
        (0.4, 200, 0.06, 4),
    ):
        yield Group("hold-out", "self-affine", hurst, harmonics, theta, realisations)
    for theta in (0.0, 0.03):
        few = theta > 0
        yield Group("hold-out", "roll-off", 0.8, 256, theta, 2 if few else 6)
        yield Group("hold-out", "gaussian", np.nan, 120, theta, 4 if few else 6)
        yield Group("hold-out", "lines", np.nan, LINES[-1], theta, 6 if few else 12)
