"""The bytes of a scan's file, and the text in them, if they are text.

Encodings: UTF-8, UTF-16 and UTF-32 by their marks; UTF-16 without one where every zero byte is the same half of a
character, and all characters can be printed; else UTF-8 or Latin-1.  Zero bytes (padding) and Control-Z (the end of a
file in DOS) after the text are ignored; with any other zero byte the file is not text.
"""

from __future__ import annotations

import codecs
import stat
from pathlib import Path

from bem.scans.scan_refusal import Refusal, ScanFileError

MARKS = (
    (codecs.BOM_UTF8, "utf-8"),
    (codecs.BOM_UTF32_LE, "utf-32-le"),  # before UTF-16, whose mark begins it
    (codecs.BOM_UTF32_BE, "utf-32-be"),
    (codecs.BOM_UTF16_LE, "utf-16-le"),
    (codecs.BOM_UTF16_BE, "utf-16-be"),
)
PACKED = {b"\x1f\x8b": "gzip", b"BZh": "bzip2", b"\xfd7zXZ": "xz", b"\x28\xb5\x2f\xfd": "zstd", b"7z\xbc\xaf": "7-Zip"}
TEXT_OR_INSTRUMENT = "a text file, or one of an instrument"


def content_of(path: Path) -> bytes:
    """The bytes of a file; ScanFileError if it cannot be read, is not a regular file, or is compressed."""
    try:
        mode = path.stat().st_mode
        content = path.read_bytes() if stat.S_ISREG(mode) else b""
    except OSError as error:
        found = f"cannot be read: {error.strerror or error}"
        raise ScanFileError([Refusal("file", found, TEXT_OR_INSTRUMENT)]) from error
    except ValueError as error:  # a zero byte in the name
        raise ScanFileError([Refusal("file", f"is no name of a file: {error}", TEXT_OR_INSTRUMENT)]) from error
    if not stat.S_ISREG(mode):
        found = "is a folder" if stat.S_ISDIR(mode) else "is a device or a pipe"
        raise ScanFileError([Refusal("file", found, TEXT_OR_INSTRUMENT)])
    for first, packed in PACKED.items():
        if content.startswith(first):
            raise ScanFileError([Refusal("file", f"is compressed ({packed})", "the file in it: unpack it")])
    return content


def text_of(content: bytes) -> tuple[str, str] | None:
    """The text and its encoding; None where the bytes are no text.

    Examples
    --------
    >>> text_of(b"0 1\\n\\x00\\x00"), text_of("1 µm".encode("utf-16-be")), text_of(b"GWYP\\x00 1")
    (('0 1\\n', 'utf-8'), ('1 µm', 'utf-16-be'), None)
    """
    for mark, encoding in MARKS:
        if content.startswith(mark):
            return _read(content[len(mark) :], encoding)
    bare = content.rstrip(b"\x00")
    for first, encoding in enumerate(("utf-16-be", "utf-16-le")):
        half, other = bare[first::2], bare[1 - first :: 2]
        if 2 * half.count(0) > len(half) and 0 not in other:
            found = _read(content if len(content) % 2 == 0 else content.removesuffix(b"\x00"), encoding)
            return found if found is not None and _printed(found[0]) else None
    return _read(content, "utf-8") or _read(content, "latin-1")


def _read(content: bytes, encoding: str) -> tuple[str, str] | None:
    """The bytes decoded by an encoding; None if they are not text in it."""
    try:
        text = content.decode(encoding).rstrip("\x00\x1a")
    except UnicodeDecodeError:
        return None
    return None if "\x00" in text or (content and not text) else (text, encoding)


def _printed(text: str) -> bool:
    """Whether all characters of a text can be printed, or part lines and columns."""
    return all(line.replace("\t", " ").isprintable() for line in text.splitlines())
