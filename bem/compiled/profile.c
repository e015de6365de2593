/* The profile at given points, and its length: profile.py, adhesion.py. */

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
