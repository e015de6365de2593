/* The kernel between two arcs as a short sum of products: separated_kernel.py. */

#include "hierarchical.h"

#define RANGE_STEP 1.15   /* separated_kernel.RANGE_STEP */
#define CLOSE_TO_END 0.05 /* sine below which a difference of products has lost digits */

/* The tables of a half range, asked of Python once a call. */
static const Range *range_of(System *system, Size steps)
{
    Range *range = system->ranges, *last = range + system->n_ranges;
    for (; range < last; range++)
        if (range->steps == steps)
            return range;
    if (system->n_ranges == MOST_RANGES) {
        PyErr_SetString(PyExc_ValueError, "clusters of more sizes than there is room for");
        return NULL;
    }
    if (asked.range(system->call->held, steps, system->accuracy, range) < 0)
        return NULL;
    range->steps = steps;
    system->n_ranges++;
    return range;
}

/* sin((x - end)/2) of nodes, where it is small from the difference itself. */
static void sines(Size n, const double *x, const double *sine, const double *cosine, double end, double *values)
{
    double s = sin(end / 2), c = cos(end / 2);
    Size i;
    for (i = 0; i < n; i++)
        values[i] = sine[i] * c - cosine[i] * s;
    for (i = 0; i < n; i++)
        if (fabs(values[i]) < CLOSE_TO_END)
            values[i] = sin((x[i] - end) / 2);
}

/* u and m from these sines, in their place. */
VECTORISED static void coordinates(Size n, double constant, double *RESTRICT u, double *RESTRICT m)
{
    Size i;
    for (i = 0; i < n; i++) {
        double from_beta = log_of_size(u[i]), from_delta = log_of_size(m[i]);
        u[i] = from_beta - from_delta;
        m[i] = (from_beta + from_delta + constant) / 2;
    }
}

/* T_0 to T_(count - 1), (n, count): real parts of the powers of exp(i arccos t); `work` has room for 2 n numbers. */
VECTORISED static void chebyshev(Size n, Size count, const double *RESTRICT t, double *RESTRICT values,
                                 double *RESTRICT work)
{
    Size i, k;
    double *sine = work, *imaginary = work + n;
    for (i = 0; i < n; i++) {
        double square = 1 - t[i] * t[i];
        sine[i] = sqrt(square > 0 ? square : 0.0);
        imaginary[i] = 0.0;
        values[i] = 1.0;
    }
    for (k = 1; k < count; k++)
        for (i = 0; i < n; i++) {
            double real = values[(k - 1) * n + i];
            values[k * n + i] = t[i] * real - sine[i] * imaginary[i];
            imaginary[i] = sine[i] * real + t[i] * imaginary[i];
        }
}

/* The phi_k at n places, the even ones of polynomials of even degree, the others of odd ones. */
static void series(const Range *range, Size n, const double *polynomials, double *values)
{
    Size functions = range->q - 2, even = range->even;
    product('N', 'T', n, even, (range->count + 1) / 2, 1.0, polynomials, 2 * n, range->modes, 2 * functions, 0.0,
            values, n);
    product('N', 'T', n, functions - even, range->count / 2, 1.0, polynomials + n, 2 * n,
            range->modes + functions + even, 2 * functions, 0.0, values + even * n, n);
}

const Range *widened(System *system, Size first, Size middle, Size last, Columns *added)
{
    Size start = system->tables[first].start, n = system->tables[last].start - start, steps, i;
    const double *x = system->x + start, *sine = system->half + start, *cosine = sine + system->n;
    double behind = fmod(system->left[first] - system->right[last - 1], 2 * PI), low = HUGE_VAL, high = -HUGE_VAL;
    double beta = system->right[middle - 1] + (system->left[middle] - system->right[middle - 1]) / 2;
    double delta = system->right[last - 1] + (behind < 0 ? behind + 2 * PI : behind) / 2, unit;
    double *u = workspace(4 * n), *m, *polynomials = NULL;
    const Range *range = NULL;
    if (u == NULL)
        return NULL;
    m = u + n;
    sines(n, x, sine, cosine, beta, u);
    sines(n, x, sine, cosine, delta, m);
    coordinates(n, log(2.0) - log(fabs(sin((delta - beta) / 2))), u, m);
    for (i = 0; i < n; i++) {
        low = u[i] < low ? u[i] : low;
        high = u[i] > high ? u[i] : high;
    }
    steps = (Size)ceil(log((high - low) / 2) / log(RANGE_STEP));
    unit = pow(RANGE_STEP, (double)steps);
    range = range_of(system, steps);
    if (range != NULL && (polynomials = workspace(n * range->count)) != NULL) {
        double *values = workspace(n * range->q);
        for (i = 0; i < n; i++)
            u[i] = (u[i] - (low + high) / 2) / unit;
        chebyshev(n, range->count, u, polynomials, u + 2 * n);
        if (values != NULL) {
            memcpy(values, m, (size_t)n * sizeof(double));
            for (i = 0; i < n; i++)
                values[n + i] = 1.0;
            series(range, n, polynomials, values + 2 * n);
        }
        added->values = values;
        added->first = start;
        added->ld = n;
        added->count = range->q;
        added->shared = added->above->shared + range->q;
    }
    PyMem_Free(polynomials);
    PyMem_Free(u);
    return range;
}
