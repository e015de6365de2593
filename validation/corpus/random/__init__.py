"""Scenes drawn at random from the whole contract of the scene file, and what any result must obey."""
