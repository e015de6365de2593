"""The reference of keys: made from the models, whole, with examples that a scene takes."""

import json
import tomllib
from dataclasses import fields
from pathlib import Path

import pytest

from bem import scene_commands as command_line
from bem.command_line.keys import json_schema, keys_text, toml
from bem.geometry.table import allowed, words
from bem.scene.scene import SceneError, parse_scene
from bem.scene.scene_tables import TABLES, class_of

ROOT = Path(__file__).parents[3]
KEYS = [(name, item.name) for name in TABLES for item in fields(class_of(name))]


@pytest.mark.parametrize(("name", "key"), KEYS, ids=[".".join(pair) for pair in KEYS])
def test_every_key_is_described_with_an_example_that_parses(name, key):
    said = words()[name][key]
    assert said["does"] and allowed(f"{name}.{key}")
    data = tomllib.loads(f"[{name}]\n{key} = {toml(said['example'])}")
    assert data[name][key] == said["example"]
    with pytest.raises(SceneError) as caught:  # all other keys are missing
        parse_scene(data)
    refused = [str(mistake) for mistake in caught.value.mistakes if mistake.found.startswith("= ")]
    assert refused == []


def test_words_are_of_keys_that_exist():
    assert {(name, key) for name, table in words().items() for key in table if key != "about"} == set(KEYS)


def test_the_document_is_what_the_command_prints(capsys):
    assert command_line.main(["keys"]) == 0
    assert capsys.readouterr().out == (ROOT / "bem" / "KEYS.md").read_text("utf-8")


@pytest.mark.parametrize("name", TABLES)
def test_a_section_has_all_its_keys_and_no_others(name):
    lines = keys_text(name).splitlines()
    assert lines[0] == f"## [{name}]"
    assert [line.split("`")[1] for line in lines if line.startswith("- ")] == [
        key for table, key in KEYS if table == name
    ]


def test_an_unknown_section_is_one_clear_error(capsys):
    assert command_line.main(["keys", "laod"]) == 2
    assert capsys.readouterr().err == 'error: section [laod] is unknown; allowed: "loading", by its name\n'
    assert command_line.main(["keys", "[solid]"]) == 0


def test_the_schema_knows_every_key_and_no_null(capsys):
    assert command_line.main(["schema"]) == 0
    schema = json.loads(capsys.readouterr().out)
    assert schema == json_schema()
    assert list(schema["properties"]) == ["title", *TABLES]
    for name in TABLES:
        table = schema["$defs"][class_of(name).__name__]
        assert list(table["properties"]) == [key for table, key in KEYS if table == name]
        assert table["additionalProperties"] is False
        for key, shape in table["properties"].items():
            assert words()[name][key]["does"] in shape["description"]
    assert "null" not in json.dumps(schema)
