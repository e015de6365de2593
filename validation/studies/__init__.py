"""Studies: longer runs that answer one question about the suite itself.

Each is a module of this package or of a folder of it, with `cases(bench, ...)`: cases (harness/case.py) that are
computed at a bench (bench.py) and become one report; what else that takes are the options of the command which the
study has.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class Study:
    """The module of a study, the options that it takes besides --quick and --out, and what it asks."""

    module: str
    takes: frozenset[str]
    what: str


STUDIES = {
    "work-precision": Study("work_precision.work_precision", frozenset({"peers"}),
        "error against time of every method, the price of each effect, and what to choose, in words"),
    "convergence": Study("convergence", frozenset(),
        "rates of every code against those predicted: geometric, algebraic, with and without graded meshes"),
    "stability": Study("stability", frozenset({"jobs", "random", "seed"}),
        "the hard cases of all codes: converged, correct and refused counted apart, over a fixed denominator"),
    "faults": Study("faults.faults", frozenset({"jobs"}),
        "would the suite notice: faults put into the running code, what catches them, how small they may be"),
}  # fmt: skip
OF_A_SCENE = "scene"  # the study of one scene
SCENE = Study("own_scene", frozenset({"scene", "seeds", "budget", "overwrite", "jobs"}),
    "how far each answer of a scene moves with its cut, preparation, seed and tolerance")  # fmt: skip


def that_take(option: str) -> str:
    """Names of the studies that take an option."""
    return ", ".join(name for name, study in ({OF_A_SCENE: SCENE} | STUDIES).items() if option in study.takes)
