"""The scene file with its rules, the effects it names, and the result with its files."""
