/* The profile at given points, its Chebyshev series on the patches, and its length: profile.py, collocation.py,
   adhesion.py. */

#include "core.h"
#include "kernels.h"

/* k (k - 1) ... (k - order + 1) */
static double permutations(int k, int order)
{
    double product = 1.0;
    for (; order > 0; order--)
        product *= k--;
    return product;
}

/* profile.taylor(table, x, spacing_inverse, derivatives): h, h', ... at points, (derivatives + 1, n). */
DECLARED(taylor)
{
    Call call;
    Size of_table[2], n[1], i;
    double *table, *x, *values, scale;
    PyObject *result;
    int most, order, k;
    if (!enter(&call, n_given, 4))
        return NULL;
    table = reals(&call, given[0], 2, of_table);
    x = reals(&call, given[1], 1, n);
    scale = number(&call, given[2]);
    most = (int)count(&call, given[3]);
    expect(&call, most >= 0 && most <= 2, "taylor: derivatives from 0 to 2");
    expect(&call, of_table[0] > 0 && of_table[1] == TERMS, "taylor: a table of 14 terms");
    result = new_reals(&call, 2, most + 1, n[0], &values);
    if (!call.failed)
        for (order = 0; order <= most; order++) {
            double factors[TERMS] = {0}, unit = 1.0;
            for (k = order; k < TERMS; k++)
                factors[k] = permutations(k, order);
            for (k = 0; k < order; k++)
                unit *= scale;
            for (i = 0; i < n[0]; i++) {
                double offset, total;
                const double *row = nearest_row(table, of_table[0], x[i] * scale, &offset);
                total = factors[TERMS - 1] * row[TERMS - 1];
                for (k = TERMS - 2; k >= order; k--)
                    total = total * offset + factors[k] * row[k];
                values[order * n[0] + i] = total * unit;
            }
        }
    leave(&call);
    return result;
}

/* collocation.sampled_series(profile, patches, sampling): Chebyshev coefficients of -pi h, a patch a row, filled up with
   zeros; where there is no matrix for them, the samples. */
DECLARED(sampled_series)
{
    Call call;
    Size of_table[2], n[1], m[1], i, k, most = 0;
    double *table, *center, *half_width, *series, *samples, scale;
    int64_t *index;
    const double **sizes;
    PyObject *tables, *result = NULL;
    if (!enter(&call, n_given, 3))
        return NULL;
    table = reals(&call, attribute(&call, given[0], "_table"), 2, of_table);
    scale = of_table[0] / number(&call, attribute(&call, given[0], "period"));
    center = reals(&call, attribute(&call, given[1], "center"), 1, n);
    half_width = reals(&call, attribute(&call, given[1], "half_width"), 1, m);
    index = integers(&call, attribute(&call, given[2], "index"), &i);
    tables = attribute(&call, given[2], "tables");
    expect(&call, of_table[0] > 0 && of_table[1] == TERMS, "a Taylor table of 14 terms");
    expect(&call, n[0] == m[0] && n[0] == i && PyTuple_Check(tables), "patches and sampling differ");
    sizes = (const double **)workspace(call.failed ? 0 : PyTuple_GET_SIZE(tables));
    for (i = 0; !call.failed && i < PyTuple_GET_SIZE(tables); i++) {
        sizes[i] = reals(&call, PyTuple_GET_ITEM(tables, i), 1, m);
        k = call.failed || m[0] == 0 ? 0 : (Size)sizes[i][0];
        expect(&call, k > 0 && m[0] == 2 + k + (sizes[i][1] != 0.0 ? k * k : 0), "sampling: not as sampling_table packs it");
        most = k > most ? k : most;
    }
    for (i = 0; !call.failed && i < n[0]; i++)
        expect(&call, 0 <= index[i] && index[i] < PyTuple_GET_SIZE(tables), "sampling: index out of range");
    result = new_reals(&call, 2, n[0], most, &series);
    samples = workspace(most);
    for (i = 0; !call.failed && i < n[0]; i++, series += most) {
        const double *packed = sizes[index[i]], *nodes = packed + 2;
        Size size = (Size)packed[0];
        double *into = packed[1] != 0.0 ? samples : series;
        for (k = 0; k < size; k++)
            into[k] = -PI * height_at(table, of_table[0], (center[i] + half_width[i] * nodes[k]) * scale);
        if (into == samples)
            times('N', size, size, 1.0, nodes + size, size, samples, 0.0, series);
        memset(series + size, 0, (size_t)(most - size) * sizeof(double));
    }
    PyMem_Free(samples);
    PyMem_Free((void *)sizes);
    leave(&call);
    return result;
}

/* adhesion.integral(start, width, series, whole, x): a Chebyshev series on the panel in which each position lies, and
   `whole` for every turn of the circle. */
DECLARED(integral)
{
    Call call;
    Size panels[1], of_width[1], of_series[2], n[1], i, k;
    double *start, *width, *series, *x, *values, whole;
    PyObject *result;
    if (!enter(&call, n_given, 5))
        return NULL;
    start = reals(&call, given[0], 1, panels);
    width = reals(&call, given[1], 1, of_width);
    series = reals(&call, given[2], 2, of_series);
    whole = number(&call, given[3]);
    x = reals(&call, given[4], 1, n);
    expect(&call, panels[0] > 0 && of_width[0] == panels[0] && of_series[0] == panels[0] && of_series[1] > 0,
           "panels and series differ");
    result = new_reals(&call, 1, n[0], 0, &values);
    for (i = 0; !call.failed && i < n[0]; i++) {
        double turns = floor(x[i] / (2 * PI)), place = x[i] - turns * (2 * PI), t, before = 0.0, now = 0.0;
        const double *terms;
        Size low = 0, high = panels[0];
        while (high - low > 1) { /* the last panel that does not begin behind the place */
            Size middle = (low + high) / 2;
            if (start[middle] <= place)
                low = middle;
            else
                high = middle;
        }
        t = 2 * (place - start[low]) / width[low] - 1;
        t = t < -1 ? -1 : t > 1 ? 1 : t;
        terms = series + low * of_series[1];
        for (k = of_series[1] - 1; k > 0; k--) { /* Clenshaw's rule */
            double next = 2 * t * now - before + terms[k];
            before = now;
            now = next;
        }
        values[i] = turns * whole + t * now - before + terms[0];
    }
    leave(&call);
    return result;
}

/* collocation.uncoupled(series, modes): sums over n >= p of (n/pi) C_n (+-1)^n and -(n^3/pi) C_n (+-1)^n, left edges
   first, and of n C_n^2 over all patches. */
DECLARED(uncoupled)
{
    Call call;
    Size of_series[2], patches, i, n;
    double *series, *at_edge, *slope, energy = 0.0;
    int64_t *modes;
    PyObject *parts[2], *result = NULL;
    if (!enter(&call, n_given, 2))
        return NULL;
    series = reals(&call, given[0], 2, of_series);
    modes = integers(&call, given[1], &patches);
    expect(&call, of_series[0] == patches, "series and modes differ");
    parts[0] = new_reals(&call, 1, 2 * patches, 0, &at_edge);
    parts[1] = new_reals(&call, 1, 2 * patches, 0, &slope);
    for (i = 0; !call.failed && i < patches; i++) {
        double even = 0.0, odd = 0.0, steep_even = 0.0, steep_odd = 0.0;
        const double *c = series + i * of_series[1];
        for (n = (Size)(modes[i] < 0 ? 0 : modes[i]); n < of_series[1]; n++) {
            double term = (double)n * c[n], steep = term * ((double)n * (double)n);
            even += n % 2 == 0 ? term : 0.0;
            odd += n % 2 == 0 ? 0.0 : term;
            steep_even += n % 2 == 0 ? steep : 0.0;
            steep_odd += n % 2 == 0 ? 0.0 : steep;
            energy += term * c[n];
        }
        at_edge[i] = (even - odd) / PI;
        at_edge[patches + i] = (even + odd) / PI;
        slope[i] = -(steep_even - steep_odd) / PI;
        slope[patches + i] = -(steep_even + steep_odd) / PI;
    }
    if (!call.failed)
        result = Py_BuildValue("(OOd)", parts[0], parts[1], energy);
    for (i = 0; i < 2; i++)
        Py_XDECREF(parts[i]);
    leave(&call);
    return result;
}
