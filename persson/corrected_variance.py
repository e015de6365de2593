"""How the stress spreads in partial contact: the energy factor S that the corrections put beside the plain theory.

In the plain theory the stress in the regions of contact fluctuates as it would in full contact, dV = dS/4, whatever
the contact fraction A.  Where contact is partial the solid relaxes beside it: a line stores dU_el = E* A S dV / q with
S < 1, S = 1 in full contact.  The elastic energy is the stress spectrum over the stiffness, so the stress variance
grows by A S dV too, in one of three ways:

    slower   the stress diffuses more slowly, dP/dV = 1/2 S d2P/dsigma2: the plain theory in the time tau = int S dV
    total    the same with tau = S V: all lines feel the contact fraction of the last
    drift    the stress diffuses as before and drifts back to its mean over the contact,
             dP/dV = 1/2 d2P/dsigma2 + d[beta (sigma - m) P]/dsigma,  m = <sigma>/A,  beta = (1 - S) / (2 var),
             var the variance over the contact: the one linear drift that keeps the load and stores what S allows

The factor, of the contact fraction A, the wavenumber q and the breadth b of the roughness resolved so far:

    polynomial  S = sum_k c_k A^k, the literature's
    breadth     c_0 becomes c_0 b / (b + b_0), b = ln q - <ln q>, the mean over the slope variance resolved; the other
                coefficients grow together so that their sum stays 1: a narrow band relaxes more than a broad one
    window      S times 1 - exp(-k n A / (1 - A)), n = q/q_1: a wave longer than what is in contact, the share A of the
                longest wave, presses it as a whole and does not spread the stress in it

With adhesion the corrections of the literature take the theory's own fixed point (adhesive.py).  For roughness in one
direction that finds far too little: gamma_eff is below zero but for the last lines, while in fact every edge of contact
is pulled out at once.  A correction with `edges` takes the law of adhesive_edges.py in place of it, and the area of
contact_slope.py without adhesion; energy and separation without adhesion remain those of the factor.

    yang_persson_2008   slower, S = 0.45 + 0.55 A^2
    wang_muser_2017     slower, S = 5/9 - 2/9 A^2 + 2/3 A^4, without and with adhesion
    xu_2024             total,  S = 0.42 + 0.58 A

Sources: C. Yang, B. N. J. Persson, J. Phys.: Condens. Matter 20 (2008) 215214; A. Almqvist, C. Campana, N. Prodanov,
B. N. J. Persson, J. Mech. Phys. Solids 59 (2011) 2355; A. Wang, M. H. Mueser, Tribol. Lett. 65 (2017) 103; all three
functions as in the code of Y. Xu and others (github.com/xylcsi/PerssonModelFudgeFactor). That the stress both
diffuses more slowly and drifts at small stress: W. B. Dapp, N. Prodanov, M. H. Mueser, J. Phys.: Condens. Matter 26
(2014) 355002. That the area falls with the breadth of the spectrum: V. A. Yastrebov, G. Anciaux, J.-F. Molinari, J.
Mech. Phys. Solids 107 (2017) 469, arXiv:1704.05650. The linear drift, the breadth and the window are derived or
guessed here, and calibrated. Dimensionless, stresses in units of E*. Limits: published coefficients are
for isotropic roughness.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.special import erf

from persson.magnification import MagnificationMesh
from persson.mathematics.arrays import FloatArray

Form = Literal["slower", "total", "drift"]
FORMS: tuple[Form, ...] = ("slower", "total", "drift")
ROUNDING = 1e-12
BISECTIONS = 60
FULL = 1e-9  # of 1 - A: nearer to full contact the window is 1 to rounding for any k of order one


@dataclass(frozen=True, eq=False)
class Scales:
    """What the factor asks of the roughness in the middle of each cell of a mesh, (n,) arrays.

    Attributes
    ----------
    ratio : n = q / q_1.
    breadth : b = ln q - <ln q>, >= 0.
    """

    ratio: FloatArray
    breadth: FloatArray

    def of(self, cell: int) -> Scales:
        """Those of one cell."""
        return Scales(self.ratio[cell], self.breadth[cell])


def scales_of(mesh: MagnificationMesh) -> Scales:
    """Wavenumber over the first, and breadth of what is resolved, in the middle of each cell.

    Examples
    --------
    >>> from persson.magnification import magnification_mesh
    >>> from persson.spectrum import DiscreteSpectrum
    >>> one = scales_of(magnification_mesh(DiscreteSpectrum([2.0], [0.1]), 1e-4, 1.5))
    >>> bool(np.all(one.ratio == 1)), bool(np.allclose(one.breadth, 0, atol=1e-12))
    (True, True)
    """
    logarithm = np.log(mesh.inside / mesh.inside[0])
    width = np.diff(mesh.slope_variance)
    below = np.concatenate([[0.0], np.cumsum(width * logarithm)[:-1]])
    middle = (mesh.slope_variance[1:] + mesh.slope_variance[:-1]) / 2
    mean = (below + width / 2 * logarithm) / middle
    return Scales(np.exp(logarithm), np.maximum(logarithm - mean, 0.0))


@dataclass(frozen=True)
class Correction:
    """One energy factor and how the stress obeys it.

    Parameters
    ----------
    name : str
    form : "slower", "total" or "drift"
    coefficients : tuple of float
        c_k, with the sum 1.
    breadth : float, optional
        b_0 >= 0; None: S does not ask for the breadth.
    window : float, optional
        k > 0; None: no window.
    detached_width : float
        With adhesion: width of the detached zones in wavelengths, in (0, 1]; 1 in the plain theory.
    edges : bool
        Area by contact_slope.py, and with adhesion by adhesive_edges.py in place of the fixed point of the theory.
    source, range : str
        Where it comes from and for what it was found.

    Raises
    ------
    ValueError
        Unknown form, S(1) not 1, S not positive, or a parameter out of range.
    """

    name: str
    form: Form
    coefficients: tuple[float, ...]
    breadth: float | None = None
    window: float | None = None
    detached_width: float = 1.0
    edges: bool = False
    source: str = ""
    range: str = ""

    def __post_init__(self) -> None:
        if self.form not in FORMS:
            raise ValueError(f"form: {self.form!r} must be one of {', '.join(FORMS)}")
        if not abs(sum(self.coefficients) - 1) < ROUNDING:
            raise ValueError(f"coefficients: {self.coefficients} must sum to 1, full contact is exact")
        if not np.all(np.polynomial.polynomial.polyval(np.linspace(0, 1, 101), np.array(self.coefficients)) > 0):
            raise ValueError(f"coefficients: {self.coefficients} make S(A) <= 0 for some A in [0, 1]")
        if self.breadth is not None and not (self.breadth >= 0 and self.coefficients[0] < 1):
            raise ValueError(f"breadth: {self.breadth} must be >= 0, and coefficients[0] < 1")
        if self.window is not None and not self.window > 0:
            raise ValueError(f"window: {self.window} must be > 0")
        if self.form == "total" and (self.breadth is not None or self.window is not None):
            raise ValueError("form: 'total' has neither breadth nor window, which change from line to line")
        if not 0 < self.detached_width <= 1:
            raise ValueError(f"detached_width: {self.detached_width} must lie in (0, 1] (wavelengths)")

    def factor(self, area: FloatArray, scales: Scales | None = None) -> FloatArray:
        """S, of the shape that the contact fraction A and the scales (of cells, or one cell) broadcast to.

        Examples
        --------
        >>> LITERATURE["yang_persson_2008"].factor(np.array([0.0, 1.0]))
        array([0.45, 1.  ])
        """
        value = np.asarray(np.polynomial.polynomial.polyval(area, np.array(self.coefficients)))
        if scales is None:
            return value
        if self.breadth is not None:
            first = self.coefficients[0]
            lowered = first * scales.breadth / (scales.breadth + self.breadth)
            value = lowered + (1 - lowered) * (value - first) / (1 - first)
        if self.window is not None:
            value = value * -np.expm1(-self.window * scales.ratio * area / np.maximum(1 - area, FULL))
        return np.asarray(value)

    def variance(self, variance: FloatArray, area: FloatArray, scales: Scales) -> FloatArray:
        """tau at the nodes, for given contact fractions.

        Parameters
        ----------
        variance : (n + 1,) array
            V from 0.
        area : (.., n + 1) array
            A/A0 there.
        scales : Scales
            Of the cells.

        Returns
        -------
        (.., n + 1) array
            Of the forms `slower`, midpoint rule in the cells, and `total`; V itself for `drift`.
        """
        if self.form == "drift":
            return np.asarray(np.broadcast_to(variance, area.shape))
        if self.form == "total":
            return np.asarray(self.factor(area) * variance)
        steps = self.factor(_middle(area), scales) * np.diff(variance)
        return np.concatenate([np.zeros_like(area[..., :1]), np.cumsum(steps, axis=-1)], axis=-1)

    def stored(self, variance: FloatArray, area: FloatArray, scales: Scales) -> FloatArray:
        """Mean over each cell of A S, the growth of <sigma^2> with V, (.., n)."""
        if self.form == "total":
            return np.asarray(_middle(area) * np.diff(self.factor(area) * variance, axis=-1) / np.diff(variance))
        return np.asarray(_middle(area) * self.factor(_middle(area), scales))


def diffused(correction: Correction, mesh: MagnificationMesh, loads: FloatArray) -> FloatArray:
    """tau at the nodes without adhesion, where A = erf(sigma_0 / sqrt(2 tau)).

    Parameters
    ----------
    correction : Correction
        Of the form `slower` (Runge-Kutta of second order from cell to cell) or `total` (bisection at each node).
    mesh : MagnificationMesh
        Whose first node after zero is one that no load feels.
    loads : (n_loads,) array
        sigma_0 / E* > 0.

    Returns
    -------
    (n_loads, n + 1) array
    """
    variance = mesh.stress_variance
    if correction.form == "total":
        return _bisected(correction, variance, loads[:, None])
    if correction.form == "drift":
        raise ValueError("form: 'drift' has no time of its own; it is marched (diffusion.py)")
    scales, steps = scales_of(mesh), np.diff(variance)
    tau = np.zeros((variance.size, loads.size))
    tau[1] = variance[1]
    for cell in range(1, steps.size):
        here = scales.of(cell)
        half = tau[cell] + steps[cell] / 2 * correction.factor(area_at(loads, tau[cell]), here)
        tau[cell + 1] = tau[cell] + steps[cell] * correction.factor(area_at(loads, half), here)
    return np.asarray(tau.T)


def area_at(load: FloatArray, tau: FloatArray) -> FloatArray:
    """erf(sigma_0 / sqrt(2 tau)); 1 at tau = 0."""
    with np.errstate(divide="ignore"):
        return np.asarray(erf(load / np.sqrt(2 * tau)))


def _bisected(correction: Correction, variance: FloatArray, load: FloatArray) -> FloatArray:
    """tau = V S(A(tau)): the side with tau / S < V is kept below."""
    largest = float(np.max(correction.factor(np.linspace(0, 1, 201))))
    low = np.zeros(np.broadcast_shapes(variance.shape, load.shape))
    high = np.broadcast_to(variance * largest, low.shape)
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        above = middle > variance * correction.factor(area_at(load, middle))
        low, high = np.where(above, low, middle), np.where(above, middle, high)
    return np.asarray((low + high) / 2)


def _middle(values: FloatArray) -> FloatArray:
    return np.asarray((values[..., 1:] + values[..., :-1]) / 2)


ISOTROPIC = "isotropic self-affine roughness"

LITERATURE: dict[str, Correction] = {
    "yang_persson_2008": Correction(
        "yang_persson_2008",
        "slower",
        (0.45, 0.0, 0.55),
        source="C. Yang, B. N. J. Persson, J. Phys.: Condens. Matter 20 (2008) 215214",
        range=f"{ISOTROPIC}, energy and separation without adhesion; 0.4 to 0.5 in place of 0.45",
    ),
    "wang_muser_2017": Correction(
        "wang_muser_2017",
        "slower",
        (5 / 9, 0.0, -2 / 9, 0.0, 2 / 3),
        source="A. Wang, M. H. Mueser, Tribol. Lett. 65 (2017) 103",
        range=f"{ISOTROPIC}, without and with short-ranged adhesion",
    ),
    "xu_2024": Correction(
        "xu_2024",
        "total",
        (0.42, 0.58),
        source="Y. Xu and others, github.com/xylcsi/PerssonModelFudgeFactor (2024)",
        range=f"{ISOTROPIC}, without adhesion",
    ),
    "linear_drift": Correction(
        "linear_drift",
        "drift",
        (0.45, 0.0, 0.55),
        source="factor of C. Yang, B. N. J. Persson (2008) with the linear drift that keeps the load, derived here",
        range=f"{ISOTROPIC}",
    ),
}
