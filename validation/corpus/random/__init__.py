"""Scenes drawn at random from the whole contract of the scene file, and each as a case."""
