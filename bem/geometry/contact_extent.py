"""How far adhesion lets contacts spread, before anything is solved: what the predicted cost counts.

*Waves that adhesion closes.*  In full contact with a wave of wave number q and height h the energy E* q h^2 / 8 per
length is stored (Persson, Tosatti, J. Chem. Phys. 115 (2001) 5597).  The shortest waves, of which all together store
less than a part `CLOSED` of the work of adhesion, part no contacts: the edges run over them.

*Travel.*  Contacts are where the profile without those waves is above a plane; to an area A of n contacts every edge
has gone A / (2 n) periods, and over as many crests of the shortest wave that pins it: of the waves from there on the
root of sum E* q^3 h^2 / w, times the edge scale, is `PINS` (bem/adhesive/pinning.py says why).  Steps of the path are
parts of that wave, and edges may snap from one to the next.

*Pull.*  On a wave of the same rms height and slope, adhesion acts on the area like a pressure alpha sqrt(tan psi) more
(Johnson, Int. J. Solids Struct. 32 (1995) 423), where sin^2 psi is the pressure over that of full contact and the area
2 psi / pi.  On roughness of many lengths it is less, a part `PULL` of it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bem.geometry.arrays import FloatArray, IntArray
from bem.geometry.profile import Profile

CLOSED, PULL, PINS = (
    0.3,
    0.25,
    0.03,
)  # prediction: above; PULL .25 of four strong scenes: 1 is 9 times too much, 0 a fifth
POINTS, ANGLES = 16, 1000  # prediction: of the shortest wave kept; psi is looked for among so many


@dataclass(frozen=True, eq=False)
class ContactExtent:
    """What adhesion makes of the contacts of a surface.

    Parameters
    ----------
    surface : Profile
        SI, not flat.
    modulus, work : float
        E*, Pa, and the work of adhesion, J/m^2.
    """

    surface: Profile
    modulus: float
    work: float

    @cached_property
    def _waves(self) -> tuple[IntArray, FloatArray, FloatArray]:
        """Order, height and phase of every wave, longest first."""
        order = np.argsort(self.surface.orders)
        return self.surface.orders[order], self.surface.amplitudes[order], self.surface.phases[order]

    @cached_property
    def smooth(self) -> tuple[IntArray, FloatArray, FloatArray]:
        """The same of those that adhesion does not close, and of the longest one."""
        waves, heights, phases = self._waves
        stored = self.modulus / 8 * self.surface.q0 * np.cumsum((waves * heights**2)[::-1])[::-1]
        kept = max(1, int(np.count_nonzero(stored > CLOSED * self.work)))
        return waves[:kept], heights[:kept], phases[:kept]

    @cached_property
    def heights(self) -> FloatArray:
        """Heights of these waves at equal distances, (n,), m."""
        waves, heights, phases = self.smooth
        count = 1 << math.ceil(math.log2(POINTS * int(waves[-1])))
        spectrum = np.zeros(count // 2 + 1, dtype=np.complex128)
        spectrum[waves] = heights * np.exp(1j * phases) * (count / 2)
        return np.fft.irfft(spectrum, count)

    def crests_above(self, plane: float) -> int:
        """How many of their crests are above a plane."""
        here = self.heights
        top = (here > np.roll(here, 1)) & (here >= np.roll(here, -1))
        return int(np.count_nonzero(top & (here > plane)))

    def waves_passed(self, plane: float) -> float:
        """Waves that pin it, over which an edge has gone when the surfaces are pressed to a separation."""
        above = self.heights > plane
        contacts = max(1, int(np.count_nonzero(above & ~np.roll(above, 1))))
        area = float(np.mean(above))
        scale = self.surface.period * min(area, 1 - area) / contacts
        waves, heights, _ = self._waves
        tails = np.cumsum(((self.surface.q0 * waves) ** 3 * heights**2)[::-1])[::-1]
        pinning = int(np.count_nonzero(scale * np.sqrt(tails * self.modulus / self.work) > PINS))
        return area / (2 * contacts) * int(waves[pinning - 1]) if pinning else 0.0

    def pulled(self, pressure: float) -> float:
        """The pressure, Pa, at which without adhesion the area would be about that at this one; inf in full contact."""
        waves, heights, _ = self.smooth
        height = float(np.linalg.norm(heights)) / math.sqrt(2)
        slope = self.surface.q0 * float(np.linalg.norm(waves * heights)) / math.sqrt(2)
        full = self.modulus * slope / math.sqrt(2)
        alpha = math.sqrt(self.modulus * self.work * slope / (math.pi * height)) / full
        psi = np.linspace(0, math.pi / 2, ANGLES + 1)[1:-1]
        held = np.sin(psi) ** 2 - alpha * np.sqrt(np.tan(psi))
        top = int(np.argmax(held))
        if held[top] < pressure / full:
            return math.inf
        rising = held[: top + 1]
        at = int(np.argmin(rising)) + int(np.argmax(rising[np.argmin(rising) :] >= pressure / full))
        return pressure + PULL * (full * float(np.sin(psi[at]) ** 2) - pressure)
