"""What tests of studies share."""

import pytest
from in_this_process import Here, forking

from validation.harness import executors
from validation.harness.execution import Ended
from validation.studies import kept_answers


@pytest.fixture
def here(monkeypatch):
    """Tasks of studies in this process: starting another takes seconds."""

    def in_this_process(function, item):
        try:
            yield Ended(item, function(item))
        except Exception as error:
            yield Ended(item, error)

    monkeypatch.setattr(kept_answers, "run_alone", in_this_process)


@pytest.fixture
def in_this_process(monkeypatch):
    """Work for processes of this machine is done in this one."""
    monkeypatch.setattr(executors, "ProcessPoolExecutor", lambda workers, **options: Here())


@pytest.fixture
def forked():
    """Processes of this machine are forks of this one."""
    with forking():
        yield
