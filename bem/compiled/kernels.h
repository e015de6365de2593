/* The kernels: what Python calls.  Each takes its arguments by position. */

#ifndef LINECONTACT_KERNELS_H
#define LINECONTACT_KERNELS_H

#define DECLARED(name) PyObject *kernel_##name(PyObject *module, PyObject *const *given, Py_ssize_t n_given)

DECLARED(taylor);
DECLARED(sizes);
DECLARED(right_hand_sides);
DECLARED(solved);
DECLARED(stress_intensity_jacobian);
DECLARED(all_charges);
DECLARED(integral);
DECLARED(box_moments);
DECLARED(box_potential);
DECLARED(low_points);
DECLARED(near_patches);
DECLARED(pair_by_pair);
DECLARED(strides);

#endif
