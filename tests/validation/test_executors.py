"""Executors: opened by a text, one BLAS thread each; a real dask scheduler that loses a worker loses no member."""

import argparse
import json
import os
import signal
import subprocess
import sys
import time
from functools import partial
from importlib.util import find_spec

import numpy as np
import pytest
from example_tasks import squared
from threadpoolctl import threadpool_info

from validation import __main__ as command_line
from validation.harness import executors
from validation.harness.execution import Ended, Running, WorkerDiedError, answers_in_order, run_in_processes
from validation.harness.executors import ExecutorError, opener_of

needs_dask = pytest.mark.skipif(find_spec("distributed") is None, reason="the extra 'cluster' is not installed")


@pytest.mark.parametrize("spec", ["slurm", "dask://", "dask://host", "dask://:8786", "dask://host:port", "", "Local"])
def test_unknown_executor_is_refused(spec):
    with pytest.raises(ExecutorError, match="neither 'local' nor 'dask://host:port'"):
        opener_of(spec)


@pytest.mark.parametrize("words", [["run"], ["replicate"]], ids=["run", "replicate"])
def test_processes_of_this_machine_are_the_default(words):
    parser = argparse.ArgumentParser()
    command_line.add_commands(parser.add_subparsers())
    options = parser.parse_args([*words, "--out", "here"])
    assert opener_of(options.executor) is executors.local_processes
    assert options.jobs == os.cpu_count()


@needs_dask
def test_scheduler_out_of_reach_is_told(monkeypatch):
    monkeypatch.setattr(executors, "PATIENCE", 1.0)
    with pytest.raises(ExecutorError, match="no dask scheduler answers"), opener_of("dask://127.0.0.1:9")(1):
        pass


def test_dask_without_the_extra_is_told(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(ExecutorError, match=r"linecontact\[cluster\]"), opener_of("dask://127.0.0.1:9")(1):
        pass


def test_environment_is_put_back(monkeypatch):
    monkeypatch.setenv("OMP_NUM_THREADS", "3")
    monkeypatch.delenv("MKL_NUM_THREADS", raising=False)
    with opener_of("local")(1):
        assert os.environ["OMP_NUM_THREADS"] == os.environ["MKL_NUM_THREADS"] == "1"
    assert os.environ["OMP_NUM_THREADS"] == "3"
    assert "MKL_NUM_THREADS" not in os.environ


class Cluster:
    """A scheduler and two workers in processes of their own, on the loopback address, started as they are needed."""

    def __init__(self, folder):
        self.folder, self.scheduler, self.workers, self.address = folder, None, [], None
        path = os.pathsep.join(path for path in sys.path if path)
        self.environment = os.environ | dict.fromkeys(executors.THREAD_VARIABLES, "2") | {"PYTHONPATH": path}

    def start(self, *words):
        return subprocess.Popen(
            [sys.executable, "-m", "distributed.cli." + words[0], *words[1:], "--host", "127.0.0.1", "--no-dashboard"],
            env=self.environment, cwd=self.folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip

    def ready(self):
        """Itself, once a scheduler and two workers run: those that a test killed are replaced."""
        if self.scheduler is None or self.scheduler.poll() is not None:
            self.stop()
            where = self.folder / "scheduler.json"
            where.unlink(missing_ok=True)
            self.scheduler = self.start("dask_scheduler", "--port", "0", "--scheduler-file", str(where))
            deadline = time.monotonic() + 60
            while not where.exists() or not where.read_text().strip():
                assert time.monotonic() < deadline, "no scheduler"
                time.sleep(0.1)
            self.address = json.loads(where.read_text())["address"].removeprefix("tcp://")
        self.workers = [worker for worker in self.workers if worker.poll() is None]
        while len(self.workers) < 2:
            self.workers.append(self.start("dask_worker", f"tcp://{self.address}", "--nthreads", "1", "--no-nanny"))
        return self

    def stop(self):
        for process in filter(None, (*self.workers, self.scheduler)):
            process.kill()
            process.wait()


@pytest.fixture(scope="module")
def processes(tmp_path_factory):
    made = Cluster(tmp_path_factory.mktemp("cluster"))
    yield made
    made.stop()


@pytest.fixture
def cluster(processes):
    return processes.ready()


@pytest.fixture(params=["local", pytest.param("dask", marks=[needs_dask, pytest.mark.slow])])
def two_workers(request):
    """An opener of two processes that a test may kill: of this machine, or of a scheduler."""
    if request.param == "local":
        return opener_of("local")
    return opener_of(f"dask://{request.getfixturevalue('cluster').address}")


@pytest.mark.filterwarnings(r"ignore:\s*Mismatched versions found:Warning")
def test_task_of_a_killed_worker_is_run_again_and_counted_once(two_workers, tmp_path, monkeypatch):
    monkeypatch.setattr(executors, "PATIENCE", 90.0)
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(path for path in sys.path if path))
    planned, ended, killed = range(8), [], []

    def runs(k):
        return (tmp_path / str(k)).read_text().split() if (tmp_path / str(k)).exists() else []

    for event in run_in_processes(partial(squared, str(tmp_path)), planned, 2, 0.05, two_workers):
        if isinstance(event, Ended):
            ended.append((event.item, event.answer))
        elif isinstance(event, Running) and ended and not killed:
            killed = [(k, pid) for k in event.items for pid in runs(k)][:1]
            for _, pid in killed:
                os.kill(int(pid), signal.SIGKILL)
    ((victim, pid),) = killed
    assert sorted(ended) == [(k, k * k) for k in planned]
    assert runs(victim)[0] == pid
    assert set(runs(victim)) > {pid}  # by another process


def test_where_nothing_waits_no_executor_is_asked():
    assert list(run_in_processes(len, [], 2, opener=opener_of("dask://nowhere:1"))) == []


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


@pytest.fixture
def many_threads(monkeypatch):
    for name in executors.THREAD_VARIABLES:
        monkeypatch.setenv(name, "2")


def threads_of_a_worker(opener):
    (answer,) = [
        event.answer for event in run_in_processes(THREADS, [{}], 1, opener=opener) if isinstance(event, Ended)
    ]
    return answer


@needs_dask
def test_dask_worker_uses_one_blas_thread(many_threads, cluster):
    assert set(threads_of_a_worker(opener_of(f"dask://{cluster.address}"))) == {1}


def test_local_worker_uses_one_blas_thread(many_threads):
    assert set(threads_of_a_worker(opener_of("local"))) == {1}
