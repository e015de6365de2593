"""Windows: many patches, cut into few that are followed alone in the far field of all others.

An event moves edges four patches away by 7e-5 of their edge scale (median of 186 jumps; of one in a hundred more than
8e-4).  A window is a core of some 24 patches and a buffer of two to five on either side, its ends in the widest of the
gaps there.  A joined state takes from a window only its core: cores are parted at seams, in gaps that both windows
have.  Dimensionless.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bem.elastic.far_field import Arc
from bem.geometry.arrays import FloatArray, IntArray
from bem.geometry.patches import TWO_PI, Patches

CORE_PATCHES = 24  # speed: patches in the core of a window, more or less
BUFFER = 2  # least number of patches beside the core
CHOICE = 2 * BUFFER  # gaps, of which the widest is where a window ends, or a core


@dataclass(frozen=True, eq=False)
class Window:
    """Consecutive patches that are followed alone.

    Attributes
    ----------
    arc : Arc
    members : (n,) int array
        Indices of the patches, ascending.
    seam : float
        Position in a gap at which the core begins.
    """

    arc: Arc
    members: IntArray
    seam: float

    def of(self, patches: Patches) -> Patches:
        """Return the patches of the window."""
        return Patches(patches.left[self.members], patches.right[self.members])


def windows_of(patches: Patches) -> list[Window]:
    """Cut all patches into windows; every patch is in one core.

    Raises
    ------
    ValueError
        There are so few patches that a window leaves none outside.
    """
    candidates = [_window(patches, start, size, BUFFER) for start, size in _cores(patches)]
    windows = [window for window in candidates if window is not None]
    if len(windows) < len(candidates):
        raise ValueError(f"{patches.count} patches are too few for windows")
    return windows


def wider(patches: Patches, index: int, more: int) -> Window | None:
    """Return a window with its buffers wider by some patches; None where no patch is left outside."""
    return _window(patches, *_cores(patches)[index], BUFFER + more)


def _cores(patches: Patches) -> list[tuple[int, int]]:
    """Return the first patch and the number of patches of each core, of at least two.

    A core begins behind the widest of the gaps about every `CORE_PATCHES` patches.
    """
    count, gap = patches.count, patches.gap_before
    wanted = np.linspace(0, count, max(2, round(count / CORE_PATCHES)), endpoint=False)
    near = np.arange(-CHOICE, CHOICE + 1)
    starts = sorted({int(max((round(k) + near) % count, key=lambda i: gap[i])) for k in wanted.tolist()})
    sizes = np.diff(starts, append=starts[0] + count)
    return list(zip(starts, sizes.tolist(), strict=True))


def _window(patches: Patches, start: int, size: int, buffer: int) -> Window | None:
    """Return the window whose core has `size` patches from `start` on; None where no patch is left outside."""
    count, gap = patches.count, patches.gap_after
    choice = range(buffer, buffer + CHOICE)
    before = max(choice, key=lambda k: gap[(start - k - 1) % count])
    behind = max(choice, key=lambda k: gap[(start + size + k - 1) % count])
    if size + before + behind >= count:
        return None
    row = np.arange(start - before, start + size + behind) % count
    first, last = int(row[0]), int(row[-1])
    margins = float(gap[first - 1] / 2), float(gap[last] / 2)
    beta = float(patches.left[first]) - margins[0]
    delta = beta + (float(patches.right[last]) + margins[1] - beta) % TWO_PI
    return Window(Arc(beta, delta, margins), np.sort(row), float(patches.left[start] - gap[start - 1] / 2))


def seams(windows: Sequence[Window], window_patches: Sequence[Patches]) -> list[float] | None:
    """Return the start of each core after its patches have changed, in a gap of both windows; None without one."""
    places = []
    for k, (window, patches) in enumerate(zip(windows, window_patches, strict=True)):
        before, arc = window_patches[k - 1], windows[k - 1].arc
        ends, last = before.right + before.gap_after, arc.outer_gap(before)
        starts = before.right.copy()
        free = min((arc.delta - before.right[last]) % TWO_PI, (arc.delta - window.arc.beta) % TWO_PI)
        starts[last], ends[last] = arc.delta - free, arc.delta  # the part of the outer gap that lies in both windows
        middle = (starts + ends) / 2
        inside = (middle[:, None] - patches.left) % TWO_PI <= patches.width
        shared = middle[window.arc.holds(middle) & ~inside.any(axis=1)]
        if not shared.size:
            return None
        off = np.abs((shared - window.seam + np.pi) % TWO_PI - np.pi)
        places.append(float(shared[np.argmin(off)]))
    return places


def in_core(place: FloatArray, seam: float, following: float) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """Return whether places lie between two seams, (n,)."""
    return np.asarray((place - seam) % TWO_PI < (following - seam) % TWO_PI)
