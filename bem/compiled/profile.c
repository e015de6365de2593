/* The profile at given points, and its length: profile.py, adhesion.py. */

#include "descent.h"
#include "kernels.h"

/* k (k - 1) ... (k - order + 1) */
static double permutations(int k, int order)
{
    double product = 1.0;
    for (; order > 0; order--)
        product *= k--;
    return product;
}

VECTORISED void expansion(const double *table, Size rows, double spacing_inverse, int order, Size n, const double *x,
                          double *values)
{
    double factors[TERMS] = {0}, unit = 1.0;
    Size i;
    int k;
    for (k = order; k < TERMS; k++)
        factors[k] = permutations(k, order);
    for (k = 0; k < order; k++)
        unit *= spacing_inverse;
    for (i = 0; i < n; i++) {
        double offset, total;
        const double *row = nearest_row(table, rows, x[i] * spacing_inverse, &offset);
        total = factors[TERMS - 1] * row[TERMS - 1];
        for (k = TERMS - 2; k >= order; k--)
            total = total * offset + factors[k] * row[k];
        values[i] = total * unit;
    }
}

/* profile.taylor(table, x, spacing_inverse, derivatives): h, h', ... at points, (derivatives + 1, n). */
DECLARED(taylor)
{
    Call call;
    Size of_table[2], n[1];
    double *table, *x, *values, scale;
    PyObject *result;
    int most, order;
    if (!enter(&call, n_given, 4))
        return NULL;
    table = reals(&call, given[0], 2, of_table);
    x = reals(&call, given[1], 1, n);
    scale = number(&call, given[2]);
    most = (int)count(&call, given[3]);
    expect(&call, most >= 0 && most <= 3, "taylor: derivatives from 0 to 3");
    expect(&call, of_table[0] > 0 && of_table[1] == TERMS, "taylor: a table of 14 terms");
    result = new_reals(&call, 2, most + 1, n[0], &values);
    for (order = 0; !call.failed && order <= most; order++)
        expansion(table, of_table[0], scale, order, n[0], x, values + order * n[0]);
    leave(&call);
    return result;
}

double length_up_to(const Length *length, double x)
{
    double turns = floor(x / (2 * PI)), place = x - turns * (2 * PI), t, before = 0.0, now = 0.0;
    const double *terms;
    Size low = 0, high = length->panels, k;
    while (high - low > 1) { /* the last panel that does not begin behind the place */
        Size middle = (low + high) / 2;
        if (length->start[middle] <= place)
            low = middle;
        else
            high = middle;
    }
    t = 2 * (place - length->start[low]) / length->width[low] - 1;
    t = t < -1 ? -1 : t > 1 ? 1 : t;
    terms = length->series + low * length->terms;
    for (k = length->terms - 1; k > 0; k--) { /* Clenshaw's rule */
        double next = 2 * t * now - before + terms[k];
        before = now;
        now = next;
    }
    return turns * length->whole + t * now - before + terms[0];
}

/* adhesion.integral(start, width, series, whole, x): a Chebyshev series on the panel in which each position lies, and
   `whole` for every turn of the circle. */
DECLARED(integral)
{
    Call call;
    Size of_width[1], of_series[2], n[1], i;
    double *x, *values;
    Length length;
    PyObject *result;
    if (!enter(&call, n_given, 5))
        return NULL;
    length.start = reals(&call, given[0], 1, &length.panels);
    length.width = reals(&call, given[1], 1, of_width);
    length.series = reals(&call, given[2], 2, of_series);
    length.whole = number(&call, given[3]);
    length.terms = of_series[1];
    x = reals(&call, given[4], 1, n);
    expect(&call, length.panels > 0 && of_width[0] == length.panels && of_series[0] == length.panels && length.terms > 0,
           "panels and series differ");
    result = new_reals(&call, 1, n[0], 0, &values);
    for (i = 0; !call.failed && i < n[0]; i++)
        values[i] = length_up_to(&length, x[i]);
    leave(&call);
    return result;
}
