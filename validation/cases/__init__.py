"""The registry: every group of cases is one module, listed here in the order of the report."""

MODULES: tuple[str, ...] = (
    "validation.cases.overview",
    "validation.cases.sinusoid",
    "validation.cases.complete",
    "validation.cases.identities",
    "validation.cases.path_convergence",
    "validation.cases.paper_profile",
    "validation.cases.fault_gaps",
    "validation.cases.harness",
)
