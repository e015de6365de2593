"""Separation of the mean planes against load: both theories, and the straight line of ln p against s.

ln(p/E*) = c - s/u0 by least squares over the loads of `FITTED` (chosen beforehand: from 0.0025 to 0.01 E*, where the
paper's plot is straight).  The separation is judged relative to the theory's, at each load of `JUDGED`: in units of
h_rms a difference of half the theory's separation at high load would look small.  At small load the theory's separation
grows without bound, as heights of a Gaussian profile do; a profile of finite length has a highest crest, and s stays
below it.

Source: Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65, arXiv:1006.0601, section 5; theory: Yang, Persson,
J. Phys.: Condens. Matter 20 (2008) 215214, doi:10.1088/0953-8984/20/21/215214.
"""

import numpy as np

from bem.scene.result import State
from persson import AdhesiveContact, NonadhesiveContact
from validation.harness.arrays import FloatArray
from validation.harness.figure_data import drawn, semilogx, trace
from validation.paper.evidence import Evidence, estimate, scattered
from validation.paper.members import LOADS
from validation.paper.statements import Topic
from validation.references.paper_problem import RMS_HEIGHT

FITTED = (0.0025, 0.005, 0.0075, 0.01)  # of E*
SMALL, DIFFERENT = 0.001, 0.2  # of E*; of the theory's separation
JUDGED = (0.005, 0.01, 0.015, 0.02, 0.025)  # of E*
CAUSE = (
    "a profile of one period has a highest crest (84 to 126 um here) and touches only below it; the theory's Gaussian "
    "heights have no bound"
)

HIGH = "the theory contacts less at high load: its solid stands off"


def _apart(state: State) -> float:
    return state.separation / RMS_HEIGHT


def _said(theory: AdhesiveContact | NonadhesiveContact) -> float:
    return (theory.separation or np.nan) / RMS_HEIGHT


def compute(evidence: Evidence) -> Topic:
    """Return statements and figure."""
    curves = evidence.against_load(_apart, _said)
    fitted = np.isin(LOADS, FITTED)
    log_load = np.log(np.array(LOADS)[fitted])

    def length_of(curve: FloatArray) -> float:
        return float(-1 / np.polyfit(curve[fitted], log_load, 1)[0])

    length, length_error = estimate([length_of(curve) for curve in curves.values])
    ratios = {load: estimate(curves.values[:, k] / curves.wet[k]) for k, load in enumerate(LOADS)}
    where = "section 5: separation in very good agreement with the theory, computed here, except at small loads"
    statements = (
        *(
            evidence.statement(
                where,
                f"separation over that of Persson's theory with adhesion at {load:g} E*",
                ratios[load],
                1.0,
                0.2,
                0.5,
                HIGH if load > 0.01 else "",
            )
            for load in JUDGED
        ),
        evidence.statement(
            "section 5: except at small loads",
            f"separation over that of the theory at {SMALL:g} E*, off by more than {DIFFERENT:.0%}",
            ratios[SMALL],
            1.0,
            DIFFERENT,
            None,
            CAUSE,
            differs=True,
        ),
        evidence.statement(
            "section 5: the theory, computed here, predicts the separation very well",
            "length u0 of ln(p/E*) = c - s/u0, over u0 of the theory with adhesion",
            (length / length_of(curves.wet), length_error / length_of(curves.wet)),
            1.0,
            0.1,
            None,
            CAUSE,
        ),
    )
    figure = drawn(
        "separation-against-load",
        "Separation of the mean planes against load, logarithmic in the load: every realisation, their mean "
        "with its standard error, and both theories, which adhesion hardly sets apart.",
        semilogx(
            "mean pressure $p/E^*$",
            "separation $s/h_{rms}$",
            *scattered([realisation.path(_apart) for realisation in evidence.loading], LOADS, curves.values),
            trace("Persson with adhesion", LOADS, curves.wet, hue=1),
            trace("Persson without adhesion", LOADS, curves.dry, "dashed", hue=2),
        ),
    )
    return Topic("Does the separation follow the theory?", statements, (), (figure,))
