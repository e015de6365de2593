"""The harness examined by itself: rows whose verdicts, errors and tolerances are known, orders, a known baseline.

The number of wrong answers is compared with none; it is also pinned, since a judge that accepts everything would
accept its own errors, but not move the baseline.
"""

import hashlib
import math
import tempfile
from pathlib import Path

from validation.cases.shared.checks import Against, Found, case
from validation.harness.baseline import Baseline, differences, quantities_of
from validation.harness.compare import combined_tolerance, error_of, fitted_order, pairwise_orders
from validation.harness.schema import CaseRecord, Report, Row
from validation.harness.verdict import Verdict, fails, verdict_of

KNOWN = Against("exact", "rows made for the purpose")


def _row(computed: list[float | None], expected: list[float | None], uncertainty: float = 0.0) -> Row:
    made = Against("FEM", "a row made for the purpose", uncertainty)
    return made.row("load", "N/m", expected, computed, (0.1, 0.04), "absolute", 2.0)


def _ratio(computed: float) -> Row:
    made = Against("theory", "a row made for the purpose")
    return made.ratio("area", "", 2.0, computed, (1.5, 3.0), "made up", "this case", review="2099-01-01")


def _verdicts() -> list[tuple[Row, Verdict]]:
    """Rows and the verdicts that are right."""
    return [
        (_row([1.0], [1.0]), "agrees"),
        (_row([1.19], [1.0]), "marginal"),
        (_row([1.21], [1.0]), "deviates"),
        (_row([0.79], [1.0]), "deviates"),
        (_row([1.0, 1.0, 1.0, 1.3], [1.0] * 4), "deviates"),
        (_row([1.0, None], [1.0, 1.0]), "error"),
        (_row([1.0, math.nan], [1.0, 1.0]), "error"),
        (_row([1.5], [1.0], uncertainty=0.6), "agrees"),
        (_row([1.7], [1.0], uncertainty=0.6), "deviates"),
        (_ratio(4.0), "expected deviation"),
        (_ratio(2.1), "changed"),
        (_ratio(7.0), "changed"),
    ]


def _harness() -> Found:
    wrong = sum(verdict_of(row) != right for row, right in _verdicts())
    errors = [error_of(_row([1.0, 1.4, 0.4], [1.0, 1.0, 1.0])), error_of(_ratio(4.0))]
    allowed = [combined_tolerance(_row([1.0], [1.0], uncertainty=known)) for known in (0.0, 0.6)]
    sizes = [0.5, 0.25, 0.1, 0.05]
    decay = [3.0 * size**2.5 for size in sizes]
    orders = [fitted_order(sizes, decay), *pairwise_orders(sizes, decay)]
    before, after = _record(1.0, 3.0, 100), _record(1.5, 4.0, 130)  # value, patches and evaluations have moved
    with tempfile.TemporaryDirectory() as folder:
        gone = differences(before, Path(folder)) != []
        pinned = Baseline(case=before.id, reason="made for the purpose", date="2099-01-01", commit="none", versions={},
                          blas="none", blas_threads=1, scene_sha256=hashlib.sha256(b"").hexdigest(), resolution={},
                          quantities=quantities_of(before))  # fmt: skip
        (Path(folder) / f"{before.id}.json").write_text(pinned.model_dump_json(), "utf-8")
        told = len(differences(after, Path(folder)))
    reports = [Report(level="quick", command="run", planned=planned, provenance={}, cases=[before])
               for planned in (1, 2, 0)]  # fmt: skip
    arithmetic = (1e-14, 4e-15)  # orders by logarithms; the others to the last digit
    yield KNOWN.count("wrong verdicts on known rows", 0.0, wrong)
    yield KNOWN.row("errors of known rows", "", [0.3, 2.0], errors, arithmetic, "absolute")
    yield KNOWN.row("tolerances of known rows, the second set by the uncertainty", "", [0.1, 0.3], allowed, arithmetic,
                    "absolute")  # fmt: skip
    yield KNOWN.row("orders of a sequence of order 5/2, fitted and between neighbours", "", [2.5] * 4, orders,
                    arithmetic, "absolute")  # fmt: skip
    yield KNOWN.count("differences told from a known baseline", 3.0, told)
    yield KNOWN.count("failing (1: yes): all cases reported, one fewer than planned, one more", [0.0, 1.0, 1.0],
                      map(fails, reports))  # fmt: skip
    yield KNOWN.count("a baseline that is gone is told (1: yes)", 1.0, gone)
    yield {"rows": len(_verdicts())}


def _record(load: float, patches: float, evaluations: int) -> CaseRecord:
    counted = _row([patches], [patches]).model_copy(update={"quantity": "patches", "pinned": "exact"})
    return CaseRecord(id="known", group="harness", level="quick", question="q", equations="e", sources=[],
                      rows=[_row([load], [1.0]), counted], counts={"evaluations": evaluations})  # fmt: skip


CASES = (
    case("harness", "harness", _harness,
         "Does the harness judge rows right whose verdicts are known?",
         r"$e = \max_i \frac{|x_i - y_i|}{c}$; "
         r"allowed $= \max(\text{tolerance}, \frac{\sqrt{u_x^2 + u_y^2}}{c})$, "
         "$x$ computed, $y$ expected, $c$ the scale",
         "oberkampf2008", code="suite"),
)  # fmt: skip
