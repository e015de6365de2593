"""Ra, Rq and Rz of a periodic profile, as ISO 4287 and ISO 21920-2 define them.

Ra and Rq are the mean of |h| and the root mean square of h about the mean line; Rz is the mean over `SECTIONS` sections
of equal length of the highest peak less the deepest valley in each.  The sections are fifths of the line itself, not
of a sampling length lambda_c; of a mirrored line, of the half that was measured.  Heights are those of the harmonics,
at `POINTS` points or more for the shortest wave: of a wave, the peak is missed by at most 1 - cos(pi / 8) = 8 %.
"""

from __future__ import annotations

import numpy as np

from bem.geometry.arrays import FloatArray

SECTIONS = 5  # derived: of the line, for Rz: as the standard has it
POINTS = 8  # format: for the shortest wave, whose peak is then missed by 8 % at most


def height_parameters(h: FloatArray, harmonics: int, halves: int = 1) -> dict[str, float]:
    """Return Ra, Rq and Rz in the unit of the heights.

    Parameters
    ----------
    h : (n,) array
        Uniform samples of a period.
    harmonics : int
        Highest order kept, below n / 2.
    halves : {1, 2}
        2 for a line followed by itself in reverse.

    Examples
    --------
    >>> wave = np.cos(2 * np.pi * 5 * np.arange(1000) / 1000)
    >>> {name: round(value, 3) for name, value in height_parameters(wave, 20).items()}
    {'Ra': 0.637, 'Rq': 0.707, 'Rz': 2.0}
    """
    points = 2 * SECTIONS * -(-max(POINTS * harmonics, h.size) // (2 * SECTIONS))
    modes = np.fft.rfft(h)[: harmonics + 1]
    modes[0] = 0.0
    heights = np.fft.irfft(modes, points) * (points / h.size)
    sections = heights[: points // halves].reshape(SECTIONS, -1)
    return {
        "Ra": float(np.mean(np.abs(heights))),
        "Rq": float(np.sqrt(np.mean(heights**2))),
        "Rz": float(np.mean(np.ptp(sections, axis=1))),
    }
