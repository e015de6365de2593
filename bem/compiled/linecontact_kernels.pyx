# cython: language_level=3, boundscheck=False, wraparound=False
"""The module linecontact_kernels: kernels that stand beside functions of the same names in NumPy, and say the same.

Each function here takes the arguments of the function that it mirrors (its docstring names it), looks at their types and
sizes, and calls what computes, in C.  BLAS and LAPACK are those of scipy.linalg.cython_blas and cython_lapack, whose
functions are looked up when the module is imported: an ImportError where one is not there or has other arguments.
"""

import re
from importlib import import_module

cimport numpy as np
from cpython.pycapsule cimport PyCapsule_GetName, PyCapsule_GetPointer
from libc.math cimport log
from libc.string cimport memcpy, memset

include "arrays.pxi"

np.import_array()

INTERFACE = "10"  # kernels.INTERFACE

cdef void *function(str module, str name, str arguments) except NULL:
    """A function of SciPy, if its arguments are these: c of characters, i of integers, d of numbers."""
    capsule = import_module(f"scipy.linalg.{module}").__pyx_capi__.get(name)
    cdef const char *said = b"not there"
    if capsule is not None:
        said = PyCapsule_GetName(capsule)
    found = re.fullmatch(r"void \((.*)\)", said.decode())
    words = [] if found is None else found[1].split(", ")
    kinds = [{"char *": "c", "int *": "i"}.get(word, "d" if word.endswith("_d *") else "?") for word in words]
    if "".join(kinds) != arguments:
        raise ImportError(f"{name} of SciPy is not as expected: {said.decode()}")
    return PyCapsule_GetPointer(capsule, said)


blas.dgemm = function("cython_blas", "dgemm", "cciiiddididdi")
blas.dgemv = function("cython_blas", "dgemv", "ciiddididdi")
blas.dsyrk = function("cython_blas", "dsyrk", "cciiddiddi")
blas.dtrsm = function("cython_blas", "dtrsm", "cccciiddidi")
blas.dpotrf = function("cython_lapack", "dpotrf", "cidii")
blas.dpstrf = function("cython_lapack", "dpstrf", "cidiiiddi")
asked.table, asked.range, asked.coefficients = table_of, range_of, coefficients_of


def taylor(table, x, double spacing_inverse, int derivatives):
    """profile.taylor: h, h', ... at points, (derivatives + 1, n)."""
    cdef Py_ssize_t of_table[2]
    cdef Py_ssize_t n
    cdef int order
    held = []
    cdef double *rows = reals(held, table, 2, of_table)
    cdef double *places = reals(held, x, 1, &n)
    expect(0 <= derivatives <= 3, "taylor: derivatives from 0 to 3")
    expect(of_table[0] > 0 and of_table[1] == TERMS, "taylor: a table of 14 terms")
    made = empty(2, derivatives + 1, n)
    for order in range(derivatives + 1):
        expansion(rows, of_table[0], spacing_inverse, order, n, places, numbers(made) + order * n)
    return made


cdef Length length_of(list held, start, width, series, whole_length) except *:
    cdef Length length
    cdef Py_ssize_t of_width
    cdef Py_ssize_t of_series[2]
    length.start, length.width = reals(held, start, 1, &length.panels), reals(held, width, 1, &of_width)
    length.series, length.whole = reals(held, series, 2, of_series), whole_length
    length.terms = of_series[1]
    expect(0 < length.panels == of_width == of_series[0] and length.terms > 0, "panels and series differ")
    return length


def integral(start, width, series, whole_length, x):
    """adhesion.integral: a Chebyshev series on the panel in which each position lies, and the whole for every turn."""
    cdef Py_ssize_t n, i
    held = []
    cdef Length length = length_of(held, start, width, series, whole_length)
    cdef double *places = reals(held, x, 1, &n)
    made = empty(1, n)
    cdef double *values = numbers(made)
    for i in range(n):
        values[i] = length_up_to(&length, places[i])
    return made


def sizes(patches, double tolerance, double max_order, least):
    """collocation.sizes."""
    cdef Py_ssize_t n, m, of_least
    cdef Sizes lists[2]
    held = []
    cdef double *left = reals(held, patches.left, 1, &n)
    cdef double *right = reals(held, patches.right, 1, &m)
    cdef double *at_least = reals(held, least, 1, &of_least)
    expect(n == m == of_least, "edges and least modes differ")
    nodes, modes = empty(1, n, 0, np.NPY_INT64), empty(1, n, 0, np.NPY_INT64)
    lists_of_sizes(&lists[0], &lists[1])
    expect(sizes_of(lists, n, left, right, -log(tolerance), max_order, at_least, <int64_t *>np.PyArray_DATA(nodes),
                    <int64_t *>np.PyArray_DATA(modes)), "patches that overlap, or too close for any number of modes")
    return nodes, modes


cdef Surface surface_of(list held, profile) except *:
    cdef Surface surface
    cdef Py_ssize_t shape[2]
    surface.table, surface.rows = reals(held, profile._table, 2, shape), shape[0]
    expect(shape[0] > 0 and shape[1] == TERMS, "a Taylor table of 14 terms")
    surface.scale = shape[0] / <double>profile.period
    return surface


def right_hand_sides(profile, patches, double level, resolution):
    """collocation.right_hand_sides."""
    cdef Py_ssize_t n, m, of_nodes, of_modes, most, unknowns
    cdef double energy
    cdef Call call
    held = []
    begin(&call, held)
    cdef Surface surface = surface_of(held, profile)
    cdef double *left = reals(held, patches.left, 1, &n)
    cdef double *right = reals(held, patches.right, 1, &m)
    cdef int64_t *nodes = integers(held, resolution.nodes, &of_nodes)
    cdef int64_t *modes = integers(held, resolution.modes, &of_modes)
    expect(0 < n == m == of_nodes == of_modes, "patches and resolution differ")
    cdef Table *sampling = tables(&call, OF_NODES, nodes, n)
    cdef Table *coupled = tables(&call, OF_MODES, modes, n)
    most = most_nodes(n, sampling, coupled)
    unknowns = coupled[n].start
    series, x, columns, tail = empty(2, n, most), empty(1, unknowns), empty(2, 2, unknowns), empty(2, 2, 2 * n)
    cdef RightHandSides to = RightHandSides(numbers(series), numbers(x), numbers(columns), numbers(tail), &energy)
    c_right_hand_sides(&surface, n, left, right, level, sampling, coupled, most, &to)
    return series, x, columns, tail, energy


def all_charges(modes, series, skeleton):
    """collocation.all_charges: Q_n of every patch."""
    cdef Py_ssize_t patches, n, i
    cdef Py_ssize_t of_series[2]
    cdef Call call
    held = []
    begin(&call, held)
    cdef int64_t *numbers_of_modes = integers(held, modes, &patches)
    cdef double *terms = reals(held, series, 2, of_series)
    cdef double *at_nodes = reals(held, skeleton, 1, &n)
    cdef Table *coupled = tables(&call, OF_MODES, numbers_of_modes, patches)
    for i in range(patches):
        expect(coupled[i].n <= of_series[1], "more modes than terms of the series")
    expect(patches == of_series[0] and coupled[patches].start == n, "charges, series and modes differ")
    made = empty(2, patches, of_series[1])
    charges_of_modes(coupled, patches, of_series[1], terms, at_nodes, numbers(made))
    return made


def stress_intensity_jacobian(state):
    """sensitivities.stress_intensity_jacobian."""
    cdef Py_ssize_t n, of_modes, of_intensity, of_slope
    cdef Py_ssize_t of_compliance[2]
    held = []
    cdef double *half_width = reals(held, state.patches.half_width, 1, &n)
    cdef int64_t *modes = integers(held, state.resolution.modes, &of_modes)
    cdef double *intensity = reals(held, state.stress_intensity, 1, &of_intensity)
    cdef double *compliance = reals(held, state.edge_compliance, 2, of_compliance)
    cdef double *slope = reals(held, state.edge_slope, 1, &of_slope)
    expect(of_modes == n and of_intensity == of_slope == of_compliance[0] == of_compliance[1] == 2 * n,
           "arrays of a state differ in size")
    made = empty(2, 2 * n, 2 * n)
    jacobian_of(n, half_width, modes, intensity, compliance, slope, numbers(made))
    return made


def solved(skeleton, splitting):
    """hierarchical.solved."""
    cdef Py_ssize_t n, patches, of_left, of_right, of_modes, k, edges, i
    cdef Py_ssize_t of_columns[2]
    cdef Py_ssize_t of_addition[2]
    cdef Py_ssize_t of_fields[2]
    cdef double *made[6]
    cdef Call call
    cdef System system
    held, asked_patches, coupling = [], skeleton.patches, skeleton.coupling
    begin(&call, held)
    memset(&system, 0, sizeof(System))
    system.call = &call
    system.x = reals(held, skeleton.x, 1, &n)
    system.n = n
    cdef double *columns = reals(held, skeleton.columns, 2, of_columns)
    system.half_width = reals(held, asked_patches.half_width, 1, &patches)
    system.left = reals(held, asked_patches.left, 1, &of_left)
    system.right = reals(held, asked_patches.right, 1, &of_right)
    cdef int64_t *modes = integers(held, skeleton.modes, &of_modes)
    system.per_patch = skeleton.edge_columns
    expect(system.per_patch in (0, 2, 4), "edge columns: 0, 2 or 4")
    if coupling is not None and coupling.matrix is not None:
        system.addition = reals(held, coupling.matrix, 2, of_addition)
        expect(of_addition[0] == of_addition[1] == n, "addition of another size")
    if coupling is not None and coupling.left_out is not None:
        system.edge_fields = reals(held, coupling.left_out.fields, 2, of_fields)
        expect(of_fields[0] == 2 and of_fields[1] == n, "edge fields of another size")
    system.accuracy, system.largest, system.uniform = splitting.accuracy, splitting.largest, splitting.uniform
    expect(0 < of_modes == patches == of_left == of_right, "patches and modes differ")
    expect(of_columns[0] >= 2 and of_columns[1] == n, "columns and nodes differ")
    system.tables = tables(&call, OF_MODES, modes, patches)
    expect(system.tables[patches].start == n, "modes and nodes differ")
    k = of_columns[0]
    edges = 0 if system.per_patch == 0 else 2 * patches
    parts = (empty(2, edges, edges), empty(2, edges if system.per_patch == 4 else 0, edges), empty(2, k, k),
             empty(2, k, n), empty(2, k, 2 * patches), empty(2, k, 2 * patches))
    for i in range(6):
        made[i] = numbers(parts[i])
    return parts if solved_system(&system, patches, k, columns, made) == SOLVED else None


def near_patches(patches, resolution, charges, skeleton, gap, x):
    """gap.near_patches: the logarithmic part of the two patches beside a gap less that of their skeletons."""
    cdef Py_ssize_t count, of_width, n_modes, n_nodes, of_skeleton, n_gap, n, i
    cdef Py_ssize_t of_charges[2]
    cdef Call call
    held = []
    begin(&call, held)
    cdef double *center = reals(held, patches.center, 1, &count)
    cdef double *half_width = reals(held, patches.half_width, 1, &of_width)
    cdef int64_t *modes = integers(held, resolution.modes, &n_modes)
    cdef int64_t *nodes = integers(held, resolution.nodes, &n_nodes)
    cdef double *all_of_them = reals(held, charges, 2, of_charges)
    cdef double *at_nodes = reals(held, skeleton, 1, &of_skeleton)
    cdef int64_t *gaps = integers(held, gap, &n_gap)
    cdef double *places = reals(held, x, 1, &n)
    expect(of_width == n_modes == n_nodes == of_charges[0] == count and n_gap == n,
           "arrays of the patches differ in size")
    cdef Table *coupled = tables(&call, OF_MODES, modes, count)
    expect(coupled[count].start == of_skeleton, "charges and modes differ")
    for i in range(count):
        expect(0 < nodes[i] <= of_charges[1], "more terms than there are")
    for i in range(n):
        expect(0 <= gaps[i] < count, "no such gap")
    made = empty(1, n)
    memset(numbers(made), 0, <size_t>n * sizeof(double))
    add_near_patches(count, center, half_width, nodes, coupled, of_charges[1], all_of_them, at_nodes, n, gaps, places,
                     numbers(made))
    return made


def low_points(patches, profile, grids, samples, highest, double level):
    """gap.low_points."""
    cdef Py_ssize_t count, of_width, n_sizes, n_counts, n_samples, n_highest, total = 0, places = 0, n, i
    held = []
    cdef Surface surface = surface_of(held, profile)
    cdef double *right = reals(held, patches.right, 1, &count)
    cdef double *width = reals(held, patches.gap_after, 1, &of_width)
    cdef int64_t *of_grids = integers(held, grids[0], &n_sizes)
    cdef int64_t *counts = integers(held, grids[1], &n_counts)
    cdef double *u = reals(held, samples, 1, &n_samples)
    cdef double *bounds = reals(held, highest, 1, &n_highest)
    expect(of_width == n_sizes == n_counts == count and n_highest > 0, "gaps, grids or bounds differ")
    for i in range(count):
        expect(of_grids[i] > 0 and counts[i] > 0, "a grid without points")
        total += counts[i]
        places += of_grids[i] // 2
    expect(total == n_samples, "samples and their numbers differ")
    found = empty(2, places, 4)
    n = c_low_points(count, right, width, of_grids, counts, u, surface.rows, surface.table, n_highest, bounds, level,
                     numbers(found))
    return copied(numbers(found), 2, n, 4)


def pair_by_pair(points, sources, charge):
    """logarithmic_potential.pair_by_pair."""
    cdef Py_ssize_t of_points[2]
    cdef Py_ssize_t of_sources[2]
    cdef Py_ssize_t m
    held = []
    cdef double *at = reals(held, points, 2, of_points)
    cdef double *sources_at = reals(held, sources, 2, of_sources)
    cdef double *charges = reals(held, charge, 1, &m)
    expect(of_points[0] == of_sources[0] == 2 and of_sources[1] == m, "points and charges differ")
    made = empty(1, of_points[1])
    pairs_potential(of_points[1], at, m, sources_at, charges, numbers(made))
    return made


def box_moments(position, charge, Py_ssize_t boxes):
    """logarithmic_potential.box_moments."""
    cdef Py_ssize_t n, of_charge
    held = []
    cdef double *places = reals(held, position, 1, &n)
    cdef double *charges = reals(held, charge, 1, &of_charge)
    expect(n == of_charge and boxes > 0 and boxes & (boxes - 1) == 0, "charges, or boxes, do not fit")
    made = empty(2, boxes, BOX_TERMS)
    moments_of_boxes(n, places, charges, boxes, numbers(made))
    return made


def box_potential(x, points, position, sources, charge, series):
    """logarithmic_potential.box_potential."""
    cdef Py_ssize_t n, m, of_charge, boxes
    cdef Py_ssize_t of_points[2]
    cdef Py_ssize_t of_sources[2]
    cdef Py_ssize_t of_series[2]
    held = []
    cdef double *places = reals(held, x, 1, &n)
    cdef double *at = reals(held, points, 2, of_points)
    cdef double *positions = reals(held, position, 1, &m)
    cdef double *sources_at = reals(held, sources, 2, of_sources)
    cdef double *charges = reals(held, charge, 1, &of_charge)
    cdef double *in_boxes = reals(held, series, 2, of_series)
    boxes = of_series[0]
    expect(of_points[0] == of_sources[0] == 2 and of_points[1] == n and of_sources[1] == of_charge == m,
           "points and charges differ")
    expect(boxes > 2 and boxes & (boxes - 1) == 0 and of_series[1] == BOX_TERMS, "boxes do not fit")
    made = empty(1, n)
    boxes_potential(n, places, at, m, positions, sources_at, charges, boxes, in_boxes, numbers(made))
    return made
