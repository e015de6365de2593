"""Arrays from Python and for it.  What a kernel reads is held by a list until it returns: attributes may be arrays that
nobody else keeps."""

cimport numpy as np
from libc.string cimport memcpy

from sys import modules

cdef void *opened(list held, object array, int kind, int dimensions, Py_ssize_t *shape) except? NULL:
    cdef int i
    if not (np.PyArray_Check(array) and np.PyArray_EquivTypenums(np.PyArray_TYPE(array), kind)
            and np.PyArray_NDIM(array) == dimensions and np.PyArray_ISCARRAY_RO(array)):
        raise TypeError("not an array of float64, or of int64, as expected")
    for i in range(dimensions):
        shape[i] = np.PyArray_DIM(array, i)
    held.append(array)
    return np.PyArray_DATA(array)


cdef double *reals(list held, object array, int dimensions, Py_ssize_t *shape) except? NULL:
    return <double *>opened(held, array, np.NPY_DOUBLE, dimensions, shape)


cdef int64_t *integers(list held, object array, Py_ssize_t *size) except? NULL:
    return <int64_t *>opened(held, array, np.NPY_INT64, 1, size)


cdef int expect(bint holds, str what) except -1:
    if not holds:
        raise ValueError(what)
    return 0


cdef object empty(int dimensions, Py_ssize_t n, Py_ssize_t m=0, int kind=np.NPY_DOUBLE):
    cdef np.npy_intp shape[2]
    shape[0], shape[1] = n, m
    return np.PyArray_EMPTY(dimensions, shape, kind, 0)


cdef inline double *numbers(object array):
    return <double *>np.PyArray_DATA(array)


cdef object copied(const void *values, int dimensions, Py_ssize_t n, Py_ssize_t m=1, int kind=np.NPY_DOUBLE):
    array = empty(dimensions, n, m, kind)
    memcpy(np.PyArray_DATA(array), values, <size_t>(8 * n * m))
    return array


# What the kernels ask of Python.

cdef void begin(Call *call, list held) noexcept:
    call.held = <void *>held
    call.n_tables[0] = call.n_tables[1] = 0


cdef int table_of(object held, Packing packing, Py_ssize_t n, Table *table) except -1:
    cdef Py_ssize_t size
    chebyshev = modules["bem.geometry.chebyshev"]
    found = chebyshev.packed_basis(n) if packing == OF_MODES else chebyshev.packed_nodes(n)
    cdef double *nodes = reals(held, found, 1, &size)
    expect(size == 5 * n + 2 * n * n if packing == OF_MODES else size in (n, n + n * n),
           "tables: not as chebyshev packs them")
    table.n, table.nodes, table.transform = n, nodes, NULL if size == n else nodes + n
    table.at_edges, table.slopes, table.values = nodes + n, nodes + 3 * n, nodes + 5 * n
    table.moments = table.values + n * n
    return 0


cdef int range_of(object held, Py_ssize_t steps, double accuracy, Range *found) except -1:
    cdef Py_ssize_t shape[2]
    cdef Py_ssize_t of_core[2]
    modes, even, core = modules["bem.elastic.separated_kernel"].modes_and_core(steps, accuracy)
    found.modes, found.core, found.even = reals(held, modes, 2, shape), reals(held, core, 2, of_core), even
    expect(shape[0] > 1 and 0 <= found.even <= shape[1], "functions and modes differ")
    expect(of_core[0] == of_core[1] == shape[1] + 2, "core of another size")
    found.count, found.q = shape[0], of_core[0]
    return 0


cdef int coefficients_of(Py_ssize_t n, double *samples) except -1:
    cdef Py_ssize_t size
    held = []
    series = modules["bem.geometry.chebyshev"].coefficients(copied(samples, 1, n))
    cdef double *found = reals(held, series, 1, &size)
    expect(size == n, "coefficients of another number")
    memcpy(samples, found, <size_t>n * sizeof(double))
    return 0


cdef Table *tables(Call *call, Packing packing, const int64_t *sizes, Py_ssize_t count) except NULL:
    memory = empty(1, (count + 1) * <Py_ssize_t>sizeof(Table), 0, np.NPY_UINT8)
    (<list>call.held).append(memory)
    tables_of(call, packing, sizes, count, <Table *>np.PyArray_DATA(memory))
    return <Table *>np.PyArray_DATA(memory)
