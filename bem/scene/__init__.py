"""Scenes and results: from a scene file to the solver, and from the solver to a result file.

A scene file becomes a problem for the solver in this order.

1. scene_file.py reads TOML; `bem.solve` also takes mappings and objects (`scene.scene_of`).
2. scene_tables.py: every table becomes a frozen object, which checks types and ranges.  [solid], [layer] and [adhesion]
   are `Solid`, `Layer`, `Adhesion` of bem/geometry, bem/elastic, bem/adhesive.  keys.toml has the words of errors.
3. scene_rules.py: keys that need, exclude or bound one another.
4. scene_scan.py has a scan read and prepared (bem/scans), stored_start.py reads a stored start.  One `SceneError`
   (scene_error.py) lists all mistakes of 2 to 4.
5. scene.py expands ranges of targets (targets.py); the result is a frozen `Scene`, whose profile surface.py makes.
   Another `SceneError` lists what only the whole scene shows: outputs without a target, numbers out of proportion
   (magnitudes.py).
6. bem/solver.py poses the dimensionless problem (bem/problem.py, elastic_tables.py) and follows the path.

effects.py lists the active effects and plausibility.py the warnings, for `check` and for the result.
memory_estimate.py tells `check` the memory, and refuses a run beyond that of the machine.

A `Result` (result.py) holds states (state.py), events and arrays (array_names.py); result_views.py and plots.py show
it.  The solver's result and a read result are judged by result_invariants.py alike.  result_file.py writes and reads a
finished result, journal.py a run in the making; both use stored_json.py, stored_arrays.py, digest.py and
atomic_file.py.  provenance.py has versions and date, progress.py what a run tells on its way.
"""
