"""Studies: of one scene (own_scene), and of faults put into the code (faults)."""
