"""Our own solver on the problems of the challenge (validation/challenge): does it give the certified answers?

Certified answers are closed forms where there are any, else the boundary elements at their finest confirmed by dense
algebra, finite elements or a path of a tenth of the increment (answers.json names them).  Here the solver runs at eight
digits.
"""

import pytest

from validation.challenge.judge import judge, names, problem
from validation.plugin.rows import Code
from validation.routes.boundary_elements import solve

LONG = ("paper-profile", "rough-1000", "steep")


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.full if name in LONG else pytest.mark.standard) for name in names()]
)
def test_own_answers(rows, name):
    """Does the solver give the certified answers of a problem of the challenge, to six digits?"""
    judge(rows, name, solve(problem(name)[0], 1e-8), digits=6.0, of=Code.BEM, own=1e-8)
