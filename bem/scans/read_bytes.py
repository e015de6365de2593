"""Bytes of a scan's file, and the text in them if they are text.

Encodings: UTF-8, UTF-16 and UTF-32 with a byte order mark; without one, UTF-8 or Latin-1.  A file with a zero byte and
no mark is not text.
"""

from __future__ import annotations

import codecs
from pathlib import Path

from bem.geometry.regular_file import read_regular
from bem.scans.scan_file_error import refused

MARKS = (
    (codecs.BOM_UTF8, "utf-8"),
    (codecs.BOM_UTF32_LE, "utf-32-le"),  # before UTF-16, whose mark begins it
    (codecs.BOM_UTF32_BE, "utf-32-be"),
    (codecs.BOM_UTF16_LE, "utf-16-le"),
    (codecs.BOM_UTF16_BE, "utf-16-be"),
)
BACKSLASHES = "backslashes in single quotes, 'C:\\Users\\me\\scan.csv', or with / instead"  # in names of files
TEXT_OR_INSTRUMENT = "a text file, or a file of an instrument"


def content_of(path: Path) -> bytes:
    """Return the bytes of a file; ScanFileError if the file cannot be read or is not a regular file."""
    try:
        return read_regular(path)
    except OSError as error:
        reason = f"cannot be read: {error.strerror or error}"
        if not str(path).isprintable():  # TOML reads the backslash and the t of C:\temp as a tab
            raise refused("file", f"{reason}; its name holds a tab or the like", f"names with {BACKSLASHES}") from error
        raise refused("file", reason, TEXT_OR_INSTRUMENT) from error
    except ValueError as error:  # a zero byte in the name
        raise refused("file", f"is no name of a file: {error}", TEXT_OR_INSTRUMENT) from error


def text_of(content: bytes) -> tuple[str, str] | None:
    """Return the text and its encoding; None where the bytes are not text.

    Examples
    --------
    >>> text_of(b"0 1\\n"), text_of("1 µm".encode("utf-16")), text_of(b"GWYP\\x00 1")
    (('0 1\\n', 'utf-8'), ('1 µm', 'utf-16-le'), None)
    """
    for mark, encoding in MARKS:
        if content.startswith(mark):
            return _decoded(content[len(mark) :], encoding)
    return _decoded(content, "utf-8") or _decoded(content, "latin-1")


def _decoded(content: bytes, encoding: str) -> tuple[str, str] | None:
    """Return the decoded text with its encoding; None if the bytes are no text in the encoding."""
    try:
        text = content.decode(encoding)
    except UnicodeDecodeError:
        return None
    return None if "\x00" in text else (text, encoding)
