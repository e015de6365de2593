"""Events on a rough layer of a hundredth of the period: the same events at two largest increments."""

import numpy as np
import pytest

import bem

PERIOD, RMS_HEIGHT, MODULUS = 0.01, 50e-6, 1e6 / 0.75
SEEDS = [int(np.random.SeedSequence(2009, spawn_key=(k,)).generate_state(1)[0]) for k in range(3)]


def scene(theta, seed, **tables):
    """Scene of a self-affine profile, loaded to half its rms height and back; theta over the energy of full contact."""
    surface = bem.Profile.self_affine(PERIOD, 0.7, RMS_HEIGHT, 100, seed)
    energy = MODULUS * float(np.sum(surface.q0 * surface.orders * surface.amplitudes**2)) / 8
    loading = np.linspace(0.5 * RMS_HEIGHT, 0.95 * surface.max_height, 24)[::-1].tolist()
    return {
        "title": f"layer, theta = {theta:g}",
        "solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.5},
        "profile": {
            "kind": "self_affine",
            "period": PERIOD,
            "hurst": 0.7,
            "rms_height": RMS_HEIGHT,
            "harmonics": 100,
            "seed": seed,
        },
        "loading": {"control": "separation", "targets": [*loading, surface.max_height + 6 * RMS_HEIGHT]},
        "adhesion": {"work_of_adhesion": theta * energy},
        "layer": {"thickness": 0.01 * PERIOD},
    } | tables


@pytest.mark.slow
@pytest.mark.parametrize(("theta", "k"), [(0.003, 1), (0.03, 0), (0.3, 2)])
def test_events_do_not_depend_on_the_increment(theta, k):
    """Without a look at crests that edges pass, and at hidden curvature, loops differed by 2e-3, 9e-5 and 1e-3."""
    coarse, fine = (
        bem.solve(scene(theta, SEEDS[k], **tables)).events for tables in ({}, {"accuracy": {"max_increment": 0.0125}})
    )
    assert [event.kind for event in coarse] == [event.kind for event in fine]
    loops = [sum(event.energy_released for event in events) for events in (coarse, fine)]
    assert loops[0] == pytest.approx(loops[1], rel=3e-8)  # measured 1.1e-8, 2e-11 and 8e-12


@pytest.mark.slow
@pytest.mark.parametrize("increment", [0.1, 0.2])
def test_a_small_snap_is_an_event_at_any_increment(increment):
    """A finer tolerance changed the fold by more than the released energy; of five increments one saw the event."""
    loading = {"control": "penetration", "targets": [4.5e-5]}
    snap = bem.solve(scene(0.3, SEEDS[2], loading=loading, accuracy={"max_increment": increment})).events[-1]
    assert (snap.kind, snap.penetration) == ("bifurcation", pytest.approx(4.45548386511e-5, rel=1e-11))
    assert snap.energy_released == pytest.approx(9.899e-8, abs=2e-10)  # spread over six increments: 7e-11
    assert snap.error_estimate.energy_released < 1e-9  # up to 4e-10
