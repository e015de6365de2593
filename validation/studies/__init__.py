"""Studies: of one scene (own_scene.py), and of random slips put into the code (mutants.py)."""
