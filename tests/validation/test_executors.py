"""Processes of this machine: one BLAS thread each; an item that dies or takes too long costs no other."""

import os
import time
from functools import partial

import numpy as np
import pytest
from threadpoolctl import threadpool_info

from validation.harness import executors
from validation.harness.execution import Ended, WorkerDiedError, answers_in_order, run_in_processes


@pytest.mark.parametrize("code", [0, 1])
def test_item_that_ends_its_process_is_told_whatever_the_exit_code(forked, code):
    (_, ended) = run_in_processes(os._exit, [code], 1)
    assert isinstance(ended.answer, WorkerDiedError)


def test_answers_stand_in_the_order_of_their_items_and_exceptions_in_their_place(forked):
    late, wrong, soon = answers_in_order(eval, ["__import__('time').sleep(0.3)", "1 / 0", "3"], 2)
    assert (late, soon) == (None, 3)
    assert isinstance(wrong, ZeroDivisionError)


def test_item_that_reaches_its_limit_ends_and_costs_no_other(forked):
    events = list(run_in_processes(time.sleep, [60.0, 0.0], 2, limit=lambda seconds: 0.3))
    answers = {event.item: event.answer for event in events if isinstance(event, Ended)}
    assert isinstance(answers[60.0], TimeoutError) and answers[0.0] is None


THREADS = partial(eval, "[pool['num_threads'] for pool in threads()]", {"threads": threadpool_info, "of": np.float64})


def test_local_worker_uses_one_blas_thread(monkeypatch):
    for name in executors.THREAD_VARIABLES:
        monkeypatch.setenv(name, "2")
    (answer,) = [event.answer for event in run_in_processes(THREADS, [{}], 1) if isinstance(event, Ended)]
    assert set(answer) == {1}
