"""Random scenes: any profile, solid, layer, adhesion, history and accuracy, at lengths from nm to m.

Scene k of seed K comes from its own random numbers.  Each is solved at two increments, and its targets anew by dense
algebra next to their edges.  Ends of every range and what must be refused are asked by tests/bem.  More of them:
`python -m validation.cases.random_judge`.
"""

import pytest

from validation.cases.random_judge import judge
from validation.corpus.random_scenes import draw

SEED = 20
QUICK = (*range(6), 10, 12, 13, 16)
LEVELS = {"quick": QUICK, "standard": sorted({*range(30)} - {*QUICK}), "full": range(30, 90)}
SECONDS = ("symmetry that breaks while edges hardly move", "touch beside a fold, misled by the gaps of the bracket")


@pytest.mark.parametrize(
    "index",
    [pytest.param(index, marks=getattr(pytest.mark, level)) for level, of in LEVELS.items() for index in of],
)
def test_random_scene(rows, index, tmp_path):
    """Is a random scene answered alike at two increments and by dense algebra?"""
    judge(rows, draw(SEED, index), tmp_path)


MENDED = {  # scenes that showed a defect, by seed and number
    "flaw that opens at one edge and heals at the other": (100, 237),
    "fold behind the point that it was looked for from": (100, 1243),
    "touch beside a fold, misled by the gaps of the bracket": (7, 530),
    "load in a gap so narrow that digits of the control change it": (7, 1665),
    "symmetry that breaks while edges hardly move": (7, 1378),
    "limit point farther from coarse states than increments": (7, 264),
    "touch behind the coarse points beside a fold": (7, 1448),
    "two minima of a gap, the other of which closes first": (100, 526),
    "flaw that holds a crest": (7, 1237),
    "reference on steep crests with the slope term": (7, 1620),
}


@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=pytest.mark.standard if name in SECONDS else pytest.mark.quick) for name in MENDED],
)
def test_mended_scene(rows, name, tmp_path):
    """Is a random scene that once showed a defect answered alike at two increments and by dense algebra?"""
    judge(rows, draw(*MENDED[name]), tmp_path)
