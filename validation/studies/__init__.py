"""Studies: longer runs that answer one question about the suite itself.

Each is a module (its name with underscores) of this package or, with more than two files, of a folder of its own, with
`run(folder, quick, report) -> exit code`; those of `ON_EXECUTORS` take the number of processes and the opener of an
executor as well, those of `IN_PROCESSES` the number of processes alone.
"""

STUDIES: dict[str, str] = {
    "work-precision": "error against time of every method, the price of each effect, and what to choose, in words",
    "convergence": "rates of every code against those predicted: geometric, algebraic, with and without graded meshes",
    "cost": "seconds, memory and counts of the paper's profile against harmonics; path convergence",
    "stability": "the hard cases of all codes: converged, correct and refused counted apart, over a fixed denominator",
    "maps": "slope of the area and hysteresis loop against Hurst exponent, bandwidth, adhesion and layer thickness",
    "faults": "would the suite notice: faults put into the running code, what catches them, how small they may be",
    "adhesive-edges": "area with adhesion from the edges of the contact: pairs of ensembles, coefficients, hold-out",
    "contact-slope": "area without adhesion from the slope over the contact: ensembles, coefficients, hold-out",
    "theory-correction": "the correction of Persson's area calibrated, judged on a hold-out, and put on a page",
}

OF_A_SCENE = "scene"  # the study of one scene, in own_scene/: it takes a scene file and options of its own

ON_EXECUTORS = ("maps", "adhesive-edges", "contact-slope", "theory-correction")
IN_PROCESSES = ("stability",)  # one at a time unless asked otherwise, so that seconds compare
IN_FOLDERS = ("work-precision", "faults", "theory-correction")


def module_of(name: str) -> str:
    """Name of the module of a study.

    Examples
    --------
    >>> module_of("contact-slope"), module_of("faults")
    ('validation.studies.contact_slope', 'validation.studies.faults.faults')
    """
    module = name.replace("-", "_")
    return f"{__name__}.{module}.{module}" if name in IN_FOLDERS else f"{__name__}.{module}"
