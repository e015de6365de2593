"""A result as table, dataset, figure and in a few words."""

import re
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from rough_scene import ROUGH

import bem
from bem.scene.result_views import UNITS


@pytest.fixture(scope="module")
def result():
    return bem.solve(ROUGH | {"title": "a <wave>", "output": {"shapes": [4e-5], "spectra": True}})


def test_the_table_of_states_holds_every_number(result):
    table = result.to_table()
    assert {column.shape for column in table.values()} == {(len(result.states),)}
    assert table["mean_pressure"].tolist() == [state.mean_pressure for state in result.states]
    errors = [state.error_estimate.contact_fraction for state in result.states]
    assert table["error_estimate_contact_fraction"].tolist() == errors
    assert table["certificate_ok"].tolist() == [state.certificate.ok for state in result.states]
    assert np.isnan(table["total_displacement"]).all()  # a half-space has none
    kinds = {name: table[name].dtype.kind for name in ("branch", "n_patches", "target", "separation")}
    assert kinds == {"branch": "U", "n_patches": "i", "target": "b", "separation": "f"}


def test_the_table_of_events_holds_every_number(result):
    table = result.to_table("events")
    assert table["kind"].tolist() == [event.kind for event in result.events]
    assert len(table["error_estimate_penetration"]) == len(result.events) > 0


def test_the_docstring_names_every_column_of_the_targets_with_its_unit(result):
    rows = re.findall(r"^ {8}([a-z].{41}) (.{5}) ", bem.Result.to_table.__doc__.partition("meaning")[2], re.M)
    named = {name: unit.strip() for names, unit in rows for name in names.strip().split(", ")}
    columns = [name for name in result.to_table("targets") if not name.startswith("error_estimate_")]
    assert list(named) == columns
    units = {name: unit for name, unit in named.items() if unit in ("m", "Pa")}
    assert units == {name: UNITS[name] for name in columns if name in UNITS}


def test_another_table_is_refused(result):
    with pytest.raises(ValueError, match='of = \'fields\'; allowed: "states", "events" or "targets"'):
        result.to_table("fields")


def test_a_result_without_states_has_the_same_columns(result):
    empty = bem.Result(result.scene, (), {}, (), (), "interrupted")
    assert list(empty.to_table()) == list(result.to_table())
    assert "0 states" in repr(empty)


def test_dataset(result):
    pytest.importorskip("xarray")
    dataset = result.to_xarray()
    assert dataset.sizes["state"] == len(result.states)
    assert dataset.sizes["event"] == len(result.events)
    assert dataset["mean_pressure"].attrs["units"] == dataset["error_estimate_mean_pressure"].attrs["units"] == "Pa"
    shape = next(name for name in result.fields if name.startswith("x_")).removeprefix("x_")
    assert dataset[f"field_x_{shape}"].dims == dataset[f"field_gap_{shape}"].dims == (f"point_{shape}",)
    assert dataset["field_C_h"].dims == dataset["field_C_u_0"].dims == ("wavenumber",)
    assert {f"field_{name}" for name in result.fields} <= set(dataset.variables)


def test_a_dataset_has_coordinates_and_units(result):
    pytest.importorskip("xarray")
    dataset = result.to_xarray()
    k = next(name for name in result.fields if name.startswith("x_")).removeprefix("x_")
    pressure = dataset[f"field_pressure_{k}"]
    assert pressure.coords[f"field_x_{k}"].attrs["units"] == "m"
    assert dataset["contact_fraction"].coords["mean_pressure"].attrs["units"] == "Pa"
    assert dataset["field_C_sigma_0"].coords["field_q"].attrs["units"] == "rad/m"
    assert dataset.indexes["state"].tolist() == list(range(len(result.states)))
    numbers = {name: variable for name, variable in dataset.variables.items() if variable.dtype.kind == "f"}
    assert all("units" in variable.attrs for variable in numbers.values())
    assert numbers["contact_fraction"].attrs["units"] == "1"


def test_dataset_without_its_extra_is_told(result, monkeypatch):
    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(ImportError, match=r"pip install 'linecontact\[xarray\]'"):
        result.to_xarray()


def test_plot_shows_both_branches_and_their_errors(result):
    figure = result.plot()
    assert [axes.get_xlabel() for axes in figure.axes] == ["contact fraction", "separation / µm"]
    for axes in figure.axes:
        assert axes.get_legend_handles_labels()[1] == ["loading", "unloading"]
        assert len(axes.containers) == 2


def test_a_figure_shows_itself_in_a_notebook(result):
    """Without pyplot nothing else tells a notebook how to show a figure."""
    png = result.plot()._repr_png_()
    assert png.startswith(b"\x89PNG")
    assert len(png) > 10_000


def test_states_scenes_and_results_are_told_on_a_line(result):
    state = result.targets[-1]
    scene = bem.parse_scene(ROUGH | {"title": "a wave"})
    said = [repr(state), repr(scene), repr(result), repr(scene.surface())]
    assert max(map(len, said)) < 200
    assert "\n" not in "".join(said)
    assert f"{state.mean_pressure:.6g} Pa" in said[0]
    assert said[0].endswith("certified>")
    assert "'a wave'" in said[1]
    assert said[3].startswith(f"<Profile of {scene.profile.harmonics} harmonics in a period of ")
    missed = replace(state, status="unreachable", edges=(), contact_fraction=float("nan"), target=True)
    assert repr(missed).startswith("<State unreachable: ")


def test_neither_library_is_imported_before_it_is_used():
    code = (
        "import sys, bem; bem.read_result, bem.solve; print([m for m in ('matplotlib', 'xarray') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
