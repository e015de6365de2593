/* The module linecontact_kernels: kernels that stand beside functions of the same names in NumPy, and say the same.

   Which function each mirrors stands above it; the equations and their sources are there.  BLAS and LAPACK are those
   of scipy.linalg.cython_blas and cython_lapack, whose functions are looked up when the module is imported: an
   ImportError where one is not there or has other arguments. */

#include "core.h"
#include "kernels.h"

#define INTERFACE "7" /* kernels.INTERFACE */

Blas blas;
static PyObject *numpy_empty;

int enter(Call *call, Size n_given, Size n_wanted)
{
    call->n_views = call->n_objects = call->failed = call->n_tables[OF_NODES] = call->n_tables[OF_MODES] = 0;
    if (n_given != n_wanted)
        PyErr_Format(PyExc_TypeError, "%zd arguments, not %zd", n_given, n_wanted);
    return n_given == n_wanted;
}

void leave(Call *call)
{
    while (call->n_views > 0)
        PyBuffer_Release(&call->views[--call->n_views]);
    while (call->n_objects > 0)
        Py_DECREF(call->objects[--call->n_objects]);
}

static Py_buffer *view(Call *call, PyObject *array, int flags)
{
    if (call->failed)
        return NULL;
    if (call->n_views == MOST_HELD)
        PyErr_SetString(PyExc_ValueError, "more arrays than a kernel takes");
    if (call->n_views == MOST_HELD || PyObject_GetBuffer(array, &call->views[call->n_views], flags) < 0) {
        call->failed = 1;
        return NULL;
    }
    return &call->views[call->n_views++];
}

void expect(Call *call, int holds, const char *what)
{
    if (!call->failed && !holds) {
        PyErr_SetString(PyExc_ValueError, what);
        call->failed = 1;
    }
}

PyObject *held(Call *call, PyObject *object)
{
    if (object != NULL && call->n_objects < MOST_HELD)
        return call->objects[call->n_objects++] = object;
    expect(call, object == NULL, "more objects than a kernel takes");
    call->failed = 1;
    Py_XDECREF(object);
    return Py_None;
}

PyObject *attribute(Call *call, PyObject *object, const char *name)
{
    return call->failed ? Py_None : held(call, PyObject_GetAttrString(object, name));
}

double *reals(Call *call, PyObject *array, int dimensions, Size *shape)
{
    Py_buffer *found = view(call, array, PyBUF_C_CONTIGUOUS | PyBUF_FORMAT);
    int i;
    if (found == NULL) {
        for (i = 0; i < dimensions; i++)
            shape[i] = 0;
        return NULL;
    }
    expect(call, found->ndim == dimensions && strcmp(found->format, "d") == 0, "not an array of float64 as expected");
    for (i = 0; i < dimensions; i++)
        shape[i] = call->failed ? 0 : found->shape[i];
    return (double *)found->buf;
}

int64_t *integers(Call *call, PyObject *array, Size *size)
{
    Py_buffer *found = view(call, array, PyBUF_C_CONTIGUOUS | PyBUF_FORMAT);
    *size = 0;
    if (found == NULL)
        return NULL;
    expect(call, found->ndim == 1 && found->itemsize == 8 && strchr("lq", found->format[0]) != NULL,
           "not an array (n,) of int64 as expected");
    if (!call->failed)
        *size = found->shape[0];
    return (int64_t *)found->buf;
}

double number(Call *call, PyObject *object)
{
    double value = call->failed ? 0.0 : PyFloat_AsDouble(object);
    if (!call->failed && value == -1.0 && PyErr_Occurred())
        call->failed = 1;
    return value;
}

Size count(Call *call, PyObject *object)
{
    Size value = call->failed ? 0 : PyNumber_AsSsize_t(object, PyExc_OverflowError);
    if (!call->failed && value == -1 && PyErr_Occurred())
        call->failed = 1;
    return value;
}

int truth(Call *call, PyObject *object)
{
    int value = call->failed ? 0 : PyObject_IsTrue(object);
    if (value < 0)
        call->failed = 1;
    return value > 0;
}

/* An array that was made, and where its numbers are. */
static PyObject *opened(Call *call, PyObject *array, void **data)
{
    Py_buffer *found = array != NULL ? view(call, array, PyBUF_C_CONTIGUOUS | PyBUF_WRITABLE) : NULL;
    if (found == NULL) {
        call->failed = 1;
        Py_CLEAR(array);
    } else
        *data = found->buf;
    return array;
}

PyObject *new_reals(Call *call, int dimensions, Size n, Size m, double **data)
{
    return opened(call,
                  call->failed        ? NULL
                  : dimensions == 1 ? PyObject_CallFunction(numpy_empty, "n", n)
                                    : PyObject_CallFunction(numpy_empty, "((nn))", n, m),
                  (void **)data);
}

PyObject *new_integers(Call *call, Size n, int64_t **data)
{
    return opened(call, call->failed ? NULL : PyObject_CallFunction(numpy_empty, "ns", n, "i8"), (void **)data);
}

double *workspace(Size n)
{
    double *memory = PyMem_Malloc((n > 0 ? (size_t)n : 1) * sizeof(double));
    if (memory == NULL)
        PyErr_NoMemory();
    return memory;
}

/* The tables of a size, asked of Python once a call. */
static const Table *table_of(Call *call, Packing packing, Size n)
{
    Table *known = call->tables[packing], *table = known + call->n_tables[packing];
    PyObject *module, *found;
    Size shape[1];
    for (; known < table; known++)
        if (known->n == n)
            return known;
    expect(call, n > 0 && call->n_tables[packing] < MOST_SIZES, "patches of more sizes than there is room for");
    module = call->failed ? NULL : PyImport_ImportModule("bem.geometry.chebyshev");
    if (module == NULL)
        call->failed = 1;
    found = module == NULL ? NULL
                           : PyObject_CallMethod(module, packing == OF_MODES ? "packed_basis" : "packed_nodes", "n", n);
    Py_XDECREF(module);
    table->nodes = reals(call, held(call, found), 1, shape);
    expect(call, packing == OF_MODES ? shape[0] == 5 * n + 2 * n * n : shape[0] == n || shape[0] == n + n * n,
           "tables: not as chebyshev packs them");
    table->n = n;
    table->transform = shape[0] == n ? NULL : table->nodes + n;
    table->at_edges = table->nodes + n;
    table->slopes = table->nodes + 3 * n;
    table->values = table->nodes + 5 * n;
    table->moments = table->values + n * n;
    call->n_tables[packing] += !call->failed;
    return table;
}

Table *tables_of(Call *call, Packing packing, const int64_t *sizes, Size count)
{
    Table *tables = call->failed ? NULL : PyMem_Malloc((size_t)(count + 1) * sizeof(Table));
    Size i, start = 0;
    if (!call->failed && tables == NULL) {
        PyErr_NoMemory();
        call->failed = 1;
    }
    for (i = 0; !call->failed && i < count; i++) {
        tables[i] = *table_of(call, packing, (Size)sizes[i]);
        tables[i].start = start;
        start += tables[i].n;
    }
    if (call->failed) {
        PyMem_Free(tables);
        return NULL;
    }
    tables[count].start = start;
    return tables;
}

/* A function of SciPy by its name, if its arguments are these; `d` is what the names of its type contain for double. */
static int look_up(PyObject *capsules, const char *name, const char *arguments, void **function)
{
    PyObject *capsule = PyDict_GetItemString(capsules, name);
    const char *said = capsule != NULL ? PyCapsule_GetName(capsule) : NULL, *at = said, *wanted = arguments;
    if (said != NULL && strncmp(at, "void (", 6) == 0) {
        for (at += 6; *wanted != '\0'; wanted++) {
            const char *end = strchr(at, '*');
            if (end == NULL || end[-1] != ' ')
                break;
            if (*wanted == 'd' ? end - at < 3 || strncmp(end - 3, "_d ", 3) != 0
                               : strncmp(at, *wanted == 'c' ? "char *" : "int *", *wanted == 'c' ? 6 : 5) != 0)
                break;
            at = end + 1 + (end[1] == ',' ? 2 : 0);
        }
        if (*wanted == '\0' && strcmp(at, ")") == 0) {
            *function = PyCapsule_GetPointer(capsule, said);
            return *function == NULL ? -1 : 0;
        }
    }
    PyErr_Format(PyExc_ImportError, "%s of SciPy is not as expected: %s", name, said != NULL ? said : "not there");
    return -1;
}

static int look_up_all(void)
{
    const struct {
        const char *module, *name, *arguments;
        void **function;
    } wanted[] = {
        {"scipy.linalg.cython_blas", "dgemm", "cciiiddididdi", (void **)&blas.dgemm},
        {"scipy.linalg.cython_blas", "dgemv", "ciiddididdi", (void **)&blas.dgemv},
        {"scipy.linalg.cython_blas", "dsyrk", "cciiddiddi", (void **)&blas.dsyrk},
        {"scipy.linalg.cython_blas", "dtrsm", "cccciiddidi", (void **)&blas.dtrsm},
        {"scipy.linalg.cython_lapack", "dpotrf", "cidii", (void **)&blas.dpotrf},
        {"scipy.linalg.cython_lapack", "dpstrf", "cidiiiddi", (void **)&blas.dpstrf},
        {"scipy.linalg.cython_lapack", "dsyevr", "cccididdiididdiidiiii", (void **)&blas.dsyevr},
    };
    size_t i;
    for (i = 0; i < sizeof wanted / sizeof wanted[0]; i++) {
        PyObject *module = PyImport_ImportModule(wanted[i].module);
        PyObject *capsules = module != NULL ? PyObject_GetAttrString(module, "__pyx_capi__") : NULL;
        int found = capsules != NULL && PyDict_Check(capsules)
                        ? look_up(capsules, wanted[i].name, wanted[i].arguments, wanted[i].function)
                        : -1;
        Py_XDECREF(capsules);
        Py_XDECREF(module);
        if (found < 0)
            return -1;
    }
    return 0;
}

#define KERNEL(name) {#name, (PyCFunction)(void (*)(void))kernel_##name, METH_FASTCALL, NULL}

static PyMethodDef methods[] = {
    KERNEL(taylor),
    KERNEL(sizes),
    KERNEL(right_hand_sides),
    KERNEL(solved),
    KERNEL(stress_intensity_jacobian),
    KERNEL(all_charges),
    KERNEL(integral),
    KERNEL(box_moments),
    KERNEL(box_potential),
    KERNEL(low_points),
    KERNEL(near_patches),
    KERNEL(pair_by_pair),
    KERNEL(strides),
    {NULL, NULL, 0, NULL},
};

static struct PyModuleDef module = {
    PyModuleDef_HEAD_INIT, "linecontact_kernels", "The kernels of linecontact in C: see bem/compiled/kernels.py.", -1, methods, NULL, NULL, NULL, NULL,
};

PyMODINIT_FUNC PyInit_linecontact_kernels(void)
{
    PyObject *made, *numpy = PyImport_ImportModule("numpy");
    if (numpy == NULL)
        return NULL;
    numpy_empty = PyObject_GetAttrString(numpy, "empty");
    Py_DECREF(numpy);
    if (numpy_empty == NULL || look_up_all() < 0)
        return NULL;
    made = PyModule_Create(&module);
    if (made != NULL && PyModule_AddStringConstant(made, "INTERFACE", INTERFACE) < 0)
        Py_CLEAR(made);
    return made;
}
