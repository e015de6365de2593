"""Realistic faults, each one wrong piece of code: what a slip of the pen, a lost factor or a forgotten case would do.

Those of the boundary elements come first, then of the paths and states made with them, of the finite elements, of
Persson's theory, of what leads from a scene to the codes, and of the harness that judges them all.
"""

from __future__ import annotations

from validation.studies.faults.fault_bem import BEM_FAULTS
from validation.studies.faults.fault_harness import HARNESS_FAULTS
from validation.studies.faults.fault_injection import Fault
from validation.studies.faults.fault_paths import PATH_FAULTS
from validation.studies.faults.fault_references import REFERENCE_FAULTS

CATALOGUE: tuple[Fault, ...] = (*BEM_FAULTS, *PATH_FAULTS, *REFERENCE_FAULTS, *HARNESS_FAULTS)

QUICK: tuple[str, ...] = (
    "bem-e-for-e-star",
    "bem-sensitivity-sign",
    "bem-layer-bracket",
    "persson-narrow-band",
    "harness-verdict-accepts",
)
"""Five faults for continuous integration: each is caught by a case below a second."""
