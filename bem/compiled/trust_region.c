/* The minimiser of a quadratic model in a ball: trust_region.py. */

#include "descent.h"


/* A model, and where steps are made: matrix (n, n), half of the step (n,). */
typedef struct {
    Size n;
    const double *gradient, *hessian;
    double *matrix, *half;
} Model;

static double dot(Size n, const double *a, const double *b)
{
    double sum = 0.0;
    Size i;
    for (i = 0; i < n; i++)
        sum += a[i] * b[i];
    return sum;
}

/* trust_region._shifted; 0 where H + shift is not positive definite. */
static int shifted(const Model *model, double shift, double *step, double *bend)
{
    Size n = model->n, i;
    int order = (int)n, info;
    char lower = 'L';
    memcpy(model->matrix, model->hessian, (size_t)(n * n) * sizeof(double));
    for (i = 0; i < n; i++) {
        model->matrix[i * (n + 1)] += shift;
        step[i] = -model->gradient[i];
    }
    blas.dpotrf(&lower, &order, model->matrix, &order, &info);
    if (info != 0)
        return 0;
    solve_lower('L', 'N', n, 1, model->matrix, n, step, n);
    solve_lower('L', 'T', n, 1, model->matrix, n, step, n);
    memcpy(model->half, step, (size_t)n * sizeof(double));
    solve_lower('L', 'N', n, 1, model->matrix, n, model->half, n);
    *bend = dot(n, model->half, model->half);
    return 1;
}

/* trust_region._on_surface, into `step`. */
static void on_surface(const Model *model, double radius, double low, double start, double *step)
{
    Size n = model->n, i, j;
    double resolved = 0.0, high = low + sqrt(dot(n, model->gradient, model->gradient)) / radius, bend;
    double shift = start > low + 1e-3 * (high - low) ? start : low + 1e-3 * (high - low), *trial = model->half + n;
    for (i = 0; i < n; i++) {
        double sum = 0.0;
        for (j = 0; j < n; j++)
            sum += fabs(model->hessian[i * n + j]);
        resolved = sum > resolved ? sum : resolved;
        step[i] = 0.0;
    }
    resolved *= 1e-15;
    while (high - low > (1e-10 * high > resolved ? 1e-10 * high : resolved)) {
        double square, excess, newton;
        if (!shifted(model, shift, trial, &bend)) {
            low = shift;
            shift = (shift + high) / 2;
            continue;
        }
        memcpy(step, trial, (size_t)n * sizeof(double));
        square = dot(n, step, step);
        excess = sqrt(square) / radius - 1;
        if (fabs(excess) <= 1e-10)
            return;
        if (excess > 0)
            low = shift;
        else
            high = shift;
        newton = shift + excess * square / bend;
        shift = low < newton && newton < high ? newton : (low + high) / 2;
    }
    if (shifted(model, high, trial, &bend))
        memcpy(step, trial, (size_t)n * sizeof(double));
}

/* The lowest eigenvalue of the Hessian with its mode, lowest_modes.lowest_modes; 0 with an exception. */
static int lowest_mode(const Model *model, double *value, double *mode)
{
    Size n = model->n, size = 26 * n;
    int order = (int)n, one = 1, found, info, of_work = (int)size, of_whole = (int)(10 * n);
    double none = 0.0, *work = workspace(size + n);
    int *whole = (int *)workspace(6 * n), *support = whole + 10 * n;
    char modes = 'V', by_index = 'I', lower = 'L';
    if (work != NULL && whole != NULL) {
        memcpy(model->matrix, model->hessian, (size_t)(n * n) * sizeof(double));
        blas.dsyevr(&modes, &by_index, &lower, &order, model->matrix, &order, &none, &none, &one, &one, &none, &found,
                    work + size, mode, &order, support, work, &of_work, whole, &of_whole, &info);
        *value = work[size];
        if (info != 0)
            PyErr_Format(PyExc_ArithmeticError, "eigenvalues of %zd edges do not converge: dsyevr says %d", n, info);
    }
    info = work == NULL || whole == NULL || info != 0;
    PyMem_Free(work);
    PyMem_Free(whole);
    return !info;
}

int trust_region_step(Size n, const double *gradient, const double *hessian, double radius, double *step)
{
    double *memory = workspace(n * n + 3 * n), bend, size, value, *mode, along, missing;
    Model model = {n, gradient, hessian, memory, memory + n * n};
    Size i, top = 0;
    if (memory == NULL)
        return 0;
    mode = model.half + 2 * n;
    if (shifted(&model, 0.0, step, &bend)) {
        size = sqrt(dot(n, step, step));
        if (size > radius)
            on_surface(&model, radius, 0.0, (size / radius - 1) * size * size / bend, step);
    } else if (!lowest_mode(&model, &value, mode)) {
        PyMem_Free(memory);
        return 0;
    } else {
        double low = value < 0 ? -value : 0.0;
        on_surface(&model, radius, low, low + fabs(dot(n, mode, gradient)) / radius, step);
        missing = radius * radius - dot(n, step, step);
        if (value < 0 && missing > 0) {
            for (i = 1; i < n; i++)
                top = fabs(mode[i]) > fabs(mode[top]) ? i : top;
            along = dot(n, step, mode);
            size = copysign(sqrt(along * along + missing), along != 0 ? along : mode[top]) - along;
            for (i = 0; i < n; i++)
                step[i] += size * mode[i];
        }
    }
    PyMem_Free(memory);
    return 1;
}
