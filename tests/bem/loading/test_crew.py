"""Parts of a step in several processes: the same answers in the same order, and workers that end when they should."""

import multiprocessing
import os
from dataclasses import replace

import pytest
from rough_surfaces import banded_scene

from bem.loading import crew
from bem.loading.crew import MANY, Crew
from bem.loading.workers import Workers
from bem.solver import solve


def power(base, exponent):
    return base**exponent


def where(shared, part):
    return os.getpid()


@pytest.fixture
def _at_once(monkeypatch):
    """Workers work from the first step of two parts on."""
    monkeypatch.setattr(crew, "MANY", 2)
    monkeypatch.setattr(Workers, "ready", True)


@pytest.mark.usefixtures("_at_once")
def test_answers_keep_the_order_of_the_parts():
    with Crew(2) as some:
        assert list(some.each(power, 2, range(20))) == [2**k for k in range(20)]
        assert list(some.each(power, 2, [5])) == [32]
        assert os.getpid() not in some.each(where, 2, range(4))


def test_until_workers_are_ready_the_work_is_done_at_home():
    with Crew(2) as some:
        assert set(some.each(where, None, range(MANY))) == {os.getpid()}


@pytest.mark.usefixtures("_at_once")
def test_windows_in_two_processes_are_those_of_one():
    alone, seen = solve(banded_scene([2.5e-6, 2.4e-6])), set()

    def look(progress):
        seen.update(child.pid for child in multiprocessing.active_children())

    together = solve(banded_scene([2.5e-6, 2.4e-6]), progress=look, jobs=2)
    assert len(seen) == 2 and not multiprocessing.active_children()
    assert together.status == "converged"
    assert together.events == alone.events
    for state, other in zip(together.states, alone.states, strict=True):
        assert replace(state, cpu_seconds=0.0) == replace(other, cpu_seconds=0.0)
