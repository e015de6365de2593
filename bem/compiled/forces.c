/* Forces on the edges of patches on a half-space at fixed penetration, in one call: collocation.py, equilibrium.py.

   What is evaluated, in which order and with which constants, is said there. */

#include "descent.h"

#define MOST_MODES 8000   /* collocation.MOST_MODES */
#define FAR_SHARE 1e-5    /* collocation.FAR_SHARE */
#define FINEST_FAR 1e-14  /* collocation.FINEST_FAR */
#define LARGEST_LEAF 130  /* hierarchical.LARGEST_LEAF */
#define UNIFORM 0.03      /* hierarchical.UNIFORM */
#define DIRECT 200000.0   /* logarithmic_potential.DIRECT */
#define PER_BOX 18.0      /* logarithmic_potential.PER_BOX */
#define ROUNDING 1e-14          /* collocation.ROUNDING */
#define ROUNDINGS 3.0           /* collocation.ROUNDINGS */
#define POSITION_ROUNDING 2e-15 /* collocation.POSITION_ROUNDING */

static double turned(double x) /* into [0, 2 pi) */
{
    return x - 2 * PI * floor(x / (2 * PI));
}

int resolved(const Setting *setting, Size n, const double *left, const double *right, const State *floor,
             int64_t *nodes, int64_t *modes)
{
    double *least = workspace(n), digits = -log(setting->tolerance);
    Size i, last = 0, first;
    int found;
    if (least == NULL)
        return -1;
    memset(least, 0, (size_t)n * sizeof(double));
    if (setting->cells > 0) { /* collocation._coupled_outside */
        double middle = (setting->delta + setting->beta + 2 * PI) / 2, ahead, behind;
        for (i = 1; i < n; i++)
            if (turned(middle - right[i]) < turned(middle - right[last]))
                last = i;
        first = (last + 1) % n;
        ahead = turned(setting->delta - right[last]) + setting->margins[1];
        behind = turned(left[first] - setting->beta) + setting->margins[0];
        least[last] = coupling_modes(right[last] - left[last], ahead, digits);
        behind = coupling_modes(right[first] - left[first], behind, digits);
        least[first] = behind > least[first] ? behind : least[first];
    }
    found = sizes_of(setting->lists, n, left, right, digits, setting->max_order, least, nodes, modes);
    for (i = 0; found && floor != NULL && i < n; i++) {
        nodes[i] = nodes[i] > floor->nodes[i] ? nodes[i] : floor->nodes[i];
        modes[i] = modes[i] > floor->modes[i] ? modes[i] : floor->modes[i];
    }
    PyMem_Free(least);
    return found;
}

/* FarField.at: the field and its derivative by the penetration. */
static Status far_at(const Setting *setting, Size n, const double *x, double *value, double *rate)
{
    double unit = (double)setting->cells / (setting->high - setting->low);
    Size i, c;
    for (i = 0; i < n; i++) {
        double from_beta = log_of_size(sin((x[i] - setting->beta) / 2));
        double from_delta = log_of_size(sin((x[i] - setting->delta) / 2)), found[2], p, q;
        double place = (from_beta - from_delta - setting->low) * unit;
        const double *here, *there;
        Size cell;
        if (!(place >= 0 && place <= (double)setting->cells))
            return NOT_DEFINITE; /* an edge leaves its window */
        cell = (Size)place < setting->cells - 1 ? (Size)place : setting->cells - 1;
        here = setting->far_table + 4 * cell;
        there = here + 4;
        p = place - (double)cell;
        q = 1 - p;
        for (c = 0; c < 2; c++) {
            found[c] = here[c] + p * p * (3 - 2 * p) * (there[c] - here[c]);
            found[c] += p * q * (q * here[2 + c] - p * there[2 + c]);
            found[c] += (from_beta + from_delta) / 2 * setting->far_charge[c];
        }
        value[i] = found[0] + (setting->penetration - setting->far_penetration) * found[1];
        rate[i] = found[1];
    }
    return SOLVED;
}

/* 2 sin(x/2), 2 cos(x/2), or cos(x/2), -sin(x/2): what pairs of positions are multiplied of. */
static void halves_of(Size n, const double *x, int sources, double *values)
{
    Size i;
    for (i = 0; i < n; i++) {
        double sine = sin(x[i] / 2), cosine = cos(x[i] / 2);
        values[i] = sources ? cosine : 2 * sine;
        values[n + i] = sources ? -sine : 2 * cosine;
    }
}

/* The series of fixed charges for a number of boxes, asked of Python once a call. */
static const double *series_of(Setting *setting, int doublings)
{
    if (doublings < 2 || doublings >= MOST_DOUBLINGS) {
        PyErr_SetString(PyExc_ValueError, "more boxes than there is room for");
        return NULL;
    }
    if (setting->series[doublings] == NULL)
        setting->series[doublings] = asked.series(setting->call->held, setting->potential, (Size)1 << doublings);
    return setting->series[doublings];
}

/* LogarithmicPotential of fixed charges. */
static int potential_of_fixed(Setting *setting, Size n, const double *x, const double *points, double *values)
{
    double pairs = (double)n * (double)setting->charges * (double)setting->calls;
    int doublings = pairs > DIRECT ? (int)log2(sqrt(pairs) / PER_BOX) : 0;
    const double *series;
    if (pairs <= DIRECT) {
        pairs_potential(n, points, setting->charges, setting->sources, setting->charge, values);
        return 1;
    }
    series = series_of(setting, doublings);
    return series != NULL && boxes_potential(n, x, points, setting->charges, setting->position, setting->sources,
                                             setting->charge, (Size)1 << doublings, series, values);
}

/* Right-hand sides with what others do, and the system solved. */
static Status solved_state(Setting *setting, State *state)
{
    double energy, level = setting->max_height - setting->penetration, *made[6], none[1];
    Size n = state->n, unknowns = state->unknowns, k = state->columns, moving = k - 1, i;
    double *points = state->charges; /* not yet known: workspace */
    RightHandSides to = {state->series, state->x, state->sides, state->tail, &energy};
    System system = {.call = setting->call, .n = unknowns, .per_patch = 2, .x = state->x, .left = state->left,
                     .right = state->right, .half_width = state->half_width, .tables = state->coupled,
                     .uniform = UNIFORM, .largest = LARGEST_LEAF};
    Status status;
    system.accuracy = FAR_SHARE * setting->tolerance > FINEST_FAR ? FAR_SHARE * setting->tolerance : FINEST_FAR;
    if (!right_hand_sides(&setting->surface, n, state->left, state->right, level, state->sampling,
                          state->coupled, state->terms, &to))
        return FAILED;
    if (setting->charges > 0) {
        halves_of(unknowns, state->x, 0, points);
        if (!potential_of_fixed(setting, unknowns, state->x, points, state->skeleton))
            return FAILED;
        for (i = 0; i < unknowns; i++)
            state->sides[i] -= state->skeleton[i];
    }
    if (setting->cells > 0) {
        double *rate = state->sides + 2 * unknowns;
        if (far_at(setting, unknowns, state->x, state->skeleton, rate) != SOLVED)
            return NOT_DEFINITE;
        for (i = 0; i < unknowns; i++) {
            state->sides[i] -= state->skeleton[i];
            rate[i] = 1 + rate[i] / PI;
        }
    }
    made[0] = state->compliance, made[1] = none, made[2] = state->gram;
    made[3] = state->charges, made[4] = state->at_edges, made[5] = state->slopes;
    if ((status = solved_system(&system, n, k, state->sides, made)) != SOLVED)
        return status;
    for (i = 0; i < 2 * n; i++) {
        double r = state->half_width[i % n], root = sqrt(PI / r);
        state->intensity[i] = (state->at_edges[i] + state->tail[i]) * root;
        state->rate[i] = -PI * root * state->at_edges[moving * 2 * n + i];
        state->edge_slope[i] = state->tail[2 * n + i] / r - state->slopes[i] / r;
        state->edge_slope_rate[i] = PI / r * state->slopes[moving * 2 * n + i];
    }
    for (i = 0; i < unknowns; i++) {
        state->skeleton[i] = -state->charges[i];
        state->skeleton_rate[i] = PI * state->charges[moving * unknowns + i];
    }
    state->load = -state->gram[moving];
    state->load_rate = PI * state->gram[moving * k + moving];
    state->elastic_energy = (state->gram[0] + 0.5 * energy) / (2 * PI);
    return SOLVED;
}

/* Work of adhesion at the edges, the forces on them, and the energy. */
static int add_forces(const Setting *setting, State *state)
{
    Size n = state->n, i;
    double *slope = state->gradient, *bend = state->work_gradient, energy = 0.0; /* not yet known: workspace */
    for (i = 0; i < n; i++) {
        double length = state->right[i] - state->left[i];
        if (setting->length.panels > 0)
            length = length_up_to(&setting->length, state->right[i]) - length_up_to(&setting->length, state->left[i]);
        energy -= setting->work * length;
    }
    state->potential = state->elastic_energy + energy;
    if (setting->length.panels > 0) {
        const Surface *surface = &setting->surface;
        memcpy(state->work, state->left, (size_t)n * sizeof(double));
        memcpy(state->work + n, state->right, (size_t)n * sizeof(double));
        expansion(surface->table, surface->rows, surface->scale, 1, 2 * n, state->work, slope);
        expansion(surface->table, surface->rows, surface->scale, 2, 2 * n, state->work, bend);
    }
    for (i = 0; i < 2 * n; i++) {
        double stretch = 1.0, outward = i < n ? -1.0 : 1.0;
        if (setting->length.panels > 0) {
            stretch = hypot(1.0, setting->slope_scale * slope[i]);
            state->work_gradient[i] =
                outward * setting->work * setting->slope_scale * setting->slope_scale * slope[i] * bend[i] / stretch;
        } else
            state->work_gradient[i] = 0.0;
        state->work[i] = setting->work * stretch;
        state->gradient[i] = state->intensity[i] * state->intensity[i] / 4 - state->work[i];
    }
    return jacobian_of(n, state->half_width, state->modes, state->intensity, state->compliance, state->edge_slope,
                       state->jacobian);
}

Status balanced(Setting *setting, Size n, const double *left, const double *right, const int64_t *nodes,
                const int64_t *modes, State *state)
{
    Call *call = setting->call;
    Size edges = 2 * n, i, k = setting->cells > 0 ? 3 : 2, unknowns;
    double *next;
    Status status;
    memset(state, 0, sizeof *state);
    state->n = n;
    state->columns = k;
    if ((state->left = next = workspace(6 * n)) == NULL)
        return FAILED;
    state->right = next += n, state->center = next += n, state->half_width = next += n;
    state->nodes = (int64_t *)(next += n), state->modes = (int64_t *)(next += n);
    memcpy(state->nodes, nodes, (size_t)n * sizeof(int64_t));
    memcpy(state->modes, modes, (size_t)n * sizeof(int64_t));
    for (i = 0; i < n; i++) {
        state->left[i] = left[i];
        state->right[i] = right[i];
        state->center[i] = (left[i] + right[i]) / 2;
        state->half_width[i] = (right[i] - left[i]) / 2;
        if (modes[i] > MOST_MODES)
            return NOT_DEFINITE;
    }
    state->sampling = (Table *)workspace(2 * (n + 1) * (Size)(sizeof(Table) / sizeof(double)));
    if (state->sampling == NULL)
        return FAILED;
    state->coupled = state->sampling + n + 1;
    if (!tables_of(call, OF_NODES, nodes, n, state->sampling) || !tables_of(call, OF_MODES, modes, n, state->coupled))
        return FAILED;
    if ((state->terms = most_nodes(n, state->sampling, state->coupled)) == 0)
        return FAILED;
    unknowns = state->unknowns = state->coupled[n].start;
    state->memory = next = workspace(n * state->terms + (3 + 2 * k) * unknowns + k * k + (2 + 2 * k + 7) * edges);
    state->matrices = workspace(2 * edges * edges);
    if (state->memory == NULL || state->matrices == NULL)
        return FAILED;
    state->series = next, state->x = next += n * state->terms, state->sides = next += unknowns;
    state->charges = next += k * unknowns, state->skeleton = next += k * unknowns;
    state->skeleton_rate = next += unknowns, state->gram = next += unknowns, state->tail = next += k * k;
    state->at_edges = next += 2 * edges, state->slopes = next += k * edges, state->intensity = next += k * edges;
    state->rate = next += edges, state->edge_slope = next += edges, state->edge_slope_rate = next += edges;
    state->work = next += edges, state->work_gradient = next += edges, state->gradient = next += edges;
    state->compliance = state->matrices, state->jacobian = state->matrices + edges * edges;
    status = solved_state(setting, state);
    return status == SOLVED && !add_forces(setting, state) ? FAILED : status;
}

void release_state(State *state)
{
    PyMem_Free(state->left);
    PyMem_Free(state->memory);
    PyMem_Free(state->matrices);
    PyMem_Free(state->sampling);
    memset(state, 0, sizeof *state);
}

Status gap_at(Setting *setting, const State *state, Size n, const double *x, const int64_t *gap, double *values)
{
    const Surface *surface = &setting->surface;
    Size unknowns = state->unknowns, i;
    double *points = workspace(4 * n + 2 * unknowns + state->n * state->terms), *added, *sources, *charges;
    Status status = points != NULL ? SOLVED : FAILED;
    if (status == FAILED)
        return FAILED;
    added = points + 2 * n, sources = added + 2 * n, charges = sources + 2 * unknowns;
    halves_of(n, x, 0, points);
    halves_of(unknowns, state->x, 1, sources);
    pairs_potential(n, points, unknowns, sources, state->skeleton, values);
    memset(added, 0, (size_t)n * sizeof(double));
    if (setting->charges > 0 && !potential_of_fixed(setting, n, x, points, added))
        status = FAILED;
    for (i = 0; i < n; i++)
        values[i] += added[i];
    if (status == SOLVED && setting->cells > 0) {
        status = far_at(setting, n, x, added, added + n);
        for (i = 0; i < n; i++)
            values[i] += added[i];
    }
    charges_of_modes(state->coupled, state->n, state->terms, state->series, state->skeleton, charges);
    add_near_patches(state->n, state->center, state->half_width, state->nodes, state->coupled, state->terms, charges,
                     state->skeleton, n, gap, x, values);
    expansion(surface->table, surface->rows, surface->scale, 0, n, x, added);
    for (i = 0; i < n; i++)
        values[i] = values[i] / -PI - added[i] + (setting->max_height - setting->penetration);
    PyMem_Free(points);
    return status;
}

int is_equilibrium(const Setting *setting, const State *state, double residual)
{
    Size n = state->n, i, j;
    double displaced = fmax(1.0, fabs(state->load) / (2 * PI));
    for (i = 0; i < 2 * n; i++) {
        double missing = fabs(state->gradient[i] / state->work[i]), largest = 1.0, rounding;
        const Table *table = &state->coupled[i % n];
        if (missing <= residual)
            continue;
        for (j = 0; j < table->n; j++) {
            double charge = fabs(state->skeleton[table->start + j]) * (double)table->n / PI;
            largest = charge > largest ? charge : largest;
        }
        rounding = (double)state->nodes[i % n] * (ROUNDING * largest + POSITION_ROUNDING * setting->rms_slope);
        rounding = rounding * sqrt(PI / state->half_width[i % n]) + ROUNDING * displaced * fabs(state->rate[i]);
        if (!(missing <= ROUNDINGS * rounding / sqrt(state->work[i])))
            return 0;
    }
    return 1;
}
