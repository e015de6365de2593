"""What accuracy costs by every route, measured once: error against CPU seconds, stored beside this file.

accuracy_costs.json is what `python -m validation study work-precision` writes under that name, copied here.  Seconds
are those of the machine that is named in it and gate nothing; the errors are against a closed form or another code.
"""

import json
from dataclasses import dataclass
from importlib import resources

from pydantic import TypeAdapter

FILE = "accuracy_costs.json"


@dataclass(frozen=True)
class CostPoint:
    """A route on a scene at one setting of its knob; the error is the larger of contact fraction and mean pressure."""

    scene: str
    route: str
    setting: str
    unknowns: int
    cpu_seconds: float
    error: float
    floor: float  # uncertainty of the reference
    reference: str


@dataclass(frozen=True)
class AccuracyCosts:
    """All points, and where they were measured."""

    machine: str
    date: str
    points: list[CostPoint]


def stored() -> AccuracyCosts:
    """The points that are stored.

    Examples
    --------
    >>> {point.scene for point in stored().points} >= {"sinusoid", "rough"}
    True
    """
    content = json.loads(resources.files("validation.corpus").joinpath(FILE).read_text("utf-8"))
    return TypeAdapter(AccuracyCosts).validate_python(content)
