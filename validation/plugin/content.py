"""Content of report.json: rows with their verdicts, counts by kind, cases, figures, provenance."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

from validation.plugin.rows import KINDS, PASSING, VERDICTS, Quantity, Row

SCHEMA = "linecontact-report/2"


def content_of(run: Mapping[str, Any]) -> dict[str, Any]:
    """Return the content of report.json: rows with verdicts, counts, cases, figures, provenance."""
    rows = [stated for case in run["cases"] for stated in _rows_of(case)]
    rows += [_bare(case, "not run", "the run ended before") for case in run["not_run"]]
    cases = [{key: value for key, value in case.items() if key != "rows"} for case in run["cases"]]
    failed = sum(case["outcome"] not in ("passed", "skipped") for case in cases)
    content = {
        "schema": SCHEMA,
        "headline": headline(rows, len(cases), failed, len(run["not_run"])),
        "failed": failed,
        "rows": rows,
        "counts": {
            kind: {
                verdict: number
                for verdict in VERDICTS
                if (number := sum(row["kind"] == kind and row["verdict"] == verdict for row in rows))
            }
            for kind in KINDS
        },
        "quantities": [str(quantity) for quantity in Quantity],
        "statements": list(run.get("statements", [])),
        "costs": [cost for case in run["cases"] for cost in case["costs"]],
        "cases": cases,
        "resumed": run.get("resumed", 0),
        **{key: run[key] for key in ("level", "command", "seconds", "not_run", "provenance")},
    }
    return finite(content)  # type: ignore[no-any-return]


def _rows_of(case: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return the rows of a case as report.json states them; a case that ended by an error has a row that says so."""
    stated = [_stated(case, Row(**row)) for row in case["rows"]]
    if case["outcome"] == "skipped":
        stated.append(_bare(case["case"], "not run", case["message"]))
    if case["outcome"] == "error":
        lines = case["message"].strip().splitlines() or ["failed"]
        raised = [line[1:].strip() for line in lines if line.startswith("E ")]  # as pytest marks the exception
        stated.append(_bare(case["case"], "error", raised[0] if raised else " ".join(lines[-3:])))
    return stated


def _stated(case: Mapping[str, Any], row: Row) -> dict[str, Any]:
    at, has_values = row.worst, bool(row.values)
    return {
        "case": case["case"],
        "name": row.name,
        "quantity": row.quantity,
        "unit": row.unit,
        "kind": row.kind,
        "value": row.values[at] if has_values else None,
        "value_uncertainty": row.value_uncertainties[at] if has_values else None,
        "reference": row.references[at] if has_values else None,
        "reference_uncertainty": row.reference_uncertainties[at] if has_values else None,
        "routes": [row.of, row.by],
        "allowed": row.allowed[at] if has_values else None,
        "share": row.share if has_values else None,
        "reason": row.cause or row.message or row.reason,
        "verdict": row.verdict,
        "failed": row.verdict not in PASSING,
        "seconds": case["seconds"],
        "source": row.source,
        "place": row.place,
        "stored": row.stored,
        "values": row.values,
        "references": row.references,
        "failure": _failure(row),
    }


def _failure(row: Row) -> str:
    """Return why a row fails, in a few words; empty for a row that passes."""
    if row.verdict in PASSING:
        return ""
    if not row.values:
        return row.message or row.reason
    reference, allowed = row.references[row.worst], row.allowed[row.worst]
    if row.verdict == "deviates":
        return f"beyond the allowed {allowed:.3g} ({row.reason})"
    if row.verdict == "changed" and row.cause:
        return f"outside the band {reference - allowed:.6g} to {reference + allowed:.6g}; known cause: {row.cause}"
    if row.verdict == "changed":
        return f"error {row.error:.3g}, stored error {row.stored:.3g}, limit {row.limit:.3g}"
    unstored = row.must_be_stored and row.stored is None and math.isfinite(row.error)
    return "no error is stored: verify with --store --reason TEXT" if unstored else "a number is missing or infinite"


def _bare(case: str, verdict: str, reason: str) -> dict[str, Any]:
    """Return the row of a case that has no numbers."""
    stated = _stated({"case": case, "seconds": 0.0}, Row("", "", "", "", "accuracy"))
    judged = {"verdict": verdict, "failed": verdict not in PASSING, "reason": reason, "failure": reason}
    return stated | judged | {"routes": []}


def headline(rows: Iterable[Mapping[str, Any]], ran: int, failed: int, not_run: int) -> str:
    """Return the outcome in one sentence; rows of accuracy alone are counted, known deviations apart."""
    accuracy = [row for row in rows if row["kind"] == "accuracy" and row["routes"]]
    known = sum(row["verdict"] == "expected deviation" for row in accuracy)
    agree = sum(row["verdict"] in PASSING for row in accuracy) - known
    marginal = sum(row["verdict"] == "marginal" for row in accuracy)
    close = f" ({marginal} marginal)" if marginal else ""
    apart = f", {known} known deviation{'s' * (known != 1)} inside the band" if known else ""
    cases = f"{failed} of {ran} cases failed" if failed else f"all {ran} cases passed"
    missing = f", {not_run} did not run" if not_run else ""
    return f"{agree} of {len(accuracy) - known} independent comparisons agree{close}{apart}; {cases}{missing}"


def finite(value: Any) -> Any:
    """Return a value in which NaN and infinity are None: JSON has neither."""
    if isinstance(value, Mapping):
        return {key: finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [finite(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
