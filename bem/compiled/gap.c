/* What the gap search evaluates: gap.py. */

#include "kernels.h"

#define NEGLIGIBLE (-39.0) /* gap.NEGLIGIBLE */
#define SINE_TERMS 11      /* of its series up to pi/2: (pi/2)^23 / 23! = 1e-18 */
#define WHOLE 128          /* gap.WHOLE */
#define STRETCH 8          /* gap.STRETCH */
#define ENDS 32            /* gap.ENDS */
#define LONGER 512         /* gap.LONGER */

/* What one patch adds at LANES points beside it, t half widths from its center: -pi times its series, by Horner's rule
   in zeta with all terms that the point nearest to it sees, less the potential of its skeleton. */
VECTORISED static void beside_patch(const double *RESTRICT t, Size terms, const double *RESTRICT charges, Size n,
                                    const double *RESTRICT places, const double *RESTRICT skeleton,
                                    double *RESTRICT values)
{
    double zeta[LANES], sum[LANES] = {0}, coarse[LANES] = {0}, nearest = 0.0, most;
    Size i, k;
    for (k = 0; k < LANES; k++) {
        double outside = fabs(t[k]) < 1 ? copysign(1.0, t[k]) : t[k];
        zeta[k] = 1 / (outside + copysign(sqrt((outside - 1) * (outside + 1)), outside));
        nearest = fabs(zeta[k]) > nearest ? fabs(zeta[k]) : nearest;
    }
    most = NEGLIGIBLE / log(nearest - 1e-16);
    for (i = most < (double)(terms - 1) ? (Size)ceil(most) : terms - 1; i > 0; i--) {
        double term = charges[i] / (double)i;
        for (k = 0; k < LANES; k++)
            sum[k] = (sum[k] + term) * zeta[k];
    }
    for (i = 0; i < n; i++)
        for (k = 0; k < LANES; k++)
            coarse[k] += skeleton[i] * log_of_size(t[k] - places[i]);
    for (k = 0; k < LANES; k++)
        values[k] = -PI * (log_of_size(2 * zeta[k]) * charges[0] + sum[k]) - coarse[k];
}

void add_near_patches(Size patches, const double *center, const double *half_width, const int64_t *nodes,
                      const Table *tables, Size terms, const double *charges, const double *skeleton, Size n,
                      const int64_t *gap, const double *x, double *values)
{
    Size side, i, k, next;
    for (side = 0; side < 2; side++)
        for (i = 0; i < n; i = next) {
            Size which = ((Size)gap[i] + side) % patches;
            double turn = side == 1 && which <= gap[i] ? 2 * PI : 0.0, t[LANES], beside[LANES];
            for (next = i; next < n && next < i + LANES && gap[next] == gap[i]; next++)
                t[next - i] = (x[next] - turn - center[which]) / half_width[which];
            for (k = next - i; k < LANES; k++)
                t[k] = t[0];
            beside_patch(t, (Size)nodes[which], charges + which * terms, tables[which].n, tables[which].nodes,
                         skeleton + tables[which].start, beside);
            for (k = i; k < next; k++)
                values[k] += beside[k - i];
        }
}

/* The grid in one gap, and u there: a Chebyshev series in t = 1 - 2 theta / pi. */
typedef struct {
    double right, width, *series;
    Size terms, size;
} Grid;

/* Chebyshev series of samples of u, chebyshev.coefficients; sums (terms, LANES). */
static void fit(const Grid *grid, const double *samples, double *sums)
{
    Size n = grid->terms, i, k;
    memset(sums, 0, (size_t)(n * LANES) * sizeof(double));
    for (i = 0; i < n; i += LANES) {
        double t[LANES] = {0}, u[LANES] = {0};
        for (k = 0; k < LANES && i + k < n; k++) {
            t[k] = cos(((double)(i + k) + 0.5) * PI / (double)n);
            u[k] = samples[i + k];
        }
        add_moments(n, t, u, sums);
    }
    for (i = 0; i < n; i++) {
        grid->series[i] = 0.0;
        for (k = 0; k < LANES; k++)
            grid->series[i] += sums[i * LANES + k];
        grid->series[i] *= (i == 0 ? 1.0 : 2.0) / (double)n;
    }
}

/* Points at columns of a grid and u there, in lanes: (1 - cos theta) / 2 = (1 - sin(pi t / 2)) / 2 of the gap. */
VECTORISED static void at_columns(const Grid *grid, const Size *RESTRICT column, double *RESTRICT x, double *RESTRICT u)
{
    double t[LANES], sine[LANES];
    Size i, k;
    for (i = 0; i < LANES; i++) {
        t[i] = 1 - (double)(2 * column[i] + 1) / (double)grid->size;
        sine[i] = 1.0;
    }
    for (k = SINE_TERMS - 1; k > 0; k--) {
        double factor = PI * PI / (double)(8 * k * (2 * k + 1));
        for (i = 0; i < LANES; i++)
            sine[i] = 1.0 - factor * t[i] * t[i] * sine[i];
    }
    for (i = 0; i < LANES; i++)
        x[i] = grid->right + grid->width * (0.5 - PI / 4 * t[i] * sine[i]);
    sum_series(grid->terms, grid->series, t, u);
}

/* u less the profile, in lanes; the table is that of 2 pi. */
VECTORISED static void subtract_profile(Size rows, const double *RESTRICT table, const double *RESTRICT x,
                                        double *RESTRICT u)
{
    double unit = (double)rows / (2 * PI);
    Size i;
    for (i = 0; i < LANES; i++)
        u[i] -= height_at(table, rows, x[i] * unit);
}

/* Upper bounds of the profile between neighbouring points of its grid. */
typedef struct {
    Size n;
    const double *highest;
} Bounds;

/* gap._has_room of a stretch between two places. */
static int has_room(const Bounds *bounds, double x, double next_x, double u, double next_u, double bend, double level)
{
    double unit = (double)bounds->n / (2 * PI), first = floor(x * unit), last = floor(next_x * unit), most = -HUGE_VAL;
    Size at = (Size)fmod(first, (double)bounds->n), count = (Size)(last - first) + 1;
    for (at += at < 0 ? bounds->n : 0; count > 0; count--, at = at + 1 < bounds->n ? at + 1 : 0)
        most = bounds->highest[at] > most ? bounds->highest[at] : most;
    return (u < next_u ? u : next_u) - bend - most < level;
}

/* Points and u at columns from one on, in steps; room for LANES more. */
static void at_steps(const Grid *grid, Size first, Size step, Size n, double *x, double *u)
{
    Size column[LANES], i, k;
    for (i = 0; i < n; i += LANES) {
        for (k = 0; k < LANES; k++)
            column[k] = first + step * (i + k < n ? i + k : n - 1);
        at_columns(grid, column, x + i, u + i);
    }
}

/* The columns of a grid from one to another that are not yet there, behind the n that are. */
static Size with_columns(Size first, Size last, Size n, Size *column)
{
    for (first = n > 0 && first <= column[n - 1] ? column[n - 1] + 1 : first; first <= last; first++)
        column[n++] = first;
    return n;
}

static double bend_at(const double *u)
{
    return fabs(u[1] - u[0] - (u[0] - u[-1]));
}

/* Columns of a grid that are looked at, gap._looked_at: of a large one the ends, and stretches where bounds of u and of
   the profile leave room for less than the level.  x and u: workspace for twice the grid. */
static Size looked_at(const Grid *grid, const Bounds *bounds, double level, Size *column, double *x, double *u)
{
    Size step = STRETCH * (grid->size > LONGER ? grid->size / LONGER : 1), n, i, k, parts = step / STRETCH;
    Size edges = grid->size > WHOLE ? (grid->size - 2 * ENDS + step - 1) / step : 0;
    double *inner_x = x + edges + LANES, *inner_u = u + edges + LANES;
    at_steps(grid, ENDS, step, edges, x, u);
    n = with_columns(0, edges > 0 ? ENDS + 1 : grid->size - 1, 0, column);
    for (i = 0; i + 1 < edges; i++) {
        double bend = (i > 0 ? bend_at(u + i) : 0.0) + (i + 2 < edges ? bend_at(u + i + 1) : 0.0);
        Size first = ENDS + step * i;
        if (!has_room(bounds, x[i], x[i + 1], u[i], u[i + 1], bend, level))
            continue;
        at_steps(grid, first - STRETCH, STRETCH, parts + 3, inner_x, inner_u);
        for (k = 1; k <= parts; k++)
            if (has_room(bounds, inner_x[k], inner_x[k + 1], inner_u[k], inner_u[k + 1],
                         bend_at(inner_u + k) + bend_at(inner_u + k + 1), level))
                n = with_columns(first + STRETCH * (k - 1) - 1, first + STRETCH * k + 1, n, column);
    }
    return edges > 0 ? with_columns(ENDS + step * (edges - 1) - 1, grid->size - 1, n, column) : n;
}

Size low_points(Size gaps, const double *right, const double *width, const int64_t *sizes, const int64_t *counts,
                const double *samples, Size rows, const double *table, Size n_highest, const double *highest,
                double level, double *found)
{
    Size most = 0, terms = 0, n = 0, i, k, *column;
    double *x, *value, *series, *sums;
    Bounds bounds = {n_highest, highest};
    for (i = 0; i < gaps; i++) {
        most = sizes[i] > most ? (Size)sizes[i] : most;
        terms = counts[i] > terms ? (Size)counts[i] : terms;
    }
    x = workspace(3 * (most + LANES) + terms * (LANES + 1));
    if (x == NULL)
        return -1;
    value = x + most + LANES, series = value + most + LANES, sums = series + terms;
    column = (Size *)(sums + terms * LANES);
    for (i = 0; i < gaps; samples += counts[i++]) {
        Grid grid = {right[i], width[i], series, (Size)counts[i], (Size)sizes[i]};
        Size looked;
        fit(&grid, samples, sums);
        looked = looked_at(&grid, &bounds, level, column, x, value);
        for (k = looked; k < looked + LANES; k++)
            column[k] = column[looked - 1];
        for (k = 0; k < looked; k += LANES) {
            at_columns(&grid, column + k, x + k, value + k);
            subtract_profile(rows, table, x + k, value + k);
        }
        for (k = 1; k + 1 < looked; k++) {
            double sag = value[k - 1] + value[k + 1] - 2 * value[k];
            if (column[k + 1] == column[k - 1] + 2 && value[k] <= value[k - 1] && value[k] < value[k + 1] &&
                value[k] - sag < level) {
                found[4 * n] = (double)i;
                memcpy(found + 4 * n++ + 1, x + k - 1, 3 * sizeof(double));
            }
        }
    }
    PyMem_Free(x);
    return n;
}
