"""What the kernels in C are called by: those parts of the headers here that linecontact_kernels.pyx needs."""

from libc.stdint cimport int64_t

cdef extern from "core.h":
    enum: TERMS
    const double PI
    ctypedef enum Packing:
        OF_NODES
        OF_MODES
    ctypedef struct Table:
        Py_ssize_t start, n
        const double *nodes
        const double *transform
        const double *at_edges
        const double *slopes
        const double *values
        const double *moments
    ctypedef struct Call:
        void *held
        Py_ssize_t n_tables[2]
    ctypedef struct Blas:
        void *dgemm
        void *dgemv
        void *dsyrk
        void *dtrsm
        void *dpotrf
        void *dpstrf
    Blas blas
    double *workspace(Py_ssize_t n) except NULL
    bint tables_of(Call *call, Packing packing, const int64_t *sizes, Py_ssize_t count, Table *tables) except 0
    void expansion(const double *table, Py_ssize_t rows, double spacing_inverse, int order, Py_ssize_t n,
                   const double *x, double *values)

cdef extern from "hierarchical.h":
    ctypedef struct Range:
        Py_ssize_t count, even, q
        const double *modes
        const double *core
    ctypedef struct Asked:
        int (*table)(object held, Packing packing, Py_ssize_t n, Table *table) except -1
        int (*range)(object held, Py_ssize_t steps, double accuracy, Range *range) except -1
        int (*coefficients)(Py_ssize_t n, double *samples) except -1
    Asked asked
    ctypedef struct System:
        Call *call
        Py_ssize_t n, largest, per_patch
        const double *x
        const double *left
        const double *right
        const double *half_width
        const double *addition
        const double *edge_fields
        const Table *tables
        double uniform, accuracy
    ctypedef enum Status:
        SOLVED
    Status solved_system(System *system, Py_ssize_t patches, Py_ssize_t k, const double *columns,
                         double **made) except? <Status>-1

cdef extern from "kernels.h":
    enum: BOX_TERMS
    ctypedef struct Sizes:
        pass
    void lists_of_sizes(Sizes *modes, Sizes *nodes)
    bint sizes_of(const Sizes *lists, Py_ssize_t n, const double *left, const double *right, double digits, double order,
                  const double *least, int64_t *nodes, int64_t *modes)
    ctypedef struct Surface:
        const double *table
        Py_ssize_t rows
        double scale
    ctypedef struct RightHandSides:
        double *series
        double *x
        double *columns
        double *tail
        double *energy
    Py_ssize_t most_nodes(Py_ssize_t n, const Table *sampling, const Table *coupled) except 0
    bint c_right_hand_sides "right_hand_sides"(
        const Surface *surface, Py_ssize_t n, const double *left, const double *right, double level,
        const Table *sampling, const Table *coupled, Py_ssize_t most, const RightHandSides *to) except 0
    void charges_of_modes(const Table *tables, Py_ssize_t patches, Py_ssize_t terms, const double *series,
                          const double *skeleton, double *charges)
    bint jacobian_of(Py_ssize_t n, const double *half_width, const int64_t *modes, const double *intensity,
                     const double *compliance, const double *slope, double *values) except 0
    void add_near_patches(Py_ssize_t patches, const double *center, const double *half_width, const int64_t *nodes,
                          const Table *tables, Py_ssize_t terms, const double *charges, const double *skeleton,
                          Py_ssize_t n, const int64_t *gap, const double *x, double *values)
    Py_ssize_t c_low_points "low_points"(
        Py_ssize_t gaps, const double *right, const double *width, const int64_t *sizes, const int64_t *counts,
        const double *samples, Py_ssize_t rows, const double *table, Py_ssize_t n_highest, const double *highest,
        double level, double *found) except -1
    bint moments_of_boxes(Py_ssize_t n, const double *position, const double *charge, Py_ssize_t boxes,
                          double *moments) except 0
    void pairs_potential(Py_ssize_t n, const double *points, Py_ssize_t m, const double *sources, const double *charge,
                         double *values)
    bint boxes_potential(Py_ssize_t n, const double *x, const double *points, Py_ssize_t m, const double *position,
                         const double *sources, const double *charge, Py_ssize_t boxes, const double *series,
                         double *values) except 0
    ctypedef struct Length:
        Py_ssize_t panels, terms
        const double *start
        const double *width
        const double *series
        double whole
    double length_up_to(const Length *length, double x)
