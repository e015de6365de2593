"""The maps of maps.py on coarser axes: every map in a quarter of an hour instead of a night.

Hurst exponents 0.3 to 0.9 in four steps, 10 to 300 harmonics, adhesion from none to sticky, layers from a hundredth of
the period; 60 harmonics where the bandwidth does not vary, four realisations a point.  Read as the full study.
"""

from __future__ import annotations

from pathlib import Path

from validation.harness.executors import Opener, local_processes
from validation.harness.runner import Listener
from validation.studies.maps import COARSE_AXES, TINY_AXES, run_over


def run(folder: Path, quick: bool, report: Listener, jobs: int = 1, opener: Opener = local_processes) -> int:
    """Run the study over the coarse axes, or over the tiny ones; as `maps.run`."""
    return run_over(TINY_AXES if quick else COARSE_AXES, folder, report, jobs, opener)
