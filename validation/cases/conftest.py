"""Plugin of the verification, for `python -m pytest validation/cases`."""

pytest_plugins = ["validation.plugin.hooks"]
