/* What the kernels share.  BLAS and LAPACK, and what is asked of Python, stand in linecontact_kernels.pyx. */

#include "hierarchical.h"

Blas blas;
Asked asked;

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
    for (; known < table; known++)
        if (known->n == n)
            return known;
    if (n <= 0 || call->n_tables[packing] == MOST_SIZES) {
        PyErr_SetString(PyExc_ValueError, "patches of more sizes than there is room for");
        return NULL;
    }
    if (asked.table(call->held, packing, n, table) < 0)
        return NULL;
    call->n_tables[packing]++;
    return table;
}

int tables_of(Call *call, Packing packing, const int64_t *sizes, Size count, Table *tables)
{
    Size i, start = 0;
    for (i = 0; i < count; i++) {
        const Table *found = table_of(call, packing, (Size)sizes[i]);
        if (found == NULL)
            return 0;
        tables[i] = *found;
        tables[i].start = start;
        start += found->n;
    }
    tables[count].start = start;
    return 1;
}
