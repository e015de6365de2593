"""Contact area with adhesion from the edges of the contact, for roughness in one direction.

At every edge the work of adhesion w holds the stress intensity sqrt(2 E* w).  Where n edges per nominal length, equally
spaced, bound the share A of the period, the load that these intensities carry in tension is (E* = 1)

    T_1 = sqrt(w n tan(pi A / 2)),

and the rest is the contact without adhesion of the same area, under its load p_d(A) (contact_slope.py):

    p = p_d(A) - T,      1/T = 1/T_1 + c m / p_d.

With c m = 0 this is the exact solution of one line (Johnson) and, for A -> 0, of a parabola (Johnson, Kendall,
Roberts).  For many patches it is right to first order in sqrt(w), with the edges of the contact without adhesion: every
edge moves by 2 sqrt(w/pi)/B, B the slope of the square-root pressure beside it, and the sum of that is T_1 dA/dp_d to
the scatter of the ensembles.  Beyond that fewer edges bound the same area, narrow gaps closing and patches growing in
place of more: c, with m the share of edges that roughness adds.

The edges are counted by the theory's own flux: all contact lost while the wavenumber q is resolved, -dA, is gaps of
half a wave, placed at random on what is left,

    n = q_0/pi + n_rough,   n_rough = k (1 - sum w_m^2) (2 A/pi) int q d(-ln A_q),   A_q = erf(u sqrt(S/S_q)),
    m = n_rough / n,        u = erfinv A,

with the two edges of one patch in each period 2 pi/q_0, and the shares w_m of the slope variance, so that one line has
one patch.  p(A) has a least value, the pull-off load (where negative), and a largest, above which contact is complete.
At given load the area is -d(enthalpy)/dw.  The enthalpy of reversible contact gives separation and energy from those
without adhesion, s_d(p) and U_d(p), by the work w(A, p) at which the contact has the area A:

    s = s_d + int dw/dp dA,     U_el = U_d + p (s_d - s) + int w dA,    from A_d(p) to A.

k and c are fitted on pairs of boundary-element ensembles, with and without adhesion on the same phases
(adhesive_edges.json, with the hold-out that they were judged on).  Sources: K. L. Johnson, Int. J. Solids Struct. 32
(1995) 423; K. L. Johnson, K. Kendall, A. D. Roberts, Proc. R. Soc. A 324 (1971) 301; the rest is derived here.  SI at
the edge.  Limits: half-space; means over phases; loading (retreat from a larger load has more contact); `outside`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.special import erf, erfc, erfinv

from persson.contact_slope import contact_fractions, period_wavenumber
from persson.domain import data_file, groups_of, outside, refuse_extremes
from persson.mathematics.arrays import FloatArray
from persson.nonadhesive import plane_strain_modulus
from persson.spectrum import Spectrum, slope_shares

FILE = "adhesive_edges.json"
LEAST, MOST = 1e-9, 20.0  # reference loads p_d over h'_rms that are searched
POINTS, REFINEMENTS, FINER = 120, 5, 50  # of the grid that brackets p_d, and of the search in its cell
PATH = 400  # steps of the integrals over the area
COMPLETE = 1e-9  # of 1 - A: nearer to full contact there is no edge


@dataclass(frozen=True)
class AdhesiveArea:
    """Contact with adhesion at one load; stresses in units of E*.

    Attributes
    ----------
    contact_fraction : float
        A/A0.
    reference_load : float
        p_d(A), the load that would hold this area without adhesion.
    edge_density : float
        Edges per nominal length, 1/m, that carry the tension.
    pull_off : float
        Least load over E* at which there is contact; < 0 where adhesion holds contact against tension.
    outside : tuple of str
        Where the case lies outside of the domain, in words; empty if nowhere.
    """

    contact_fraction: float
    reference_load: float
    edge_density: float
    pull_off: float
    outside: tuple[str, ...]


def data() -> dict[str, Any]:
    """Coefficients, domain, and what they were fitted to and judged on."""
    return data_file(FILE)


def contact_area(
    spectrum: Spectrum, mean_pressure: float, *, youngs_modulus: float, poisson_ratio: float, work_of_adhesion: float
) -> AdhesiveArea:
    """Contact area with adhesion at one load, which may be zero or tensile.

    Parameters
    ----------
    spectrum : DiscreteSpectrum or ContinuousSpectrum
    mean_pressure : float
        Pa; down to the pull-off.
    youngs_modulus, poisson_ratio : float
        E > 0 in Pa; nu in (-1, 0.5].
    work_of_adhesion : float
        gamma in J/m^2, > 0.

    Raises
    ------
    ValueError
        An argument outside its range, with its value; a tension beyond the pull-off, with both.

    Examples
    --------
    >>> from persson.spectrum import DiscreteSpectrum
    >>> lines = DiscreteSpectrum.self_affine(628.3, 0.7, 50e-6, 100)
    >>> solid = dict(youngs_modulus=1e6, poisson_ratio=0.5, work_of_adhesion=0.03)
    >>> round(contact_area(lines, 6667.0, **solid).contact_fraction, 3)
    0.128
    """
    modulus = plane_strain_modulus(youngs_modulus, poisson_ratio)
    if not np.isfinite(mean_pressure):
        raise ValueError(f"mean_pressure: {mean_pressure} must be finite (Pa)")
    if not (np.isfinite(work_of_adhesion) and work_of_adhesion > 0):
        raise ValueError(f"work_of_adhesion: {work_of_adhesion} must be finite and > 0 (J/m^2)")
    load, work = mean_pressure / modulus, work_of_adhesion / modulus
    refuse_extremes(spectrum, abs(load) or spectrum.slope_rms, work)
    law = EdgeLaw(spectrum, work)
    reference, fraction = law.at(load)
    found = groups_of(spectrum, load, fraction, work)
    return AdhesiveArea(
        fraction, reference, law.edge_density(reference, fraction), law.pull_off, outside(data()["domain"], found)
    )


class EdgeLaw:
    """p(A) of one spectrum and work of adhesion.

    Parameters
    ----------
    spectrum : DiscreteSpectrum or ContinuousSpectrum
    work_length : float
        gamma / E* in m, > 0.
    coefficients : mapping, optional
        k and c; None for those of the package.

    Attributes
    ----------
    pull_off, complete : float
        Least and largest load over E* of contact with edges.
    """

    def __init__(self, spectrum: Spectrum, work_length: float, coefficients: Mapping[str, float] | None = None) -> None:
        self.spectrum, self.work = spectrum, work_length
        value = coefficients or data()["coefficients"]
        wavenumbers, shares = slope_shares(spectrum)
        first = period_wavenumber(spectrum)
        self._one = 0.0 if first is None else first / np.pi
        self._rough = 2 / np.pi * value["k"] * max(1 - float(shares @ shares), 0.0)
        self._closing = value["c"]
        self._wavenumbers, self._resolved = wavenumbers, np.minimum(np.cumsum(shares), 1.0)
        grid = np.geomspace(LEAST, MOST, POINTS) * spectrum.slope_rms
        grid = grid[1 - contact_fractions(spectrum, grid)[0] > COMPLETE]
        loads = self.load(grid)
        top = int(np.argmax(loads))
        for place in {int(np.argmin(loads[: top + 1])), top}:  # the extremes, to the square of 1/FINER of a cell
            near = grid[max(place - 1, 0) : place + 2]
            grid = np.union1d(grid, np.linspace(near[0], near[-1], FINER))
        loads = self.load(grid)
        least, top = int(np.argmin(loads[: np.argmax(loads) + 1])), int(np.argmax(loads))
        self._grid, self._loads = grid[least : top + 1], loads[least : top + 1]
        self.pull_off, self.complete = min(float(loads[least]), 0.0), float(loads[top])

    def edges(self, area: FloatArray) -> tuple[FloatArray, FloatArray]:
        """n without adhesion in 1/m, and m, of the shape (n,) of the contact fractions."""
        depth = erfinv(area)[:, None] / np.sqrt(self._resolved)
        left = np.where(depth < 1, np.log(erf(depth)), np.log1p(-erfc(np.maximum(depth, 1.0))))  # ln A_q, all digits
        lost = np.diff(-left, axis=1, prepend=0.0)
        rough = self._rough * area * (lost @ self._wavenumbers)
        return self._one + rough, rough / (self._one + rough)

    def tension(self, reference: FloatArray, area: FloatArray) -> FloatArray:
        """T at reference loads p_d and contact fractions, (n,) each, in units of E*."""
        density, share = self.edges(area)
        alone = np.sqrt(self.work * density * np.tan(np.pi * area / 2))
        return np.asarray(alone / (1 + self._closing * share * alone / reference))

    def work_for(self, reference: FloatArray, area: FloatArray, load: float) -> tuple[FloatArray, FloatArray]:
        """Work of adhesion (m) at which the area is held at a load, and its derivative by the load, (n,) each."""
        density, share = self.edges(area)
        shift = reference - load
        slack = 1 - self._closing * share * shift / reference
        alone, capacity = shift / slack, density * np.tan(np.pi * area / 2)
        return alone**2 / capacity, -2 * alone / (slack**2 * capacity)

    def load(self, reference: FloatArray) -> FloatArray:
        """p at reference loads p_d, (n,), in units of E*."""
        area = contact_fractions(self.spectrum, reference)[0]
        return np.asarray(reference - self.tension(reference, area))

    def at(self, load: float) -> tuple[float, float]:
        """p_d and A at a load; (p, 1) where contact is complete.

        Raises
        ------
        ValueError
            Below the pull-off, or a load over E* h'_rms below `LEAST` that adhesion does not hold.
        """
        if load >= self.complete:
            return load, 1.0
        below = np.flatnonzero(self._loads < load)
        if below.size == 0:
            raise ValueError(
                f"mean_pressure: {load:g} E* must be above {self._loads[0]:g} E*, the pull-off (or least load searched)"
            )
        low, high = self._grid[below[-1]], self._grid[below[-1] + 1]
        for _ in range(REFINEMENTS):
            between = np.linspace(low, high, FINER + 1)
            last = int(np.flatnonzero(self.load(between[:-1]) < load)[-1])
            low, high = between[last], between[last + 1]
        return float(high), float(contact_fractions(self.spectrum, np.array([high]))[0][0])

    def edge_density(self, reference: float, area: float) -> float:
        """Edges per nominal length, 1/m, that carry the tension: T^2 / (w tan(pi A / 2)); 0 in complete contact."""
        if area >= 1:
            return 0.0
        tension = self.tension(np.array([reference]), np.array([area]))[0]
        return float(tension**2 / (self.work * np.tan(np.pi * area / 2)))

    def changes(self, load: float, reference: float) -> tuple[float, float]:
        """s - s_d and U_el - U_d (m) at a load over E* > 0 that a reference load p_d belongs to."""
        path = np.linspace(load, reference, PATH + 1)
        area = contact_fractions(self.spectrum, path)[0]
        inside = 1 - area > COMPLETE
        work, rate = self.work_for(path[inside], area[inside], load)
        shift = float(np.trapezoid(rate, area[inside]))
        return shift, float(np.trapezoid(work, area[inside])) - load * shift
