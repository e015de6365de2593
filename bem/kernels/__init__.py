"""Compiled kernels: arrays and numbers in, new arrays out.

Each kernel stands once, in Cython, with a stub that holds its signature.  `pip install` builds the modules into the
package linecontact_compiled, which is no part of bem: a checkout that is not installed in place finds them too.
"""

from importlib.util import find_spec

BUILT = find_spec("linecontact_compiled")
if BUILT is None or BUILT.submodule_search_locations is None:
    raise ImportError("bem.kernels: the compiled kernels are not installed; run `pip install .` in the checkout")
__path__ = [*__path__, *BUILT.submodule_search_locations]
