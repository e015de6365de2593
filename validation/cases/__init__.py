"""Cases of the verification: pytest tests in test_*.py, and those still run by validation/harness/case.py."""

MODULES: tuple[str, ...] = (
    "validation.cases.suite.reduced_hard_cases",
    "validation.cases.suite.harness",
    "validation.cases.suite.costs",
)
