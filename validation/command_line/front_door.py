"""The command `linecontact`: commands of a scene go straight to the solver, all others through commands.py.

Commands of a scene do not load the verification, which takes longer than a small scene.
"""

import gc
import sys
from collections.abc import Sequence
from importlib import import_module

OF_A_SCENE = ("check", "run", "keys", "schema")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command, by default the command in `sys.argv`, and return its exit code."""
    if arguments is None:  # imports leave no garbage, and what they make lives until the end: a tenth of a small run
        gc.disable()
    words = sys.argv[1:] if arguments is None else arguments
    of_a_scene = bool(words) and words[0] in OF_A_SCENE
    commands = import_module("bem.scene_commands" if of_a_scene else "validation.command_line.commands")
    if arguments is None:
        gc.freeze()
        gc.enable()
    return int(commands.main(words))


if __name__ == "__main__":
    sys.exit(main())
