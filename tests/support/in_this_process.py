"""Work for worker processes done in the process of the test or in a fork of it: starting one takes half a second."""

import multiprocessing
import os
import pickle
import warnings
from concurrent.futures import Executor, Future
from contextlib import contextmanager

import pytest

from validation.harness.executors import Workers


class Here(Executor):
    """Runs what is submitted at once; it and its answer are pickled, and every exception is handed back, as there."""

    def submit(self, fn, /, *args, **kwargs):
        future = Future()
        try:
            function, given, named = pickle.loads(pickle.dumps((fn, args, kwargs)))
            future.set_result(pickle.loads(pickle.dumps(function(*given, **named))))
        except BaseException as error:
            future.set_exception(error)
        return future


@contextmanager
def here(_):
    yield Workers(Here(), lambda: 1)


@contextmanager
def forking():
    """Processes that begin with what is imported here: what they do and how they die is tested, not how they start."""
    context, fork = multiprocessing.get_context("fork"), os.fork

    def without_warning():
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)  # Python 3.12 warns where there are threads
            return fork()

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(multiprocessing, "get_context", lambda method: context)
        patch.setattr(os, "fork", without_warning)
        yield
