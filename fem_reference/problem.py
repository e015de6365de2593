"""The contact problem as its raw data, checked, and the dimensionless form the finite elements see.

A linear elastic layer in plane strain, 0 < y < d, period lambda in x. Its upper face y = d is bonded to a rigid plate,
its lower face y = 0 is pressed, without friction, on the rigid profile

    h(x) = sum_m h_m cos(2 pi m x / lambda + phi_m).

The frame is the plate's: the lower face moves by u_y = h - h_max + u_tot in contact, u_tot being the displacement of
the plate from first touch of the undeformed layer. Pressure is positive in compression.

Units inside the package: lengths along the layer in periods (lambda), heights and displacements in the rms height a
of the profile (a = lambda when the profile is flat), moduli in E. Hence stress in E a / lambda, load per period in E
a, energy per period in E a^2, energy release rate in E a^2 / lambda, stress intensity in E a / sqrt(lambda).
`Problem` does the conversion both ways through its `unit_...` properties.

Elastic constants of plane strain (Timoshenko and Goodier, Theory of Elasticity, 3rd ed., art. 17), each in units of
E: shear modulus 1/(2(1+nu)), inverse bulk modulus 3(1-2nu), E* = 1/(1-nu^2), and the uniform compliance of the bonded
layer c(0) = d (1-2nu)(1+nu)/(1-nu). Limits: small strains, -1 < nu <= 1/2.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]


class InvalidProblemError(ValueError):
    """Input that cannot be solved, named by the argument at fault.

    Parameters
    ----------
    argument : str
        Name of the argument of `fem_reference.solve` (or of the function that raised).
    reason : str
        What is wrong with it.
    """

    def __init__(self, argument: str, reason: str) -> None:
        super().__init__(f"{argument}: {reason}")
        self.argument = argument


def _finite_number(argument: str, value: float) -> float:
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise InvalidProblemError(argument, f"must be a number, got {value!r}") from None
    if not np.isfinite(number):
        raise InvalidProblemError(argument, f"must be finite, got {value!r}")
    return number


@dataclass(frozen=True)
class Problem:
    """Layer, profile and work of adhesion in SI units.

    Parameters
    ----------
    youngs_modulus : float
        E in Pa, > 0.
    poisson_ratio : float
        nu in (-1, 0.5].
    thickness : float
        Layer thickness d in m, > 0.
    period : float
        lambda in m, > 0.
    orders, amplitudes, phases : array_like, shape (n_harmonics,)
        Orders (distinct integers >= 1), amplitudes in m, phases in rad. Empty or all-zero amplitudes: a flat profile.
    work_of_adhesion : float
        gamma in J/m^2, >= 0.
    slope_term : bool
        Whether an edge pays gamma sqrt(1 + h'^2) (true) or gamma (false) per unit projected length.

    Raises
    ------
    InvalidProblemError
        Naming the first argument out of range.

    Examples
    --------
    >>> layer = Problem(1e6, 0.5, 0.02, 0.01, [1], [50e-6], [0.0], 0.03, False)
    >>> round(float(layer.height(0.0)), 6), layer.unit_length
    (1.414214, 0.01)
    """

    youngs_modulus: float
    poisson_ratio: float
    thickness: float
    period: float
    orders: ArrayLike
    amplitudes: ArrayLike
    phases: ArrayLike
    work_of_adhesion: float = 0.0
    slope_term: bool = False

    def __post_init__(self) -> None:
        for name in ("youngs_modulus", "thickness", "period"):
            number = _finite_number(name, getattr(self, name))
            if number <= 0.0:
                raise InvalidProblemError(name, f"must be positive, got {number!r}")
            object.__setattr__(self, name, number)
        ratio = _finite_number("poisson_ratio", self.poisson_ratio)
        if not -1.0 < ratio <= 0.5:
            raise InvalidProblemError("poisson_ratio", f"must lie in (-1, 0.5], got {ratio!r}")
        object.__setattr__(self, "poisson_ratio", ratio)
        adhesion = _finite_number("work_of_adhesion", self.work_of_adhesion)
        if adhesion < 0.0:
            raise InvalidProblemError("work_of_adhesion", f"must not be negative, got {adhesion!r}")
        object.__setattr__(self, "work_of_adhesion", adhesion)
        self._check_harmonics()

    def _check_harmonics(self) -> None:
        orders, amplitudes, phases = (
            np.atleast_1d(np.asarray(series, dtype=float)) for series in (self.orders, self.amplitudes, self.phases)
        )
        if orders.ndim != 1 or orders.shape != amplitudes.shape or orders.shape != phases.shape:
            raise InvalidProblemError(
                "harmonics", "orders, amplitudes and phases must be three sequences of equal length"
            )
        if not all(np.all(np.isfinite(series)) for series in (orders, amplitudes, phases)):
            raise InvalidProblemError("harmonics", "must be finite")
        if np.any(orders < 1) or np.any(orders != np.round(orders)) or len(np.unique(orders)) != len(orders):
            raise InvalidProblemError("harmonics", "orders must be distinct integers >= 1")
        object.__setattr__(self, "orders", orders.astype(np.int64))
        object.__setattr__(self, "amplitudes", amplitudes)
        object.__setattr__(self, "phases", phases)

    # The dimensionless problem

    @cached_property
    def unit_length(self) -> float:
        """Unit of lengths along the layer, m."""
        return self.period

    @cached_property
    def unit_height(self) -> float:
        """Unit of heights and displacements, m: the rms height, or the period of a flat profile."""
        rms = float(np.sqrt(np.sum(np.asarray(self.amplitudes) ** 2) / 2.0))
        return rms if rms > 0.0 else self.period

    @property
    def unit_stress(self) -> float:
        """Unit of stress, Pa."""
        return self.youngs_modulus * self.unit_height / self.period

    @property
    def unit_load(self) -> float:
        """Unit of load per period, N/m."""
        return self.youngs_modulus * self.unit_height

    @property
    def unit_energy(self) -> float:
        """Unit of energy per period, J/m."""
        return self.youngs_modulus * self.unit_height**2

    @property
    def unit_release_rate(self) -> float:
        """Unit of energy release rate, J/m^2."""
        return self.youngs_modulus * self.unit_height**2 / self.period

    @property
    def unit_stress_intensity(self) -> float:
        """Unit of stress intensity, Pa sqrt(m)."""
        return float(self.youngs_modulus * self.unit_height / np.sqrt(self.period))

    @property
    def depth(self) -> float:
        """Thickness in periods."""
        return self.thickness / self.period

    @property
    def shear_modulus(self) -> float:
        """Shear modulus in units of E."""
        return 1.0 / (2.0 * (1.0 + self.poisson_ratio))

    @property
    def inverse_bulk_modulus(self) -> float:
        """Inverse bulk modulus in units of 1/E; zero for an incompressible layer."""
        return 3.0 * (1.0 - 2.0 * self.poisson_ratio)

    @property
    def plane_strain_modulus(self) -> float:
        """E*/E = 1/(1 - nu^2)."""
        return 1.0 / (1.0 - self.poisson_ratio**2)

    @property
    def uniform_compliance(self) -> float:
        """c(0) E / lambda: mean displacement of the face per mean pressure."""
        nu = self.poisson_ratio
        return self.depth * (1.0 - 2.0 * nu) * (1.0 + nu) / (1.0 - nu)

    @property
    def highest_order(self) -> int:
        """Highest harmonic of the profile (1 for a flat one)."""
        active = np.asarray(self.orders)[np.asarray(self.amplitudes) != 0.0]
        return int(active.max()) if active.size else 1

    def _series(self, x: ArrayLike, derivative: int) -> FloatArray:
        position = np.asarray(x, dtype=float)
        wavenumber = 2.0 * np.pi * np.asarray(self.orders)
        phase = np.multiply.outer(position, wavenumber) + np.asarray(self.phases) + derivative * np.pi / 2.0
        amplitude = np.asarray(self.amplitudes) / self.unit_height * wavenumber**derivative
        result: FloatArray = np.cos(phase) @ amplitude
        return result

    def height(self, x: ArrayLike) -> FloatArray:
        """Return the profile height h/a at positions x/lambda of any shape."""
        return self._series(x, 0)

    def slope(self, x: ArrayLike) -> FloatArray:
        """Return d(h/a)/d(x/lambda) at positions x/lambda; times a/lambda it is the true slope."""
        return self._series(x, 1)

    def curvature(self, x: ArrayLike) -> FloatArray:
        """Return d^2(h/a)/d(x/lambda)^2 at positions x/lambda."""
        return self._series(x, 2)

    @cached_property
    def crests(self) -> FloatArray:
        """Positions (n_crests,) of the local maxima of h in [0, 1), highest first; empty for a flat profile."""
        n = 64 * self.highest_order
        grid = np.arange(n + 1) / n + 0.5 / n / np.pi
        slope = self.slope(grid)
        falling = np.flatnonzero((slope[:-1] > 0.0) & (slope[1:] <= 0.0))
        found = np.array([brentq(self.slope, grid[i], grid[i + 1], xtol=1e-15) for i in falling], dtype=float)
        order = np.argsort(-self.height(found), kind="stable") if found.size else np.zeros(0, dtype=int)
        return np.asarray(found[order] % 1.0)

    @cached_property
    def highest(self) -> float:
        """h_max/a."""
        return float(self.height(self.crests[0])) if self.crests.size else 0.0

    def critical_stress_intensity(self, x: ArrayLike) -> FloatArray:
        """Return sqrt(2 E* gamma sqrt(1 + h'^2)) (or without the root) at positions x/lambda, in E a / sqrt(lambda)."""
        return np.sqrt(2.0 * self.plane_strain_modulus * self.work_of_opening(x))

    def work_of_opening(self, x: ArrayLike) -> FloatArray:
        """Return gamma sqrt(1 + h'^2), or gamma without the slope term, at positions x/lambda, in E a^2 / lambda."""
        true_slope = self.slope(x) * self.unit_height / self.period if self.slope_term else np.zeros(np.shape(x))
        return self.work_of_adhesion / self.unit_release_rate * np.sqrt(1.0 + true_slope**2)
