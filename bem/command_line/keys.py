"""The keys of a scene file as text and as JSON Schema, both made from the models that check scenes.

bem/KEYS.md is the text of all of them; a test keeps it the same.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Annotated, Any

from pydantic import ConfigDict, Field, create_model
from pydantic.json_schema import GenerateJsonSchema

from bem.geometry.ranges import Mistake
from bem.scene.scene_rules import OPTIONAL, REQUIRED, unknown_key
from bem.scene.scene_tables import REQUIRED_TABLES, TABLES, TITLE, Table, said_of

TYPES = {"number": "number", "integer": "integer", "string": "text", "boolean": "true or false", "array": "list"}
HEAD = """# The keys of a scene file

Made by `linecontact keys`; `linecontact keys SECTION` prints one section. All numbers are in SI units.
For editors: `linecontact schema > linecontact.schema.json` beside the scene, and as its first line
`#:schema ./linecontact.schema.json` (taplo, Even Better TOML).

`title` (text): """


class UnknownSectionError(ValueError):
    """There is no such section."""


class _OfToml(GenerateJsonSchema):
    """Schemas of files that have no null: a key is there, or it is not."""

    def nullable_schema(self, schema: Any) -> dict[str, Any]:
        """What is there where the key is."""
        return self.generate_inner(schema["schema"])

    def default_schema(self, schema: Any) -> dict[str, Any]:
        """The default, if there is one."""
        found = super().default_schema(schema)
        return {key: value for key, value in found.items() if key != "default" or value is not None}


def json_schema() -> dict[str, Any]:
    """A scene file as JSON Schema (draft 2020-12), with descriptions for editors to show.

    Examples
    --------
    >>> json_schema()["required"]
    ['solid', 'profile', 'loading']
    """
    tables: dict[str, Any] = {name: (model, ... if name in REQUIRED_TABLES else None) for name, model in TABLES.items()}
    title: Any = (Annotated[str, Field(description=TITLE, examples=["Steel on a ground seal"])], "")
    scene = create_model("Scene", __config__=ConfigDict(extra="forbid"), title=title, **tables)
    schema = scene.model_json_schema(schema_generator=_OfToml)
    for name, model in TABLES.items():
        table = schema["$defs"][model.__name__]
        table["description"] = _purpose(model)
        for key, shape in table["properties"].items():
            said = said_of(model, key)
            shape["description"] = f"{said['does']} Allowed: {said['allowed']}. {_absent(name, model, key)}"
            for word in ("title", "allowed", "unit", "absent"):
                shape.pop(word, None)
    return schema | {"$schema": GenerateJsonSchema.schema_dialect, "title": "A scene of linecontact"}


def keys_text(section: str | None = None) -> str:
    """All keys of a section, or of all of them, as Markdown that a terminal shows as well.

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
        return "\n\n".join([HEAD + TITLE, *("\n".join(_section(name, schema)) for name in TABLES)])
    name = section.strip("[]")
    if name not in TABLES:
        raise UnknownSectionError(str(Mistake("section", f"[{name}] is unknown", unknown_key(name, TABLES))))
    return "\n".join(_section(name, schema))


def _section(name: str, schema: Mapping[str, Any]) -> Iterator[str]:
    """The lines of one section; `schema` has the tables by the names of their models."""
    model = TABLES[name]
    yield from (f"## [{name}]", "")
    yield f"{_purpose(model)} It {'is needed' if name in REQUIRED_TABLES else 'may be absent'}."
    yield ""
    for key, shape in schema[model.__name__]["properties"].items():
        said = said_of(model, key)
        kind = " or ".join(dict.fromkeys(_types(shape))) + (f", {said['unit']}" if said["unit"] else "")
        yield f"- `{key}` ({kind}): {said['does']}"
        yield f"  Allowed: {said['allowed']}. {_absent(name, model, key)}"
        yield f"  Example: `{key} = {toml(said['example'])}`"


def _purpose(model: type[Table]) -> str:
    """The first sentence of a table, without its name."""
    words = str(model.__doc__).split("\n\n")[0].partition(": ")[2]
    return words[:1].upper() + words[1:]


def _types(shape: Mapping[str, Any]) -> Iterator[str]:
    """The types that a value may have, in words."""
    if "anyOf" in shape:
        for one in shape["anyOf"]:
            yield from _types(one)
    elif "$ref" in shape:
        yield "table"
    else:
        yield TYPES[shape["type"]]


def _absent(name: str, model: type[Table], key: str) -> str:
    """What is taken where a key is absent, and of [profile] which kinds use it."""
    field, absent = model.model_fields[key], said_of(model, key)["absent"]
    if field.is_required():
        return "Needed."
    if not absent and field.default not in (None, ()):
        absent = toml(field.default)
    parts = []
    if name == "profile":
        needing, using = ([kind for kind in rule if key in rule[kind]] for rule in (REQUIRED, OPTIONAL))
        parts += [f"Needed by kind = {_quoted(needing)}."] if needing else []
        parts += [f"Optional with kind = {_quoted(using)}."] if using else []
    return " ".join([*parts, f"Default: {absent or 'none'}."] if absent or not parts else parts)


def _quoted(words: list[str]) -> str:
    return " or ".join(f'"{word}"' for word in words)


def toml(value: Any) -> str:
    """A short value as in a scene file.

    Examples
    --------
    >>> toml([2.1e11, 0.5]), toml("mean"), toml(True)
    ('[2.1e+11, 0.5]', '"mean"', 'true')
    """
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(toml, value)) + "]"
    return f"{value:g}" if isinstance(value, float) else json.dumps(value)
