"""What the forces on edges, and a descent, are given: taken from Python once a call.  And strides.strides."""


cdef int take_far_field(list held, far, Setting *setting) except -1:
    cdef Py_ssize_t shape[2]
    cdef Py_ssize_t count
    arc = far.arc
    setting.beta, setting.delta = arc.beta, arc.delta
    setting.margins[0], setting.margins[1] = arc.margins
    setting.low, setting.high = arc.limits
    setting.far_penetration = far.penetration
    setting.far_charge = reals(held, far.charge, 1, &count)
    setting.far_table = reals(held, far.table, 2, shape)
    expect(count == 2 and shape[0] > 1 and shape[1] == 4, "a far field: charge (2,) and table (cells + 1, 4)")
    setting.cells = shape[0] - 1
    return 0


cdef int take_charges(list held, potential, Setting *setting) except -1:
    cdef Py_ssize_t of_sources[2]
    cdef Py_ssize_t of_charge
    setting.potential = <void *>potential
    setting.position = reals(held, potential.position, 1, &setting.charges)
    setting.charge = reals(held, potential.charge, 1, &of_charge)
    setting.sources = reals(held, potential._sources, 2, of_sources)
    setting.calls = potential.calls
    return expect(of_charge == of_sources[1] == setting.charges and of_sources[0] == 2, "positions and charges differ")


cdef int take_setting(Call *call, system, double penetration, double tolerance, Setting *setting) except -1:
    held, elastic, law = <list>call.held, system.elastic, system.law
    profile, far, backgrounds, length = elastic.profile, elastic.far, elastic.backgrounds, getattr(law, "length", None)
    setting.call = call
    setting.surface = surface_of(held, profile)
    setting.max_height, setting.max_order, setting.rms_slope = profile.max_height, profile.max_order, profile.rms_slope
    setting.tolerance, setting.penetration = tolerance, penetration
    lists_of_sizes(&setting.lists[0], &setting.lists[1])
    expect(len(backgrounds) < 2, "one background at most")
    if far is not None:
        take_far_field(held, far, setting)
    if backgrounds:
        take_charges(held, backgrounds[0], setting)
    setting.work = law.work
    if length is not None:
        setting.slope_scale = law.slope_scale
        setting.length = length_of(held, length.start, length.width, length.series, length.whole)
    return 0


cdef int take_ahead(list held, profile, ahead, Walk *walk) except -1:
    cdef Py_ssize_t size
    occupied = ahead.occupied
    walk.looks_ahead, walk.allowed = True, ahead.allowed
    crests, _ = profile.crests
    walk.crests = reals(held, crests, 1, &walk.n_crests)
    if occupied is not None:
        walk.occupied_left = reals(held, occupied.left, 1, &walk.n_occupied)
        walk.occupied_right = reals(held, occupied.right, 1, &size)
        expect(size == walk.n_occupied, "edges differ")
    return 0


cdef int take_edges(list held, patches, seen, Walk *walk) except -1:
    """Copied: they move.  The five arrays of the walk stand one behind the other."""
    cdef Py_ssize_t n = len(patches.left), size, k
    cdef double *given
    expect(n > 0, "no patches")
    walk.n, walk.left = n, workspace(5 * n)
    walk.right, walk.seen_left, walk.seen_right = walk.left + n, walk.left + 2 * n, walk.left + 3 * n
    walk.gone = <int64_t *>(walk.left + 4 * n)
    for k, edges in enumerate((patches.left, patches.right, seen.left, seen.right)):
        given = reals(held, edges, 1, &size)
        expect(size == n, "edges differ")
        memcpy(walk.left + k * n, given, <size_t>(n * sizeof(double)))
    return 0


cdef int take_walk(Call *call, given, Walk *walk) except -1:
    cdef Py_ssize_t size
    held, accuracy, steps, profile = <list>call.held, given.accuracy, given.steps, given.system.elastic.profile
    least, ahead = given.least, steps.ahead
    take_setting(call, given.system, given.target, accuracy.tolerance, &walk.setting)
    walk.residual, walk.largest, walk.radius = accuracy.residual, steps.largest, given.radius
    walk.wavelength, walk.rms_curvature = 2 * PI / walk.setting.max_order, profile.rms_curvature
    if least is not None:
        walk.floor.nodes = integers(held, least.nodes, &size)
        walk.floor.modes = integers(held, least.modes, &walk.floor.n)
        expect(size == walk.floor.n, "nodes and modes differ")
    if ahead is not None:
        take_ahead(held, profile, ahead, walk)
    return take_edges(held, given.patches, given.seen, walk)


cdef tuple numbers_of(const State *state, double penetration):
    """strides.Numbers."""
    cdef Py_ssize_t n = state.n, edges = 2 * state.n
    return (penetration, copied(state.intensity, 1, edges), copied(state.rate, 1, edges), state.load, state.load_rate,
            state.elastic_energy, copied(state.compliance, 2, edges, edges), copied(state.edge_slope, 1, edges),
            copied(state.edge_slope_rate, 1, edges), copied(state.series, 2, n, state.terms),
            copied(state.skeleton, 1, state.unknowns), copied(state.skeleton_rate, 1, state.unknowns),
            whole(state.nodes, n), whole(state.modes, n))


cdef dict VERDICTS = {CONVERGED: "converged", TOUCHED: "touched", STUCK: "not_converged",
                      ILL_CONDITIONED: "ill_conditioned", CLOSING: "closing", VANISHING: "vanishing"}


def strides(given):
    """strides.strides of a walk."""
    cdef Call call
    cdef Walk walk
    cdef Py_ssize_t rounds = given.rounds, n
    cdef int verdict
    held = []
    begin(&call, held)
    memset(&walk, 0, sizeof(Walk))
    try:
        take_walk(&call, given, &walk)
        verdict = c_strides(&walk, &rounds)
        n = walk.n
        gone = whole(walk.gone, walk.n_gone) if verdict in (CLOSING, VANISHING) else None
        touching = (None, None, None)
        if verdict == TOUCHED:
            touching = (copied(walk.touching, 1, walk.n_touching), copied(walk.depth, 1, walk.n_touching),
                        whole(walk.in_gap, walk.n_touching))
        return (VERDICTS[verdict], copied(walk.left, 1, n), copied(walk.right, 1, n), copied(walk.seen_left, 1, n),
                copied(walk.seen_right, 1, n), walk.radius, rounds, walk.evaluations,
                numbers_of(&walk.here, walk.setting.penetration) if walk.here.n > 0 else None, gone, *touching)
    finally:
        release_walk(&walk)
