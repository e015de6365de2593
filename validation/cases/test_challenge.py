"""Our own solver on the problems of the challenge (validation/challenge): does it give the certified answers?

Certified answers are closed forms where there are any, else the boundary elements at their finest confirmed by dense
algebra, finite elements or a path of a tenth of the increment (answers.json names them).  Here the solver runs at eight
digits.
"""

import tomllib

import pytest

from validation.challenge.judge import FOLDER, judge
from validation.harness.route import Problem
from validation.plugin.rows import Code
from validation.routes.boundary_elements import solve

LONG = ("paper-profile", "rough-1000", "steep")
NAMES = [pytest.param(path.name, marks=pytest.mark.full if path.name in LONG else pytest.mark.standard)
         for path in sorted(FOLDER.iterdir()) if path.is_dir()]


@pytest.mark.parametrize("name", NAMES)
def test_own_answers(rows, name):
    """Does the solver give the certified answers of a problem of the challenge, to six digits?"""
    tables = tomllib.loads((FOLDER / name / "problem.toml").read_text("utf-8"))
    judge(rows, name, solve(Problem.of(tables), 1e-8), digits=6.0, of=Code.BEM)
