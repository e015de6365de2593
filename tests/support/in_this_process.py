"""Work for worker processes done in the process of the test: starting another takes half a second."""

import pickle
from concurrent.futures import Executor, Future
from contextlib import contextmanager

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
