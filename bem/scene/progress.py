"""Progress of a solution, reported after every accepted increment."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Progress:
    """Progress of a solution; pressure in Pa, `target_index` counts from 0, `value` is the value of the control."""

    mean_pressure: float
    contact_fraction: float
    n_patches: int
    increments_accepted: int
    increments_rejected: int
    evaluations: int
    target_index: int
    n_targets: int
    value: float = math.nan
