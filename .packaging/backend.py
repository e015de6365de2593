"""setuptools with the kernels of bem/kernels, compiled by gcc or clang, or by ziglang where there is no C compiler.

A wheel is the same everywhere for its platform: no option asks for the processor of the machine that builds it.
"""

import os
import subprocess
import sys
import sysconfig
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import setuptools
from setuptools import build_meta
from setuptools.build_meta import *  # noqa: F403  the hooks

FOLDER = Path("bem/kernels")
PACKAGE = "linecontact_compiled"  # no part of bem: a checkout that is not installed in place finds it too
EXTENSIONS = [
    setuptools.Extension(
        f"{PACKAGE}.{path.stem}",
        [path.as_posix()],
        include_dirs=[FOLDER.as_posix()],
        depends=[".packaging/backend.py", f"{FOLDER.as_posix()}/vector.h"],
        extra_compile_args=[] if sys.platform == "win32" else ["-O3", "-g0"],
    )
    for path in sorted(FOLDER.glob("*.pyx"))
]
TRIAL = "#include <math.h>\n#include <stdint.h>\ndouble root(double x) { return sqrt(x); }\n"
setuptools.setup = partial(setuptools.setup, ext_modules=EXTENSIONS)  # whose sources a source distribution holds


def has_compiler():
    """Return whether the C compiler that setuptools would call compiles three lines."""
    from setuptools._distutils.ccompiler import new_compiler
    from setuptools._distutils.errors import CompileError, DistutilsExecError, DistutilsPlatformError
    from setuptools._distutils.sysconfig import customize_compiler

    with TemporaryDirectory() as folder:
        source = Path(folder, "trial.c")
        source.write_text(TRIAL)
        compiler = new_compiler()
        try:
            customize_compiler(compiler)
            objects = compiler.compile([str(source)], output_dir=folder)
        except (CompileError, DistutilsExecError, DistutilsPlatformError, OSError):
            return False
        return all(Path(name).is_file() for name in objects)


def get_requires_for_build_wheel(config_settings=None):
    """Return the requirements of setuptools, and ziglang where nothing else compiles."""
    return [*build_meta.get_requires_for_build_wheel(config_settings), *([] if has_compiler() else ["ziglang"])]


def get_requires_for_build_editable(config_settings=None):
    """Return the requirements of an installation in place: those of a wheel."""
    return get_requires_for_build_wheel(config_settings)


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """Build a wheel with the compiled kernels."""
    _prepare()
    return build_meta.build_wheel(wheel_directory, config_settings, metadata_directory)


def build_editable(wheel_directory, config_settings=None, metadata_directory=None):
    """Build the kernels for an installation in place."""
    _prepare()
    return build_meta.build_editable(wheel_directory, config_settings, metadata_directory)


def _prepare():
    """Choose the compiler, look for the header of Python, and hand the extensions to setuptools."""
    from Cython.Build import cythonize

    header = Path(sysconfig.get_paths()["include"], "Python.h")
    if not header.is_file():
        sys.exit(
            f"linecontact: {header} is missing, which the compiled kernels need: install the headers of Python "
            "(Debian and Ubuntu: python3-dev, Fedora: python3-devel), or install linecontact from a wheel"
        )
    if not has_compiler():
        zig = f"{sys.executable} -m ziglang"
        subprocess.run([*zig.split(), "version"], check=True, stdout=subprocess.DEVNULL)
        os.environ |= {"CC": f"{zig} cc", "CXX": f"{zig} c++", "LDSHARED": f"{zig} cc -shared", "AR": f"{zig} ar"}
    modules = cythonize(EXTENSIONS, build_dir="build")
    setuptools.setup = partial(setuptools.setup, ext_modules=modules)
