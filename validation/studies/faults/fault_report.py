"""The results of the fault study: table, faults.json, and the lines of the figure of faults against cases."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict
from typing import Any

from validation.harness.verdict import case_verdicts
from validation.report.fault_matrix import FaultLine
from validation.studies.faults.fault_findings import Finding
from validation.studies.faults.fault_injection import Examined

SCHEMA = "linecontact-faults/2"


def lines_of(findings: Iterable[Finding]) -> list[FaultLine]:
    """The findings as lines of the figure of faults against cases."""
    return [
        FaultLine(finding.fault.id, finding.excesses, {*finding.failed, *finding.apart}, finding.asked)
        for finding in findings
    ]


def failures_of(findings: Iterable[Finding]) -> list[str]:
    """What the study asks for and did not get, one line each."""
    lines = []
    for finding in findings:
        others = {*finding.failed, *finding.excesses}
        if finding.fault.case not in others:
            reported = f"noticed by {', '.join(sorted(others))}" if others else "nothing notices it"
            lines.append(f"{finding.fault.id}: {finding.fault.case}, which must notice it, does not; {reported}")
    return lines


def table_of(findings: Iterable[Finding]) -> str:
    """The table on stdout."""
    lines = [f"{'fault':34} {'caught by':>9} {'error/allowed':>13} {'smallest':>9} {'keenest case'}"]
    for finding in findings:
        best = max(finding.sights, key=lambda sight: sight.excess, default=None)
        unseen = f"by name: {', '.join(sorted(finding.failed))}" if finding.failed else "NOTHING"
        keenest = unseen if best is None else f"{best.case}: {best.quantity}"
        smallest = "-" if finding.smallest is None else f"{finding.smallest:.0e}"
        apart = f"  [apart: {', '.join(sorted(finding.apart))}]" if finding.apart else ""
        lines.append(
            f"{finding.fault.id:34} {len(finding.excesses):>3} of {len(finding.asked):<2} {finding.excess:>13.3g} "
            f"{smallest:>9} {keenest}{apart}"
        )
    return "\n".join(lines)


def content_of(
    facts: dict[str, Any], control: Examined, findings: Iterable[Finding], planned: int, failures: list[str]
) -> dict[str, Any]:
    """Contents of faults.json: provenance, control, findings, faults that were to be examined, what was not met."""
    return {
        "schema": SCHEMA,
        "provenance": facts,
        "planned": planned,
        "failures": failures,
        "control": [
            {"case": record.id, "seconds": record.seconds, "verdicts": list(case_verdicts(record))}
            for record in control.records
        ],
        "faults": [
            asdict(finding.fault)
            | {
                "caught": finding.caught,
                "noticed": finding.noticed,
                "calls": finding.calls,
                "size_shown": finding.size,
                "asked": finding.asked,
                "caught_by": [asdict(sight) for sight in sorted(finding.sights, key=lambda sight: -sight.excess)],
                "crashes_and_refusals": finding.failed,
                "apart": finding.apart,
                "smallest_size_caught": finding.smallest,
                "largest_size_missed": finding.unseen,
            }
            for finding in findings
        ],
    }
