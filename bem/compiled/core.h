/* What the kernels share: tables of patches, BLAS and LAPACK, a logarithm that vectorises. */

#ifndef LINECONTACT_CORE_H
#define LINECONTACT_CORE_H

#include <Python.h>
#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

typedef Py_ssize_t Size;

#define PI 3.14159265358979323846

/* Loops compiled for the vector instructions of a processor, chosen when the extension is loaded. */
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && defined(__GLIBC__)
#if __GNUC__ >= 12
#define VECTORISED __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define VECTORISED __attribute__((target_clones("avx512f", "avx2", "default")))
#endif
#else
#define VECTORISED
#endif

#if defined(_MSC_VER)
#define RESTRICT __restrict
#else
#define RESTRICT restrict
#endif

#define MOST_SIZES 256 /* of a list of sizes: up to 1e9 in steps of 1.15 there are 139 */

/* Tables of n Gauss-Chebyshev nodes: of chebyshev.packed_nodes the first two, `transform` NULL where there is none; of
   chebyshev.packed_basis all but that.  `start` counts the nodes of the patches before, behind the last one all. */
typedef struct {
    Size start, n;
    const double *nodes, *transform, *at_edges, *slopes, *values, *moments;
} Table;

typedef enum { OF_NODES, OF_MODES } Packing;

/* One call from Python: a list that holds its arrays until it returns, and the tables that it has asked for. */
typedef struct {
    PyObject *held;
    Size n_tables[2];
    Table tables[2][MOST_SIZES]; /* by their packing */
} Call;

double *workspace(Size n); /* malloc; NULL with an exception */

/* The tables of each of `count` patches, and one behind them; 0 with an exception. */
int tables_of(Call *call, Packing packing, const int64_t *sizes, Size count, Table *tables);

/* BLAS and LAPACK of SciPy; matrices by columns. */
typedef struct {
    void (*dgemm)(char *, char *, int *, int *, int *, double *, double *, int *, double *, int *, double *, double *,
                  int *);
    void (*dgemv)(char *, int *, int *, double *, double *, int *, double *, int *, double *, double *, int *);
    void (*dsyrk)(char *, char *, int *, int *, double *, double *, int *, double *, double *, int *);
    void (*dtrsm)(char *, char *, char *, char *, int *, int *, double *, double *, int *, double *, int *);
    void (*dpotrf)(char *, int *, double *, int *, int *);
    void (*dpstrf)(char *, int *, double *, int *, int *, int *, double *, double *, int *);
} Blas;

extern Blas blas;

/* C = alpha op(A) op(B) + beta C, C of m rows and n columns, k terms. */
static inline void product(char ta, char tb, Size m, Size n, Size k, double alpha, const double *a, Size lda,
                           const double *b, Size ldb, double beta, double *c, Size ldc)
{
    int im = (int)m, in = (int)n, ik = (int)k, ia = (int)lda, ib = (int)ldb, ic = (int)ldc;
    if (m > 0 && n > 0)
        blas.dgemm(&ta, &tb, &im, &in, &ik, &alpha, (double *)a, &ia, (double *)b, &ib, &beta, c, &ic);
}

/* y = alpha op(A) x + beta y, A of m rows and n columns. */
static inline void times(char ta, Size m, Size n, double alpha, const double *a, Size lda, const double *x, double beta,
                         double *y)
{
    int im = (int)m, in = (int)n, ia = (int)lda, one = 1;
    blas.dgemv(&ta, &im, &in, &alpha, (double *)a, &ia, (double *)x, &one, &beta, y, &one);
}

/* X op(L) = B on side 'R', or op(L) X = B on 'L', for a lower triangle L, in place; B of m rows and n columns.  On 'R',
   and with lower triangles, BLAS takes two thirds of the time (measured). */
static inline void solve_lower(char side, char ta, Size m, Size n, const double *l, Size ldl, double *b, Size ldb)
{
    char lower = 'L', non_unit = 'N';
    int im = (int)m, in = (int)n, il = (int)ldl, ib = (int)ldb;
    double one = 1.0;
    if (m > 0 && n > 0)
        blas.dtrsm(&side, &lower, &ta, &non_unit, &im, &in, &one, (double *)l, &il, b, &ib);
}

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

#define TERMS 14 /* of the Taylor table of a profile: profile._TAYLOR_TERMS */

/* A derivative of the profile at n points from its table (profile.c). */
void expansion(const double *table, Size rows, double spacing_inverse, int order, Size n, const double *x,
               double *values);

/* Row of the table and offset from its grid point, in units of its spacing. */
static inline const double *nearest_row(const double *table, Size rows, double place, double *offset)
{
    double nearest = nearbyint(place);
    int64_t row = (int64_t)nearest % rows;
    *offset = place - nearest;
    return table + TERMS * (row < 0 ? row + rows : row);
}

/* The profile at a place, in units of the spacing of its table. */
static inline double height_at(const double *table, Size rows, double place)
{
    double offset, total;
    const double *row = nearest_row(table, rows, place, &offset);
    int k;
    for (total = row[TERMS - 1], k = TERMS - 2; k >= 0; k--)
        total = total * offset + row[k];
    return total;
}

/* Profile.rise: what the profile rises by over a step from a place, both in units of the spacing of its table. */
static inline double rise_over(const double *table, Size rows, double place, double step)
{
    double offset, power = 1.0, difference = 0.0, total = 0.0;
    const double *row = nearest_row(table, rows, place, &offset);
    int k;
    for (k = 1; k < TERMS; k++) {
        difference = (offset + step) * difference + step * power;
        power *= offset;
        total += row[k] * difference;
    }
    return total;
}

#endif
