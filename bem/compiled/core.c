/* The module linecontact_kernels: kernels that stand beside functions of the same names in NumPy, and say the same.

   Which function each mirrors stands above it; the equations and their sources are there.  BLAS and LAPACK are those
   of scipy.linalg.cython_blas and cython_lapack, whose functions are looked up when the module is imported: an
   ImportError where one is not there or has other arguments. */

#include "core.h"
#include "kernels.h"

#define INTERFACE "5" /* kernels.INTERFACE */

Blas blas;
static PyObject *numpy_empty;

int enter(Call *call, Size n_given, Size n_wanted)
{
    call->n_views = call->n_objects = call->failed = 0;
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

PyObject *attribute(Call *call, PyObject *object, const char *name)
{
    PyObject *found;
    if (call->failed)
        return Py_None;
    found = call->n_objects < MOST_HELD ? PyObject_GetAttrString(object, name) : NULL;
    if (found == NULL) {
        call->failed = 1;
        return Py_None;
    }
    return call->objects[call->n_objects++] = found;
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

PyObject *new_reals(Call *call, int dimensions, Size n, Size m, double **data)
{
    PyObject *array = NULL;
    Py_buffer *found;
    if (!call->failed)
        array = dimensions == 1 ? PyObject_CallFunction(numpy_empty, "n", n)
                                : PyObject_CallFunction(numpy_empty, "((nn))", n, m);
    if (array == NULL) {
        call->failed = 1;
        return NULL;
    }
    found = view(call, array, PyBUF_C_CONTIGUOUS | PyBUF_WRITABLE);
    if (found == NULL) {
        Py_DECREF(array);
        return NULL;
    }
    *data = (double *)found->buf;
    return array;
}

double *workspace(Size n)
{
    double *memory = PyMem_Malloc((n > 0 ? (size_t)n : 1) * sizeof(double));
    if (memory == NULL)
        PyErr_NoMemory();
    return memory;
}

Table *tables_of(Call *call, PyObject *tuple)
{
    Table *tables;
    Size i, shape[1], size;
    expect(call, PyTuple_Check(tuple), "tables: not a tuple");
    if (call->failed)
        return NULL;
    size = PyTuple_GET_SIZE(tuple);
    tables = PyMem_Malloc((size_t)(size + 1) * sizeof(Table));
    if (tables == NULL) {
        PyErr_NoMemory();
        call->failed = 1;
        return NULL;
    }
    for (i = 0; i < size; i++) {
        double *at = reals(call, PyTuple_GET_ITEM(tuple, i), 1, shape);
        Size n = call->failed || shape[0] == 0 ? 0 : (Size)at[0];
        expect(call, n > 0 && shape[0] == 1 + 5 * n + 2 * n * n, "tables: not as chebyshev.basis packs them");
        if (call->failed)
            break;
        tables[i].n = n;
        tables[i].nodes = at + 1;
        tables[i].at_edges = at + 1 + n;
        tables[i].slopes = at + 1 + 3 * n;
        tables[i].values = at + 1 + 5 * n;
        tables[i].moments = tables[i].values + n * n;
    }
    if (call->failed) {
        PyMem_Free(tables);
        return NULL;
    }
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
    KERNEL(sampled_series),
    KERNEL(skeleton_columns),
    KERNEL(solved),
    KERNEL(stress_intensity_jacobian),
    KERNEL(all_charges),
    KERNEL(slopes_at_edges),
    KERNEL(uncoupled),
    KERNEL(integral),
    KERNEL(box_moments),
    KERNEL(box_potential),
    KERNEL(low_points),
    KERNEL(near_patches),
    KERNEL(pair_by_pair),
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
