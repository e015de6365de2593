"""What installed packages offer under the entry points `linecontact.solvers` and `linecontact.cases`, by name.

Nothing is imported here: a solver that cannot be imported is a matter for whoever calls it, in a process of its own;
own_cases.py imports cases.
"""

from importlib.metadata import entry_points

from validation.harness.case import CaseError

SOLVERS, CASES = "linecontact.solvers", "linecontact.cases"


def solvers() -> dict[str, str]:
    """Solvers by name: for each the function as its package wrote it, "package.module:function".

    CaseError, here and below, where two packages offer something else under one name.
    """
    return _offered(SOLVERS)


def cases() -> dict[str, str]:
    """Modules of cases by name, "package.module"."""
    return _offered(CASES)


def _offered(group: str) -> dict[str, str]:
    found: dict[str, str] = {}
    for point in entry_points(group=group):
        other = found.setdefault(point.name, point.value)
        if other != point.value:
            raise CaseError(f"entry point {point.name!r} of {group} is offered twice: {other} and {point.value}")
    return found
