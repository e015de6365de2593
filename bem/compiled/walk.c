/* Steps of a descent, in one call: strides.strides, which says what is done and why; touching.py, vanishing.py. */

#include "walk.h"

#define LEAST_RATIO 0.1        /* strides.LEAST_RATIO */
#define LARGEST_RATIO 2.5      /* strides.LARGEST_RATIO */
#define LEAST_INTENSITY 0.3    /* strides.LEAST_INTENSITY */
#define EQUAL_HEIGHTS 1e-12    /* profile.EQUAL_HEIGHTS */
#define ENERGY_TRUNCATION 3e-3 /* equilibrium.ENERGY_TRUNCATION */
#define NARROW 0.02            /* vanishing.NARROW */
#define CLOSED_GAP 1e-7        /* vanishing.CLOSED_GAP */
#define LAST_GAP 2e-4          /* vanishing.LAST_GAP */
#define TIED 1e-3              /* vanishing.TIED */
#define REACH 4.0              /* touching.REACH */

static double turned(double x) /* into [0, 2 pi) */
{
    return x - 2 * PI * floor(x / (2 * PI));
}

static double gap_after(Size n, const double *left, const double *right, Size i)
{
    return (i + 1 < n ? left[i + 1] : left[0] + 2 * PI) - right[i];
}

/* Patches.edge_scale of an edge. */
static double edge_scale(Size n, const double *left, const double *right, Size edge)
{
    Size i = edge % n, gap = edge < n ? (i + n - 1) % n : i;
    double width = right[i] - left[i], beside = gap_after(n, left, right, gap);
    return width < beside ? width : beside;
}

static int is_ordered(Size n, const double *left, const double *right)
{
    Size i;
    for (i = 0; i < n; i++)
        if (!(right[i] - left[i] > 0 && gap_after(n, left, right, i) > 0))
            return 0;
    return 1;
}

/* Whether edges keep clear of the patches beside those that descend. */
static int is_free(const Walk *walk, const double *left, const double *right)
{
    Size i, j;
    if (walk->occupied_left == NULL)
        return 1;
    if (!is_ordered(walk->n, left, right))
        return 0;
    for (i = 0; i < walk->n; i++)
        for (j = 0; j < walk->n_occupied; j++)
            if (turned(walk->occupied_left[j] - left[i]) <= right[i] - left[i] ||
                turned(left[i] - walk->occupied_left[j]) <= walk->occupied_right[j] - walk->occupied_left[j])
                return 0;
    return 1;
}

/* vanishing.pulled_shut of the gap behind a patch. */
static int pulled_shut(const State *here, Size gap)
{
    Size first = here->n + gap, last = (gap + 1) % here->n;
    return (here->gradient[first] <= 0 || here->intensity[first] <= 0) &&
           (here->gradient[last] <= 0 || here->intensity[last] <= 0);
}

/* vanishing.closing: gaps about to close. */
static int find_closing(Walk *walk)
{
    const State *here = &walk->here;
    Size n = here->n, i;
    double widest = 0.0, doomed, narrowest = HUGE_VAL;
    for (i = 0; i < n; i++) {
        double gap = gap_after(n, here->left, here->right, i);
        widest = gap > widest ? gap : widest;
    }
    doomed = 0.05 * widest > LAST_GAP * 2 * PI ? 0.05 * widest : LAST_GAP * 2 * PI;
    doomed = NARROW * walk->wavelength < doomed ? NARROW * walk->wavelength : doomed;
    walk->n_gone = 0;
    for (i = 0; i < n; i++) {
        double gap = gap_after(n, here->left, here->right, i);
        if ((gap < doomed && pulled_shut(here, i)) || gap < CLOSED_GAP * 2 * PI) {
            walk->gone[walk->n_gone++] = (int64_t)i;
            narrowest = gap < narrowest ? gap : narrowest;
        }
    }
    for (i = 0, widest = 0; i < walk->n_gone; i++) {
        walk->gone[(Size)widest] = walk->gone[i];
        widest += gap_after(n, here->left, here->right, (Size)walk->gone[i]) <= (1 + TIED) * narrowest;
    }
    walk->n_gone = (Size)widest;
    return walk->n_gone > 0 && walk->n_gone < n; /* at fixed penetration the last gap stays */
}

/* vanishing.pull_off_half_width at a place. */
static double pull_off_half_width(const Walk *walk, double x)
{
    const Setting *setting = &walk->setting;
    const Surface *surface = &setting->surface;
    double slope = 0.0, bend, work = setting->work, width;
    expansion(surface->table, surface->rows, surface->scale, 2, 1, &x, &bend);
    bend = -bend > walk->rms_curvature ? -bend : walk->rms_curvature;
    if (setting->length.panels > 0) {
        expansion(surface->table, surface->rows, surface->scale, 1, 1, &x, &slope);
        work *= hypot(1.0, setting->slope_scale * slope);
    }
    width = cbrt(work / (PI * bend * bend));
    return width < 1 / setting->max_order ? width : 1 / setting->max_order;
}

/* vanishing.vanishing: patches about to vanish. */
static int find_vanishing(Walk *walk, double *relative)
{
    const State *here = &walk->here;
    Size n = here->n, i, kept = 0;
    double least = HUGE_VAL;
    int narrow = 0;
    walk->n_gone = 0;
    for (i = 0; i < n; i++)
        if (here->gradient[i] > 0 && here->gradient[n + i] > 0) {
            narrow |= here->half_width[i] < NARROW / walk->setting.max_order;
            walk->gone[walk->n_gone++] = (int64_t)i;
        }
    if (!narrow)
        return 0;
    for (i = 0; i < walk->n_gone; i++) {
        Size patch = (Size)walk->gone[i];
        relative[i] = here->half_width[patch] / pull_off_half_width(walk, here->center[patch]);
        least = relative[i] < least ? relative[i] : least;
    }
    for (i = 0; i < walk->n_gone; i++)
        if (relative[i] <= (1 + TIED) * least)
            walk->gone[kept++] = walk->gone[i];
    walk->n_gone = kept;
    return least < NARROW;
}

static int all_tensile(const State *here)
{
    Size i;
    for (i = 0; i < 2 * here->n; i++)
        if (!(here->intensity[i] > 0))
            return 0;
    return 1;
}

static void move_edge(Size n, Size edge, double outward, double *left, double *right)
{
    if (edge < n)
        left[edge] -= outward;
    else
        right[edge - n] += outward;
}

/* strides.step_scale of an edge. */
static double step_scale(const Walk *walk, Size edge)
{
    double scale = edge_scale(walk->n, walk->here.left, walk->here.right, edge), most = walk->wavelength / 2;
    return scale < most ? scale : most;
}

/* strides._expanded, from where the walk stands; 0 where no space is left. */
static int expand(Walk *walk)
{
    const State *here = &walk->here;
    Size n = here->n, e;
    for (e = 0; e < 2 * n; e++) {
        double scale = step_scale(walk, e), slope = here->jacobian[e * (2 * n + 1)], wanted;
        double least = LEAST_INTENSITY * 2 * sqrt(here->work[e]), most = LEAST_INTENSITY * scale;
        if (!(here->intensity[e] < least))
            continue;
        wanted = slope > 0 ? (least - here->intensity[e]) / slope : 0.0;
        wanted = wanted < 0.02 * scale ? 0.02 * scale : wanted > most ? most : wanted;
        move_edge(n, e, wanted, walk->left, walk->right);
    }
    return is_ordered(n, walk->left, walk->right) && is_free(walk, walk->left, walk->right);
}

/* A crest ahead of an edge, and the gap in which it is. */
typedef struct {
    Size crest;
    double x;
    int64_t gap;
} Ahead;

static Size first_crest(const Walk *walk, double x) /* numpy.searchsorted */
{
    Size low = -1, high = walk->n_crests;
    while (high - low > 1) {
        Size middle = (low + high) / 2;
        if (walk->crests[middle] >= x)
            high = middle;
        else
            low = middle;
    }
    return high;
}

/* CrestsAhead._ahead: crests ahead of edges that moved, which are marked as seen; -1 without memory. */
static Size crests_ahead(Walk *walk, const State *after, Ahead **found)
{
    Size n = after->n, edge, room = 0, count = 0, i, k;
    *found = NULL;
    for (edge = 0; edge < 2 * n; edge++) {
        Size patch = edge % n, gap = edge < n ? (patch + n - 1) % n : patch;
        double outward = edge < n ? walk->seen_left[patch] - after->left[patch] : after->right[patch] - walk->seen_right[patch];
        double width = gap_after(n, after->left, after->right, gap), start, turn, reach = REACH * walk->wavelength;
        if (!(outward > NARROW * walk->wavelength) || !(after->intensity[n + gap] > 0) ||
            !(after->intensity[(gap + 1) % n] > 0))
            continue;
        if (edge < n)
            walk->seen_left[patch] = after->left[patch];
        else
            walk->seen_right[patch] = after->right[patch];
        reach = reach < width ? reach : width;
        start = after->right[gap] + (edge < n ? width - reach : 0.0);
        turn = floor(start / (2 * PI)) * 2 * PI;
        for (i = 0; i < 2; i++, turn += 2 * PI) {
            Size crest = first_crest(walk, start - turn), last = first_crest(walk, start - turn + reach);
            if (count + last - crest > room) {
                Ahead *more = PyMem_Realloc(*found, (size_t)(2 * room + last - crest) * sizeof(Ahead));
                if (more == NULL) {
                    PyErr_NoMemory();
                    return -1;
                }
                *found = more;
                room = 2 * room + last - crest;
            }
            for (; crest < last; crest++) {
                for (k = count; k > 0 && (*found)[k - 1].crest >= crest; k--)
                    ;
                if (k == count || (*found)[k].crest != crest) {
                    memmove(*found + k + 1, *found + k, (size_t)(count - k) * sizeof(Ahead));
                    count++;
                }
                (*found)[k] = (Ahead){crest, walk->crests[crest] + turn, (int64_t)gap};
            }
        }
    }
    return count;
}

/* CrestsAhead: whether crests touch after a step. */
static Verdict looked_ahead(Walk *walk, const State *after)
{
    Ahead *ahead;
    Size count = crests_ahead(walk, after, &ahead), n = 0, i, j;
    double *x = count > 0 ? workspace(3 * count) : NULL, *depth = x + count;
    Verdict verdict = count < 0 || (count > 0 && x == NULL) ? ERROR : AGAIN;
    int64_t *gap = (int64_t *)(depth + count);
    for (i = 0; verdict == AGAIN && i < count; i++) {
        for (j = 0; j < walk->n_occupied; j++)
            if (turned(ahead[i].x - walk->occupied_left[j]) <= walk->occupied_right[j] - walk->occupied_left[j])
                break;
        if (j == walk->n_occupied) {
            x[n] = ahead[i].x;
            gap[n++] = ahead[i].gap;
        }
    }
    if (n > 0) {
        Status status = gap_at(&walk->setting, after, n, x, gap, depth);
        verdict = status == FAILED ? ERROR : status == NOT_DEFINITE ? ILL_CONDITIONED : AGAIN;
        for (i = 0, j = 0; status == SOLVED && i < n; i++)
            if (depth[i] < -walk->allowed) {
                x[j] = x[i];
                depth[j] = depth[i];
                gap[j++] = gap[i];
            }
        if (status == SOLVED && j > 0) {
            verdict = TOUCHED;
            walk->n_touching = j;
            walk->touching = x;
            walk->depth = depth;
            walk->in_gap = gap;
        }
    }
    if (verdict != TOUCHED)
        PyMem_Free(x);
    PyMem_Free(ahead);
    return verdict;
}

/* Forces on edges; `wanted`: their nodes and modes. */
static Verdict evaluate(Walk *walk, const double *left, const double *right, const int64_t *wanted, State *state)
{
    Status status;
    walk->evaluations++;
    status = balanced(&walk->setting, walk->n, left, right, wanted, wanted + walk->n, state);
    if (status != SOLVED)
        release_state(state);
    return status == SOLVED ? AGAIN : status == NOT_DEFINITE ? ILL_CONDITIONED : ERROR;
}

/* Nodes and modes of patches, at least those of a state where it has as many; an error where patches overlap. */
static Verdict resolve(Walk *walk, const double *left, const double *right, const State *floor, int64_t *wanted)
{
    const State *least = floor->n == walk->n ? floor : NULL;
    int found = resolved(&walk->setting, walk->n, left, right, least, wanted, wanted + walk->n);
    if (found == 0)
        PyErr_SetString(PyExc_ValueError, "patches that overlap, or too close for any number of modes");
    return found > 0 ? AGAIN : ERROR;
}

/* Fall of the potential over that predicted. */
static double ratio_of(const Walk *walk, const State *ahead, const double *step, double predicted, int alike)
{
    const State *here = &walk->here;
    double share = ENERGY_TRUNCATION * (walk->setting.tolerance * walk->setting.tolerance);
    double noise = 1e-13 * (fabs(here->potential) + fabs(ahead->potential));
    double actual = here->potential - ahead->potential;
    Size e;
    noise += share * (here->elastic_energy + ahead->elastic_energy);
    if (predicted < 100 * noise || !alike)
        for (actual = 0.0, e = 0; e < 2 * here->n; e++)
            actual -= 0.5 * (here->gradient[e] + ahead->gradient[e]) * step[e];
    return predicted > 0 ? actual / predicted : -1.0;
}

/* Try a step, (2 n,), of a length in units of the step scale: take it, or shrink the radius. */
static Verdict tried(Walk *walk, const double *step, const double *parts, double size, double predicted, double *edges)
{
    Size n = walk->n, e;
    double *left = edges, *right = edges + n, ratio;
    int64_t *wanted = (int64_t *)(edges + 2 * n);
    State ahead;
    Verdict verdict;
    int alike, good;
    memcpy(left, walk->left, (size_t)n * sizeof(double));
    memcpy(right, walk->right, (size_t)n * sizeof(double));
    for (e = 0; e < 2 * n; e++)
        move_edge(n, e, step[e], left, right);
    if (!is_free(walk, left, right))
        return STUCK;
    if (resolve(walk, left, right, &walk->here, wanted) == ERROR)
        return ERROR;
    alike = memcmp(wanted, walk->here.nodes, (size_t)n * sizeof(int64_t)) == 0 &&
            memcmp(wanted + n, walk->here.modes, (size_t)n * sizeof(int64_t)) == 0;
    if ((verdict = evaluate(walk, left, right, wanted, &ahead)) != AGAIN)
        return verdict;
    ratio = ratio_of(walk, &ahead, step, predicted, alike);
    good = LEAST_RATIO < ratio && ratio < LARGEST_RATIO;
    for (e = 0; e < 2 * n; e++)
        good &= ahead.intensity[e] > 0 || parts[e] > 0;
    if (!good) {
        release_state(&ahead);
        if (alike) {
            walk->radius = (walk->radius < size ? walk->radius : size) / 3;
            return AGAIN;
        }
        release_state(&walk->here);
        return evaluate(walk, walk->left, walk->right, wanted, &walk->here);
    }
    release_state(&walk->here);
    walk->here = ahead;
    memcpy(walk->left, left, (size_t)n * sizeof(double));
    memcpy(walk->right, right, (size_t)n * sizeof(double));
    if (walk->looks_ahead && (verdict = looked_ahead(walk, &walk->here)) != AGAIN)
        return verdict;
    if (0.5 < ratio && ratio < 1.5)
        walk->radius = 2 * walk->radius < walk->largest ? 2 * walk->radius : walk->largest;
    return AGAIN;
}

/* One round: `work` has room for 2 n (2 n + 6) numbers. */
static Verdict round_of(Walk *walk, double *work)
{
    Size n = walk->n, m = 2 * n, i, j;
    double *scale = work, *gradient = scale + m, *parts = gradient + m, *step = parts + m, *edges = step + m;
    double *hessian = edges + 2 * m, predicted = 0.0, size = 0.0;
    State *here = &walk->here;
    Verdict verdict;
    if (here->n == 0) {
        if (resolve(walk, walk->left, walk->right, &walk->floor, (int64_t *)edges) == ERROR)
            return ERROR;
        if ((verdict = evaluate(walk, walk->left, walk->right, (int64_t *)edges, here)) != AGAIN)
            return verdict;
    }
    if (find_closing(walk))
        return CLOSING;
    if (!all_tensile(here)) {
        memcpy(edges, walk->left, (size_t)m * sizeof(double)); /* `right` stands behind */
        if (!expand(walk)) {
            memcpy(walk->left, edges, (size_t)m * sizeof(double));
            return STUCK;
        }
        release_state(here);
        return AGAIN;
    }
    if (find_vanishing(walk, scale))
        return VANISHING;
    for (i = 0; i < m; i++)
        scale[i] = step_scale(walk, i);
    for (i = 0; i < m; i++) {
        gradient[i] = here->gradient[i] * scale[i];
        for (j = 0; j <= i; j++) {
            double both = here->intensity[i] / 2 * here->jacobian[i * m + j] + here->intensity[j] / 2 * here->jacobian[j * m + i];
            if (i == j)
                both -= 2 * here->work_gradient[i];
            hessian[i * m + j] = hessian[j * m + i] = both * (scale[i] / 2) * scale[j];
        }
    }
    if (!trust_region_step(m, gradient, hessian, walk->radius, parts))
        return ERROR;
    for (i = 0; i < m; i++) {
        double bent = 0.0;
        for (j = 0; j < m; j++)
            bent += hessian[i * m + j] * parts[j];
        predicted -= parts[i] * (gradient[i] + 0.5 * bent);
        size += parts[i] * parts[i];
        step[i] = parts[i] * scale[i];
    }
    size = sqrt(size);
    if (size < 0.9 * walk->radius && is_equilibrium(&walk->setting, here, walk->residual))
        return CONVERGED;
    return tried(walk, step, parts, size, predicted, edges);
}

int strides(Walk *walk, Size *rounds)
{
    Verdict verdict = AGAIN;
    double *work = workspace(2 * walk->n * (2 * walk->n + 7));
    if (work == NULL)
        return ERROR;
    for (; verdict == AGAIN; (*rounds)--)
        verdict = *rounds > 0 && walk->radius >= EQUAL_HEIGHTS ? round_of(walk, work) : STUCK;
    PyMem_Free(work);
    return verdict;
}

void release_walk(Walk *walk)
{
    release_state(&walk->here);
    PyMem_Free(walk->left);
    PyMem_Free(walk->touching);
}
