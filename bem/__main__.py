"""Alias `python -m bem` of the commands that `linecontact` has for a scene: check, run, keys, schema."""

import sys

from bem.scene_commands import main

if __name__ == "__main__":
    sys.exit(main())
