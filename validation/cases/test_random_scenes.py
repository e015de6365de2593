"""Random scenes: any profile, solid, layer, adhesion, history and accuracy, at lengths from nm to m.

Scene k of seed K comes from its own random numbers.  Each is solved at two increments, and its targets anew by dense
algebra next to their edges; a few are out of range and must be refused by name.  More of them:
`python -m validation.cases.random_judge`.
"""

import pytest

from validation.cases.random_judge import judge
from validation.corpus.random_scenes import draw

SEED = 20
LEVELS = {"quick": range(6), "standard": range(6, 30), "full": range(30, 90)}


@pytest.mark.parametrize(
    "index",
    [pytest.param(index, marks=getattr(pytest.mark, level)) for level, of in LEVELS.items() for index in of],
)
def test_random_scene(rows, index, tmp_path):
    """Is a random scene answered alike at two increments and by dense algebra, or refused by name?"""
    judge(rows, draw(SEED, index), tmp_path)
