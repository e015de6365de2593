"""The registry: every group of cases is one module, listed here in the order of the report."""

MODULES: tuple[str, ...] = (
    "validation.cases.overview",
    "validation.cases.sinusoid",
    "validation.cases.complete",
    "validation.cases.identities",
    "validation.cases.path_convergence",
    "validation.cases.paper_profile",
    "validation.cases.fem_closed_forms",
    "validation.cases.fem_equilibria",
    "validation.cases.fault_gaps",
    "validation.cases.theory_routes",
    "validation.cases.stability",
    "validation.cases.harness",
    "validation.cases.convergence",
    "validation.cases.paper_method_audit",
    "validation.cases.theory_accuracy",
    "validation.cases.theory_contact",
    "validation.cases.theory_spectra",
)
