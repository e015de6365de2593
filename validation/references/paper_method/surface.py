"""Solid and profile of a contact: raw SI data, and their dimensionless form.

With q0 = 2 pi / period and a = rms height: positions in 1/q0, heights in a, stress in E* q0 a / 2, energy in
E* a^2 / 2 (per period and unit length in the third direction), so that a half-space moves by

    u(x) - u_m = -(1/pi) int log|2 sin((x - x')/2)| sigma(x') dx',

mode m by u_m = sigma_m / m.  A bonded layer multiplies mode m by ratio(m q0 d), the bracket of equation (2) of
Carbone, Mangialardi, J. Mech. Phys. Solids 56 (2008) 684:

    ratio = [(3-4nu) sinh 2k - 2k] / [(3-4nu) cosh 2k + 2k^2 + 5 - 12 nu + 8 nu^2],   k = m q0 d.

Heights are sums of cosines, term by term.  Limits: small slopes in the elasticity, any in the adhesive area.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import minimize_scalar

from validation.harness.arrays import FloatArray

SAMPLES = 12  # points per shortest wavelength among which the highest crest is looked for
NEARLY = 0.1  # of the total height below the highest sample: other samples that may be beside the highest crest
NEGLIGIBLE = 1e-15  # |ratio - 1| / m beyond which modes of the layer are those of the half-space


@dataclass(frozen=True)
class Surface:
    """A rigid periodic profile, an elastic solid, and the work of adhesion between them, SI.

    Parameters
    ----------
    youngs_modulus, poisson_ratio : float
        Pa; dimensionless.
    period : float
        m.
    orders, amplitudes, phases : array_like, (n_harmonics,)
        h = sum amplitude cos(order q0 x + phase), m and rad.
    work_of_adhesion : float
        J/m^2, >= 0.
    slope_term : bool
        Whether an edge pays gamma sqrt(1 + h'^2).
    thickness : float or None
        Of the bonded layer, m; None for a half-space.

    Raises
    ------
    ValueError
        Period, modulus or rms height not positive, work of adhesion negative.

    Examples
    --------
    >>> wave = Surface(1e6, 0.5, 0.01, [1], [1e-4], [0.0])
    >>> round(wave.highest, 12), float(wave.height(np.pi).round(12))
    (1.414213562373, -1.414213562373)
    """

    youngs_modulus: float
    poisson_ratio: float
    period: float
    orders: ArrayLike
    amplitudes: ArrayLike
    phases: ArrayLike
    work_of_adhesion: float = 0.0
    slope_term: bool = False
    thickness: float | None = None

    def __post_init__(self) -> None:
        if not (self.youngs_modulus > 0 and self.period > 0 and self.unit_height > 0 and self.work_of_adhesion >= 0):
            raise ValueError("youngs_modulus, period and amplitudes must be positive, work_of_adhesion not negative")

    @cached_property
    def order(self) -> FloatArray:
        """Orders as numbers, (n_harmonics,)."""
        return np.asarray(self.orders, dtype=np.float64)

    @cached_property
    def unit_height(self) -> float:
        """The rms height a, m."""
        return float(np.sqrt(np.sum(np.asarray(self.amplitudes, dtype=np.float64) ** 2) / 2))

    @property
    def modulus(self) -> float:
        """E* = E / (1 - nu^2), Pa."""
        return self.youngs_modulus / (1 - self.poisson_ratio**2)

    @property
    def unit_length(self) -> float:
        """1 / q0, m."""
        return self.period / (2 * np.pi)

    @property
    def unit_pressure(self) -> float:
        """E* q0 a / 2, Pa."""
        return self.modulus * self.unit_height / self.unit_length / 2

    @property
    def unit_energy(self) -> float:
        """E* a^2 / 2, J/m."""
        return self.modulus * self.unit_height**2 / 2

    @property
    def work(self) -> float:
        """gamma q0^-1 over the unit of energy: work of adhesion per dimensionless length."""
        return self.work_of_adhesion * self.unit_length / self.unit_energy

    @property
    def slope_scale(self) -> float:
        """q0 a: true slope per dimensionless slope."""
        return self.unit_height / self.unit_length

    def height(self, x: ArrayLike) -> FloatArray:
        """Return h at dimensionless positions of any shape."""
        return self._sum(x, 0)

    def slope(self, x: ArrayLike) -> FloatArray:
        """Return h' at dimensionless positions of any shape."""
        return self._sum(x, 1)

    @cached_property
    def crest(self) -> tuple[float, float]:
        """Position in [0, 2 pi) and height of the highest crest."""
        count = int(SAMPLES * self.order.max())
        step = 2 * np.pi / count
        grid = np.arange(count) * step
        heights = self.height(grid)
        tops = (heights >= np.roll(heights, 1)) & (heights >= np.roll(heights, -1))
        candidates = grid[tops & (heights > heights.max() - NEARLY * (heights.max() - heights.min()))]
        best = [
            minimize_scalar(
                lambda x: -float(self.height(x)), bounds=(x - step, x + step), method="bounded", options={"xatol": 1e-9}
            )
            for x in candidates
        ]
        highest = min(best, key=lambda minimum: float(minimum.fun))
        return float(highest.x) % (2 * np.pi), -float(highest.fun)

    @property
    def highest(self) -> float:
        """Height of the highest crest."""
        return self.crest[1]

    def adhesive_length(self, x: ArrayLike) -> FloatArray:
        """Return sqrt(1 + h'^2) where the slope term is on, else 1, at positions of any shape."""
        position = np.asarray(x, dtype=np.float64)
        if not self.slope_term:
            return np.ones(position.shape)
        return np.asarray(np.sqrt(1 + (self.slope_scale * self.slope(position)) ** 2))

    @cached_property
    def layer_modes(self) -> FloatArray:
        """(ratio - 1) / m for m = 1, 2, ... as long as it counts; empty for a half-space."""
        if self.thickness is None:
            return np.zeros(0)
        nu, depth = self.poisson_ratio, self.thickness / self.unit_length
        m = np.arange(1, 40 + int(np.ceil(20 / depth)))
        k = m * depth
        decay = np.exp(-2 * k)  # numerator and denominator over cosh 2k, which overflows
        cosh = (1 + decay**2) / 2
        ratio = ((3 - 4 * nu) * (1 - decay**2) / 2 - 2 * k * decay) / (
            (3 - 4 * nu) * cosh + (2 * k**2 + 5 - 12 * nu + 8 * nu**2) * decay
        )
        modes = (ratio - 1) / m
        return np.asarray(modes[: int(np.max(np.flatnonzero(np.abs(modes) > NEGLIGIBLE), initial=-1)) + 1])

    def _sum(self, x: ArrayLike, derivative: int) -> FloatArray:
        position = np.asarray(x, dtype=np.float64)
        factor = np.asarray(self.amplitudes, dtype=np.float64) / self.unit_height * self.order**derivative
        angle = position[..., None] * self.order + np.asarray(self.phases) + derivative * np.pi / 2
        return np.asarray(np.cos(angle) @ factor)
