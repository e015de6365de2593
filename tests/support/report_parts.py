"""A row and a figure of a report, for the tests of the page."""

from validation.harness.schema import Figure, Panel, Reference, Row, Series, Tolerance


def row(computed=1.01, **changes):
    plain = {
        "quantity": "load < K & friends",
        "unit": "N/m",
        "reference": Reference(kind="exact", source="closed form"),
        "norm": "absolute",
        "expected": [1.0],
        "computed": [computed],
        "tolerance": Tolerance(value=0.1, measured=0.04),
    }
    return Row(**(plain | changes))


def figure(name):
    above = Panel(xlabel="x", ylabel="load", series=[Series(label="solver", x=[0.0, 1.0, None], y=[0.0, 1.0, 2.0])])
    below = Panel(xlabel="x", ylabel="error", series=[Series(label="solver", x=[0.0, 1.0], y=[0.1, -0.1])])
    return Figure(id=name, caption=f"Caption of {name}.", solution=above, error=below)
