"""The problem as it is posed: the paper's first two figures, drawn from a solution, and the mean displacement u_m.

Of a layer u_m is what the plate moves besides the penetration, u_tot - Delta.  Under a mean pressure it is that of a
layer which cannot spread sideways, as its plate holds it and its neighbours are pressed alike; free to slide along the
plate it would be (1 - nu)^2 / (1 - 2 nu) times as large.

Source: Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65, arXiv:1006.0601, section 2.
"""

import numpy as np

from validation.paper.evidence import Evidence, mean_over_period
from validation.paper.paper_sketch import POISSON_RATIO, mean_displacement, sketches
from validation.paper.statements import Check, Statement, Topic

SPREADING = (1 - POISSON_RATIO) ** 2 / (1 - 2 * POISSON_RATIO)


def compute(evidence: Evidence) -> Topic:
    """Return statement, checks and figures."""
    question, sketch = "What is the problem?", evidence.sketch
    if sketch is None:
        return Topic(question, message=f"no solution to draw: {evidence.missing.get('sketch', 'it was not computed')}")
    state, fields = sketch.result.targets[0], sketch.result.fields
    u_m = (state.total_displacement or np.nan) - state.penetration
    height = mean_over_period(sketch, 0, fields["displacement_0"] + state.separation) / state.separation
    crest = (state.separation + state.penetration) / sketch.surface.max_height
    statement = Statement(
        "section 2: mean displacement of the layer",
        "mean displacement u_m of a layer over d (1 - 2 nu)(1 + nu) sigma_0 / (E (1 - nu))",
        1.0,
        u_m / mean_displacement(state.mean_pressure),
        0.0,
        1e-14,
        SPREADING,
        "excluded: a layer free to slide along its plate",
    )
    checks = (
        Check("mean height of the face that is drawn over the separation", height, 1.0, 1e-3),  # 3.6e-4
        Check("separation and penetration over the highest crest", crest, 1.0, 1e-15),
    )
    return Topic(question, (statement,), checks, sketches(sketch.result, "problem-layer", "problem-heights"))
