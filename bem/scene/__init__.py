"""Scenes and results: from a scene file to the solver, and from the solver to a result file.

A scene file becomes a problem for the solver in this order.

1. `scene.load_scene` reads TOML; `bem.solve` also takes mappings and objects.
2. scene_tables.py: every table becomes a frozen object, which checks types and ranges.  [solid], [layer] and [adhesion]
   are `Solid`, `Layer`, `Adhesion` of bem/geometry, bem/elastic, bem/adhesive.  keys.toml has the words of errors.
3. scene_rules.py: keys that need, exclude or bound one another.  One `SceneError` (scene_error.py) lists all of 2 to 4.
4. The file of a scan is read and prepared (bem/scans), a stored start is read (stored_start.py), and ranges of targets
   are expanded (targets.py).  The result is a frozen `Scene`.
5. Another `SceneError` lists what only the whole scene shows: outputs without a target, numbers out of proportion.
6. bem/solver.py poses the dimensionless problem (bem/problem.py, elastic_tables.py) and follows the path.

Beside this way, effects.py lists the active effects, plausibility.py the warnings and memory_estimate.py the memory,
for `check` and for the result.

A `Result` (result.py) holds states (state.py), events and arrays; result_views.py and plots.py show it.  The solver's
result and a read result pass result_invariants.py alike.  result_file.py writes and reads a finished result, journal.py
a run in the making; both use stored_json.py, stored_arrays.py, provenance.py and atomic_file.py.
"""
