"""Run of a parsed command: its exit code, and one line on stderr for every error.

Exit codes: 0 done, 1 a failure named in the output, 2 bad input, 130 interrupted with everything finished saved.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable

from bem.command_line.checkpoint import OutputFolderError, interruptible
from bem.command_line.console import usable_streams
from bem.command_line.folder_lock import FolderError
from bem.scene.scene_error import SceneError

DONE, FAILED, BAD_INPUT, INTERRUPTED = 0, 1, 2, 130  # format: exit codes
REFUSED: tuple[type[Exception], ...] = (SceneError, OutputFolderError, FolderError)  # by every command


def perform(options: argparse.Namespace, refused: tuple[type[Exception], ...] = REFUSED) -> int:
    """Run `options.command` and return its exit code; errors of the types `refused` are bad input."""
    command: Callable[[argparse.Namespace], int] = options.command
    usable_streams()
    os.environ.pop("MPLBACKEND", None)  # figures have a canvas of their own, and Matplotlib refuses an unknown name
    try:
        with interruptible():
            code = int(command(options))
        print(end="", flush=True)  # a full disk fails here, where the error has a name
        return code
    except refused as error:
        print(f"error: {error}", file=sys.stderr)
        return BAD_INPUT
    except (FileExistsError, IsADirectoryError, NotADirectoryError) as error:
        print(f"error: {error.filename}: {error.strerror}", file=sys.stderr)
        return BAD_INPUT
    except KeyboardInterrupt:
        print("interrupted; what was finished is kept, the same command continues", file=sys.stderr)
        return INTERRUPTED
    except BrokenPipeError:  # the reader of stdout, such as `head`, has enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return FAILED
    except OSError as error:
        print(f"error: {error}", file=sys.stderr)
        return FAILED
