"""Complete contact under load control: a rough profile pressed flat, against the closed form."""

from __future__ import annotations

from typing import Any

import numpy as np

import bem
from validation.harness.case import Case, Outcome
from validation.harness.figure_data import axes, drawn, trace
from validation.harness.rows import compared, counted
from validation.harness.schema import Reference
from validation.references import adapters
from validation.references.closed_forms import full_contact_amplitudes


def _complete() -> Outcome:
    posed = adapters.scene("rough_100")
    surface = posed.surface()
    modulus = 1e6 / (1 - 0.5**2)
    amplitude = full_contact_amplitudes(surface.orders, surface.amplitudes, surface.period, modulus)
    x = np.linspace(0, surface.period, 1 << 14, endpoint=False)
    phase = 2 * np.pi * np.outer(x / surface.period, surface.orders) + surface.phases
    shape = np.cos(phase) @ amplitude
    least = -float(shape.min())
    energy = float(np.sum(amplitude * surface.amplitudes)) / 4
    pressures = [0.5 * least, 0.9 * least, 1.02 * least]
    changes: dict[str, Any] = {"adhesion": None, "loading": {"control": "mean_pressure", "targets": pressures}}
    result = bem.solve(adapters.scene("rough_100", changes))
    last = result.targets[-1]
    source = Reference(kind="exact", source="every mode carries E* m q0 h_m / 2", uncertainty=0.0)
    rows = (
        compared("elastic energy per nominal area, relative", "J/m^2", source, [energy], [last.elastic_energy], 1e-13,
                 MEASURED_ENERGY),
        counted("contact fraction just above the pressure of complete contact", source, [1.0], [last.contact_fraction],
                tolerance=1e-15),
        counted("gaps left at nine tenths of that pressure (1: some)", source, [1.0],
                [float(result.targets[-2].contact_fraction < 1)], tolerance=1e-15),
    )  # fmt: skip
    part = slice(0, 1 << 14, 1 << 3)
    figure = drawn(
        "complete-contact",
        "Pressure of complete contact under the least mean pressure that keeps it compressive everywhere.",
        axes("x / mm", "pressure / MPa", trace("closed form", x[part] * 1e3, (shape + least)[part] / 1e6)),
    )
    counts = {"evaluations": sum(state.evaluations for state in result.states)}
    return Outcome(rows=rows, figures=(figure,), counts=counts)


MEASURED_ENERGY = 4e-14  # 2.2e-16 here; sums of 100 terms in another order

CASES = (
    Case(id="complete-contact", group="closed forms", level="quick",
         question="Does load control end in complete contact at the right pressure and with the right energy?",
         equations=r"$\sigma = \sigma_0 + \sum_m \frac{E^\ast m q_0 h_m}{2} \cos(m q_0 x + \varphi_m)$, "
                   r"$U_{\text{el}} = \sum_m \frac{E^\ast m q_0 h_m^2}{8}$",
         sources=("carbone2009", "johnson1995"), compute=_complete, effects=("half_space", "load_control"),
         scene=adapters.scene_text("rough_100")),
)  # fmt: skip
