"""Studies: of one scene (own_scene.py), and of faults put into the code (faults)."""
