"""Profiles of the theory correction: the split holds, the axes are covered, all share the paper's rms slope."""

import numpy as np
import pytest

from bem.scene.scene import parse_scene
from validation.references.paper_problem import MODULUS, RMS_SLOPE
from validation.studies.theory_correction.correction_members import Group, groups


def of_part(part, kind=None):
    return [group for group in groups() if group.part == part and kind in (None, group.kind)]


def test_fit_covers_the_axes():
    assert {group.hurst for group in of_part("fit")} == {0.3, 0.5, 0.7, 0.9}
    assert {group.harmonics for group in of_part("fit")} == {30, 100, 300, 1000}
    assert {group.theta for group in of_part("fit")} == {0.0}  # adhesion has a fit of its own
    assert (min(of_part("fit")[0].loads), max(of_part("fit")[0].loads)) == (0.001, 0.05)


@pytest.mark.parametrize("of", [lambda g: g.hurst, lambda g: g.harmonics], ids=["hurst", "bandwidth"])
def test_self_affine_hold_out_has_nothing_of_the_fit(of):
    assert not {of(group) for group in of_part("hold-out", "self-affine")} & {of(group) for group in of_part("fit")}


def test_hold_out_has_other_loads_and_seeds():
    fitted, held = of_part("fit")[0], of_part("hold-out", "self-affine")[0]
    assert not set(fitted.loads) & set(held.loads)
    phases = [group.member(0).scene["profile"]["phases"][:30] for group in (fitted, held)]
    assert phases[0] != phases[1]


def test_hold_out_has_all_kinds():
    assert {group.kind for group in of_part("hold-out")} == {"self-affine", "roll-off", "gaussian", "lines"}


@pytest.mark.parametrize("quick", [True, False], ids=["quick", "full"])
def test_scenes_are_valid_and_share_the_slope(quick):
    for group in groups(quick):
        surface = parse_scene(group.member(0).scene).surface()
        assert surface.rms_slope == pytest.approx(RMS_SLOPE, rel=1e-12)


def test_names_differ():
    names = [member.name for group in groups() for member in group.members()]
    assert len(set(names)) == len(names)


def test_papers_adhesion_is_the_papers():
    paper = Group("fit", "self-affine", 0.7, 1000, 0.03, 1)
    # 0.0335: theta = 0.027 would be its 0.03 J/m^2 exactly
    assert paper.work_of_adhesion * (50e-6 / paper.lines.h_rms) ** 2 == pytest.approx(0.03, rel=0.15)
    assert paper.lines.h_rms == pytest.approx(50e-6, rel=0.01)
    assert pytest.approx(4e6 / 3) == MODULUS


def test_unknown_kind_is_refused():
    with pytest.raises(ValueError, match="flat"):
        _ = Group("fit", "flat", np.nan, 10, 0.0, 1).lines
