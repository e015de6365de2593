"""Fitted contact area with adhesion, from the edges of the contact; roughness in one direction.

At every edge the work of adhesion w holds the stress intensity sqrt(2 E* w).  Where n edges per nominal length, equally
spaced, bound the share A of the period, these intensities carry a load in tension (E* = 1)

    T_1 = sqrt(w n tan(pi A / 2)).

The rest is the contact without adhesion of the same area, under its load p_d(A) (contact_slope.py):

    p = p_d(A) - T,      1/T = 1/T_1 + c m / p_d.

With c m = 0 this is the exact solution of one line (Johnson) and, for A -> 0, of a parabola (Johnson, Kendall,
Roberts).  For many patches it is right to first order in sqrt(w), with the edges of the contact without adhesion: every
edge moves by 2 sqrt(w/pi)/B, with B the slope of the square-root pressure beside it, and these moves add up to
T_1 dA/dp_d within the scatter of the ensembles.  Beyond first order fewer edges bound the same area, because narrow
gaps close and patches grow instead of becoming more: c describes this, with m the share of edges that roughness adds.

The theory's own flux counts the edges: all contact lost while the wavenumber q is resolved, -dA, is gaps of half a
wave, placed at random on the remaining contact,

    n = q_0/pi + n_rough,   n_rough = k (1 - sum w_m^2) (2 A/pi) int q d(-ln A_q),   A_q = erf(u sqrt(S/S_q)),
    m = n_rough / n,        u = erfinv A,

with the two edges of one patch in each period 2 pi/q_0, and the shares w_m of the slope variance, so that one line has
one patch.  p(A) has a least value, the pull-off load (where negative), and a largest, above which contact is complete.

k = 1.907 +- 0.106 and c = 0.764 +- 0.072 are fitted by validation/fits/areas.py on pairs of boundary-element
ensembles, with and without adhesion on the same phases (16 spectra, 111 realisations, seed root 31; errors by a
jackknife over the spectra; domain and hold-out errors: fitted_area.py).  Sources: K. L. Johnson, Int. J. Solids Struct.
32 (1995) 423; K. L. Johnson, K. Kendall, A. D. Roberts, Proc. R. Soc. A 324 (1971) 301; the rest is derived here.
Stresses in units of E*.  Limits: half-space; means over phases; loading (retreat from a larger load has more contact).
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy.special import erf, erfc, erfinv

from persson.contact_slope import contact_fractions, period_wavenumber
from persson.mathematics.arrays import FloatArray
from persson.spectrum import Spectrum, slope_shares

COEFFICIENTS = {"k": 1.907, "c": 0.764}
LEAST, MOST = 1e-9, 20.0  # reference loads p_d over h'_rms that are searched
POINTS, REFINEMENTS, FINER = 120, 5, 50  # of the grid that brackets p_d, and of the search in its cell
COMPLETE = 1e-9  # of 1 - A: nearer to full contact there is no edge


class EdgeLaw:
    """Load p(A) of one spectrum and work of adhesion.

    Parameters
    ----------
    spectrum : DiscreteSpectrum or ContinuousSpectrum
    work_length : float
        gamma / E* in m, > 0.
    coefficients : mapping, optional
        Other values of k and c, for the fit.

    Attributes
    ----------
    pull_off, complete : float
        Least and largest load over E* of contact with edges.
    """

    def __init__(
        self, spectrum: Spectrum, work_length: float, coefficients: Mapping[str, float] = COEFFICIENTS
    ) -> None:
        self.spectrum, self.work = spectrum, work_length
        wavenumbers, shares = slope_shares(spectrum)
        first = period_wavenumber(spectrum)
        self._periodic = 0.0 if first is None else first / np.pi
        self._rough = 2 / np.pi * coefficients["k"] * max(1 - float(shares @ shares), 0.0)
        self._closing = coefficients["c"]
        self._wavenumbers, self._resolved = wavenumbers, np.minimum(np.cumsum(shares), 1.0)
        grid = np.geomspace(LEAST, MOST, POINTS) * spectrum.slope_rms
        grid = grid[1 - contact_fractions(spectrum, grid) > COMPLETE]
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
        """Return edges per length n without adhesion, 1/m, and the share m that roughness adds, at each area."""
        depth = erfinv(area)[:, None] / np.sqrt(self._resolved)
        # ln A_q, all digits
        logarithm = np.where(depth < 1, np.log(erf(depth)), np.log1p(-erfc(np.maximum(depth, 1.0))))
        lost = np.diff(-logarithm, axis=1, prepend=0.0)
        rough = self._rough * area * (lost @ self._wavenumbers)
        return self._periodic + rough, rough / (self._periodic + rough)

    def tension(self, reference: FloatArray, area: FloatArray) -> FloatArray:
        """Return T at reference loads p_d and contact fractions, (n,) each, in units of E*."""
        density, share = self.edges(area)
        alone = np.sqrt(self.work * density * np.tan(np.pi * area / 2))
        return np.asarray(alone / (1 + self._closing * share * alone / reference))

    def load(self, reference: FloatArray) -> FloatArray:
        """Return p at reference loads p_d, (n,), in units of E*."""
        area = contact_fractions(self.spectrum, reference)
        return np.asarray(reference - self.tension(reference, area))

    def at(self, load: float) -> tuple[float, float]:
        """Return p_d and A at a load; (p, 1) where contact is complete.

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
        return float(high), float(contact_fractions(self.spectrum, np.array([high]))[0])
