"""Keys of a scene file as text and as JSON Schema, made from the tables (scene_tables.py) and their words (keys.toml).

bem/KEYS.md is the text of all of them; a test keeps it up to date.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import MISSING, fields
from typing import Annotated, Any

from pydantic import ConfigDict, Field, create_model
from pydantic.json_schema import GenerateJsonSchema

from bem.geometry.ranges import Mistake, unknown_key
from bem.geometry.table import allowed, words
from bem.scene.scene_rules import OPTIONAL, REQUIRED
from bem.scene.scene_tables import REQUIRED_TABLES, TABLES, class_of

TYPES = {"number": "number", "integer": "integer", "string": "text", "boolean": "true or false", "array": "list"}
TITLE = "What the scene is about, a text; it stands above its results."
FROM_PYTHON = (
    "From Python (`bem.solve`, `bem.solve_rows`) arrays in m stand in place of `file`: `h` (array, from Python), "
    "heights, missing where NaN or masked; `x` (array, from Python), their positions, or else `spacing` in m. "
    "An `h` of two indices is a map, whose first index runs along x: `row` = 3 is h[:, 3]. "
    'Example: `profile={"kind": "samples", "h": heights, "spacing": 1e-6, "row": 3}`'
)
HEAD = f"""# The keys of a scene file

Made by `linecontact keys`; `linecontact keys SECTION` prints one section. All numbers are in SI units.
For editors: `linecontact schema > linecontact.schema.json` beside the scene, and as its first line
`#:schema ./linecontact.schema.json` (taplo, Even Better TOML).

`title` (text): {TITLE}"""


class UnknownSectionError(ValueError):
    """Section of keys that does not exist."""


class _OfToml(GenerateJsonSchema):
    """Schemas of files that have no null: a key is present or absent."""

    def nullable_schema(self, schema: Any) -> dict[str, Any]:
        """Return the schema of the value without null."""
        return self.generate_inner(schema["schema"])

    def default_schema(self, schema: Any) -> dict[str, Any]:
        """Return the schema with its default, if that is a value."""
        made = super().default_schema(schema)
        return {key: value for key, value in made.items() if key != "default" or value is not None}


def json_schema() -> dict[str, Any]:
    """Return the JSON Schema (draft 2020-12) of a scene file, with descriptions for editors to show.

    Examples
    --------
    >>> json_schema()["required"]
    ['solid', 'profile', 'loading']
    """
    tables: dict[str, Any] = {name: (class_of(name), ... if name in REQUIRED_TABLES else None) for name in TABLES}
    title: Any = (Annotated[str, Field(description=TITLE, examples=["Steel on a ground seal"])], "")
    scene = create_model("Scene", __config__=ConfigDict(extra="forbid"), title=title, **tables)
    schema = scene.model_json_schema(schema_generator=_OfToml)
    for name in TABLES:
        table = schema["$defs"][class_of(name).__name__]
        table["description"] = words()[name]["about"]
        for key, shape in table["properties"].items():
            shape |= {"description": _description(name, key), "examples": [words()[name][key]["example"]]}
            shape.pop("title", None)
    return schema | {"$schema": GenerateJsonSchema.schema_dialect, "title": "A scene of linecontact"}


def keys_text(section: str | None = None) -> str:
    """Return all keys of a section, or of all sections, as Markdown that a terminal shows as well.

    Raises
    ------
    UnknownSectionError
        With what is allowed.

    Examples
    --------
    >>> print(keys_text("layer"))
    ## [layer]
    <BLANKLINE>
    The body is a layer bonded to a rigid plate; without this table it is a half-space. It may be absent.
    <BLANKLINE>
    - `thickness` (number, m): Thickness of the layer.
      Allowed: a finite number > 0, from 1e-60 to 1e+60 (m). Needed.
      Example: `thickness = 0.001`
    """
    schema = json_schema()["$defs"]
    if section is None:
        return "\n\n".join([HEAD, *("\n".join(_section(name, schema)) for name in TABLES)])
    name = section.strip("[]")
    if name not in TABLES:
        raise UnknownSectionError(str(Mistake("section", f"[{name}] is unknown", unknown_key(name, TABLES))))
    return "\n".join(_section(name, schema))


def _section(name: str, schema: Mapping[str, Any]) -> Iterator[str]:
    """Yield the lines of one section; `schema` has the tables by the names of their classes."""
    yield from (f"## [{name}]", "")
    yield f"{words()[name]['about']} It {'is needed' if name in REQUIRED_TABLES else 'may be absent'}."
    yield ""
    for key, shape in schema[class_of(name).__name__]["properties"].items():
        entry = words()[name][key]
        kind = " or ".join(dict.fromkeys(_types(shape))) + (f", {entry['unit']}" if "unit" in entry else "")
        does, _, rest = _description(name, key).partition(" Allowed: ")
        yield f"- `{key}` ({kind}): {does}"
        yield f"  Allowed: {rest}"
        yield f"  Example: `{key} = {toml(entry['example'])}`"
    if name == "profile":
        yield from ("", FROM_PYTHON)


def _types(shape: Mapping[str, Any]) -> Iterator[str]:
    """Yield the types that a value may have, in words."""
    if "anyOf" in shape:
        for alternative in shape["anyOf"]:
            yield from _types(alternative)
    elif "$ref" in shape:
        yield "table"
    else:
        yield TYPES[shape["type"]]


def _description(name: str, key: str) -> str:
    """Return the purpose of a key, its allowed values, its default, and the kinds of profile that use it."""
    entry = words()[name][key]
    (default,) = (item.default for item in fields(class_of(name)) if item.name == key)
    sentences = [entry["does"], f"Allowed: {allowed(f'{name}.{key}')}."]
    absent = entry.get("absent") or ("" if default in (None, (), MISSING) else toml(default))
    uses = []
    if name == "profile" and default is not MISSING:
        for word, rule in (("Needed by", REQUIRED), ("Optional with", OPTIONAL)):
            kinds = " or ".join(f'"{kind}"' for kind in rule if key in rule[kind])
            uses += [f"{word} kind = {kinds}."] if kinds else []
    if default is MISSING:
        uses.append("Needed.")
    elif absent or not uses:
        uses.append(f"Default: {absent or 'none'}.")
    return " ".join(sentences + uses)


def toml(value: Any) -> str:
    """Return a short value as in a scene file.

    Examples
    --------
    >>> toml([2.1e11, 0.5]), toml("mean"), toml(True)
    ('[2.1e+11, 0.5]', '"mean"', 'true')
    """
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(toml, value)) + "]"
    return f"{value:g}" if isinstance(value, float) else json.dumps(value)
