"""Work for worker processes done in the process of the test or in a fork of it: starting one takes half a second."""

import multiprocessing
import os
import warnings
from contextlib import contextmanager

import pytest


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
