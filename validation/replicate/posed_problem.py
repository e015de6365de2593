"""The problem as it is posed: the paper's first two figures, drawn from a solution, and the mean displacement u_m.

Of a layer u_m is what the plate moves besides the penetration, u_tot - Delta.  Under a mean pressure it is that of a
layer which cannot spread sideways, as its plate holds it and its neighbours are pressed alike; free to slide along the
plate it would be (1 - nu)^2 / (1 - 2 nu) times as large.

Source: Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65, arXiv:1006.0601, section 2.
"""

import numpy as np

from validation.harness.case import Outcome
from validation.harness.rows import Against
from validation.replicate.evidence import Evidence, mean_over_period
from validation.replicate.paper_sketch import POISSON_RATIO, mean_displacement, sketches
from validation.replicate.statements import Alternative

SPREADING = (1 - POISSON_RATIO) ** 2 / (1 - 2 * POISSON_RATIO)


def compute(evidence: Evidence) -> Outcome:
    """Rows and figures."""
    one = evidence.sketch
    if one is None:
        return Outcome(skipped=f"no solution to draw: {evidence.missing.get('sketch', 'it was not computed')}")
    state, fields = one.result.targets[0], one.result.fields
    u_m = (state.total_displacement or np.nan) - state.penetration
    above = fields["displacement_0"] + state.separation
    rows = (
        evidence.paper("section 2: mean displacement of the layer").states(
            "mean displacement u_m of a layer over d (1 - 2 nu)(1 + nu) sigma_0 / (E (1 - nu))",
            u_m / mean_displacement(state.mean_pressure), 0.0, 1.0, 1e-14,
            Alternative(SPREADING, "a layer free to slide along its plate"), measured=3.3e-16),
        Against("exact", "s is the height of the mean plane of the face").row(
            "mean height of the face that is drawn over the separation", "", 1.0,
            mean_over_period(one, 0, above) / state.separation, (1e-3, 3.6e-4), "absolute"),
        Against("exact", "s = h_max - Delta").row(
            "separation and penetration over the highest crest", "", 1.0,
            (state.separation + state.penetration) / one.surface.max_height, (1e-15, 2.2e-16), "absolute"),
    )  # fmt: skip
    return Outcome(rows=rows, figures=sketches(one.result, "problem-layer", "problem-heights"))
