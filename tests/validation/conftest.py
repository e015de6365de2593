"""What tests of studies share."""

import pytest
from in_this_process import forking

from validation.harness import store
from validation.harness.execution import Ended


@pytest.fixture
def here(monkeypatch):
    """Tasks of studies in this process: starting another takes seconds."""

    def in_this_process(function, items, jobs, **options):
        for item in items:
            try:
                yield Ended(item, function(item), 0.1)
            except Exception as error:
                yield Ended(item, error, 0.1)

    monkeypatch.setattr(store, "run_in_processes", in_this_process)


@pytest.fixture
def forked():
    """Processes of this machine are forks of this one."""
    with forking():
        yield
