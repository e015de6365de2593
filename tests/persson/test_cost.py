"""What a load costs, in nodes and evaluations of the diffusion: counts are gated, seconds are reported.

Measured on one core: the paper's case with separation 0.1 s, 10^4 lines over 5 decades 0.3 s.
"""

from time import perf_counter

import numpy as np
import pytest

from persson import DiscreteSpectrum, solve


@pytest.fixture(scope="module")
def cases(spectra):
    q = 2 * np.pi / 0.01 * np.geomspace(1, 1e5, 10_000)
    shape = q**-0.7
    return {
        "paper": spectra["paper"],
        "10^4 lines, 5 decades": DiscreteSpectrum(q, shape * 50e-6 * np.sqrt(2 / np.sum(shape**2))),
        "10^4 lines of a period": DiscreteSpectrum.self_affine(2 * np.pi / 0.01, 0.7, 50e-6, 10_000),
    }


@pytest.mark.parametrize(
    ("name", "load", "nodes", "iterations"),
    [
        ("paper", 0.005, 1208, 4),
        ("paper", 0.02, 985, 4),
        ("10^4 lines, 5 decades", 0.005, 1812, 5),
        ("10^4 lines of a period", 0.005, 1367, 4),
    ],
)
def test_a_load_costs_few_nodes_and_iterations(
    cases, solid, modulus, name, load, nodes, iterations, record_property, capsys
):
    begin = perf_counter()
    state = solve(cases[name], load * modulus, work_of_adhesion=0.03, **solid)
    seconds = perf_counter() - begin
    record_property("seconds", seconds)
    with capsys.disabled():
        print(f" {name}, {load} E*: {seconds:.2f} s", end="")
    assert state.status == "converged"
    assert state.areas.size <= 1.2 * nodes
    assert state.fields.iterations <= iterations + 2


def test_nodes_do_not_follow_the_number_of_lines(cases, solid, modulus):
    sizes = [
        solve(cases[name], 0.02 * modulus, work_of_adhesion=0.03, with_separation=False, **solid).areas.size
        for name in ("paper", "10^4 lines of a period")
    ]
    assert sizes[1] < 1.5 * sizes[0]
