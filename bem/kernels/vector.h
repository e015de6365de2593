/* Innermost loops of the kernels that need vector instructions, and log|x| in a form that compilers vectorise.

   Where the compiler has target_clones, each loop is compiled for three sets of instructions, and the loader chooses;
   elsewhere it is plain C.  Loops over LANES points are unrolled by the compiler.  Formulas stand in the .pyx files. */

#ifndef LINECONTACT_VECTOR_H
#define LINECONTACT_VECTOR_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__) && (defined(__clang__) || __GNUC__ >= 12)
#define VECTORISED __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define VECTORISED
#endif

#if defined(_MSC_VER)
#define RESTRICT __restrict
#else
#define RESTRICT restrict
#endif

typedef ptrdiff_t Size;

enum { LANES = 8, TERMS = 14, SINE_TERMS = 11 }; /* TERMS: columns of a Taylor table; (pi/2)^23 / 23! = 1e-18 */
static const double CIRCLE = 6.28318530717958647693;

/* One of two numbers, by a mask of ones or zeros: compilers do not vectorise loops in which a branch chooses. */
static inline double chosen(int64_t mask, double one, double other)
{
    uint64_t a, b;
    double result;
    memcpy(&a, &one, 8);
    memcpy(&b, &other, 8);
    a = (a & (uint64_t)mask) | (b & ~(uint64_t)mask);
    memcpy(&result, &a, 8);
    return result;
}

/* log|x|, -inf at 0 and below the smallest normal number; at most 2.3e-16 of itself off (measured).  With
   |x| = 2^k (1 + f), 1 + f between the roots of 1/2 and 2, and s = f / (2 + f): log(1 + f) = f - s (f - r),
   r = 2 s^2 (1/3 + s^2/5 + ...), of which the bracket is its best polynomial of degree 6 in s^2 < 0.0295, 1.3e-18 of
   the logarithm off. */
static inline double log_of_size(double x)
{
    const int64_t root_half = INT64_C(0x3fe6a09e667f3bcd), one = INT64_C(0x3ff0000000000000);
    int64_t bits, shifted, whole;
    double f, k, s, z, r, result;
    memcpy(&bits, &x, 8);
    bits &= INT64_C(0x7fffffffffffffff);
    shifted = (int64_t)((uint64_t)bits + (uint64_t)(one - root_half)); /* of NaN it wraps */
    whole = (int64_t)((uint64_t)shifted >> 52) | INT64_C(0x4330000000000000);
    memcpy(&k, &whole, 8);
    k -= 4503599627370496.0 + 1023.0;
    whole = (shifted & INT64_C(0x000fffffffffffff)) + root_half;
    memcpy(&f, &whole, 8);
    f -= 1.0;
    s = f / (2.0 + f);
    z = s * s;
    r = 0.07397737579001104;
    r = r * z + 0.07657049412487062;
    r = r * z + 0.09091781203055785;
    r = r * z + 0.11111099305374668;
    r = r * z + 0.14285714371008035;
    r = r * z + 0.19999999999708185;
    r = r * z + 0.3333333333333367;
    r = 2.0 * z * r;
    result = k * 6.93147180369123816490e-01 + (f - (s * (f - r) - k * 1.90821492927058770002e-10));
    result = chosen(-(int64_t)(bits > INT64_C(0x7fefffffffffffff)), x * x, result);
    return chosen(-(int64_t)(bits < INT64_C(0x0010000000000000)), -HUGE_VAL, result);
}

/* uniform - log|a_i f + b_i s| at n points. */
VECTORISED static inline void log_row(Size n, const double *RESTRICT a, const double *RESTRICT b, double f, double s,
                               double uniform, double *RESTRICT values)
{
    Size i;
    for (i = 0; i < n; i++)
        values[i] = uniform - log_of_size(a[i] * f + b[i] * s);
}

/* log|u_i| - log|m_i|, and (log|u_i| + log|m_i| + constant) / 2, in their place. */
VECTORISED static inline void log_ratio_and_mean(Size n, double constant, double *RESTRICT u, double *RESTRICT m)
{
    Size i;
    for (i = 0; i < n; i++) {
        double first = log_of_size(u[i]), second = log_of_size(m[i]);
        u[i] = first - second;
        m[i] = (first + second + constant) / 2;
    }
}

/* rest - moment_i - log sinc(r (t_i - t)/2) at n nodes, by its series in ((r / (2 pi)) (t_i - t))^2. */
VECTORISED static inline void series_row(Size n, double unit, double t, const double *RESTRICT nodes,
                                         const double *RESTRICT moments, double rest, double *RESTRICT values)
{
    /* zeta(2 k) / k, k = 1 ... 8: log(sin y / y) = -sum_k zeta(2 k) (y / pi)^(2 k) / k */
    static const double zeta_over[8] = {1.6449340668482264,  0.5411616168555691, 0.33911435399481643,
                                        0.2510193390494861,  0.20019891502556358, 0.166707681092218,
                                        0.1428658925907227, 0.12500191028242608};
    Size i, k;
    for (i = 0; i < n; i++) {
        double apart = unit * (nodes[i] - t), square = apart * apart, sum = 0.0;
        for (k = 7; k >= 0; k--)
            sum = (sum + zeta_over[k]) * square;
        values[i] = rest - moments[i] + sum;
    }
}

/* T_0 to T_(count - 1) at n points, (count, n): real parts of the powers of exp(i arccos t); `work` holds 2 n numbers. */
VECTORISED static inline void polynomials(Size n, Size count, const double *RESTRICT t, double *RESTRICT values,
                                          double *RESTRICT work)
{
    double *RESTRICT sine = work, *RESTRICT imaginary = work + n;
    Size i, k;
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

/* sum_k charge_k log|a f_k + b s_k| at LANES points. */
VECTORISED static inline void sum_logs(Size n, const double *RESTRICT a, const double *RESTRICT b, const double *RESTRICT f,
                                const double *RESTRICT s, const double *RESTRICT charge, double *RESTRICT values)
{
    double sum[LANES] = {0};
    Size i, k;
    for (k = 0; k < n; k++)
        for (i = 0; i < LANES; i++)
            sum[i] += charge[k] * log_of_size(a[i] * f[k] + b[i] * s[k]);
    memcpy(values, sum, sizeof sum);
}

/* sums_j += sum_k factor_k matrix_kj, (n, n). */
VECTORISED static inline void add_rows(Size n, const double *RESTRICT factors, const double *RESTRICT matrix,
                                       double *RESTRICT sums)
{
    Size j, k;
    for (k = 0; k < n; k++)
        for (j = 0; j < n; j++)
            sums[j] += factors[k] * matrix[k * n + j];
}

/* Row of a Taylor table and offset from its grid point, both in units of its spacing. */
static inline const double *nearest_row(const double *table, Size rows, double place, double *offset)
{
    double nearest = nearbyint(place);
    int64_t row = (int64_t)nearest % rows;
    *offset = place - nearest;
    return table + TERMS * (row < 0 ? row + rows : row);
}

/* unit sum_(k >= order) factor_k row_k offset^(k - order) at n points, of the rows nearest to them. */
VECTORISED static inline void expand(const double *RESTRICT table, Size rows, double spacing_inverse, Size order,
                              const double *RESTRICT factors, double unit, Size n, const double *RESTRICT x,
                              double *RESTRICT values)
{
    Size i, k;
    for (i = 0; i < n; i++) {
        double offset, total;
        const double *row = nearest_row(table, rows, x[i] * spacing_inverse, &offset);
        total = factors[TERMS - 1] * row[TERMS - 1];
        for (k = TERMS - 2; k >= order; k--)
            total = total * offset + factors[k] * row[k];
        values[i] = total * unit;
    }
}

/* -pi (log|2 zeta| Q_0 + sum_n Q_n zeta^n / n) - sum_k y_k log|t - t_k| of one patch at LANES points beside it, t half
   widths from its center; the series has as many terms as the nearest of the points sees. */
VECTORISED static inline void beside_patch(const double *RESTRICT t, Size terms, const double *RESTRICT charges, Size n,
                                    const double *RESTRICT nodes, const double *RESTRICT skeleton, double negligible,
                                    double *RESTRICT values)
{
    double zeta[LANES], sum[LANES] = {0}, coarse[LANES] = {0}, nearest = 0.0, most;
    Size i, k;
    for (k = 0; k < LANES; k++) { /* rounding may put a point on the edge into the patch */
        double outside = fabs(t[k]) < 1 ? copysign(1.0, t[k]) : t[k];
        zeta[k] = 1 / (outside + copysign(sqrt((outside - 1) * (outside + 1)), outside));
        nearest = fabs(zeta[k]) > nearest ? fabs(zeta[k]) : nearest;
    }
    most = negligible / log(nearest - 1e-16);
    for (i = most < (double)(terms - 1) ? (Size)ceil(most) : terms - 1; i > 0; i--) {
        double term = charges[i] / (double)i;
        for (k = 0; k < LANES; k++)
            sum[k] = (sum[k] + term) * zeta[k];
    }
    for (i = 0; i < n; i++)
        for (k = 0; k < LANES; k++)
            coarse[k] += skeleton[i] * log_of_size(t[k] - nodes[i]);
    for (k = 0; k < LANES; k++)
        values[k] = -CIRCLE / 2 * (log_of_size(2 * zeta[k]) * charges[0] + sum[k]) - coarse[k];
}

/* Points x = right + width (1 - sin(pi t / 2)) / 2 and sum_k series_k T_k(t) there, t = 1 - (2 column + 1) / size. */
VECTORISED static inline void at_columns(const int64_t *RESTRICT column, double right, double width, double size, Size terms,
                                  const double *RESTRICT series, double *RESTRICT x, double *RESTRICT u)
{
    double t[LANES], sine[LANES], before[LANES] = {0}, last[LANES] = {0};
    Size i, k;
    for (i = 0; i < LANES; i++) {
        t[i] = 1 - (double)(2 * column[i] + 1) / size;
        sine[i] = 1.0;
    }
    for (k = SINE_TERMS - 1; k > 0; k--) {
        double factor = CIRCLE * CIRCLE / (double)(32 * k * (2 * k + 1));
        for (i = 0; i < LANES; i++)
            sine[i] = 1.0 - factor * t[i] * t[i] * sine[i];
    }
    for (k = terms - 1; k > 0; k--)
        for (i = 0; i < LANES; i++) {
            double next = 2 * t[i] * last[i] + (series[k] - before[i]); /* one operation waits for the last */
            before[i] = last[i];
            last[i] = next;
        }
    for (i = 0; i < LANES; i++) {
        x[i] = right + width * (0.5 - CIRCLE / 8 * t[i] * sine[i]);
        u[i] = series[0] + t[i] * last[i] - before[i];
    }
}

#endif
