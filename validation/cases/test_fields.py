"""Fields stored with a state: displacement, gap, spectra and distributions of the pressure.

Two unequal crests on a compressible layer (thickness 1 mm, nu = 0.3, separation 20 um): stored pressures are nodes of
Gauss-Chebyshev's rule, so that with c(q) of the layer (closed_forms.py) and c_0 of the half-space, in a gap,

    u(x) = -2 / (pi E*) int sigma(y) log|2 sin(pi (x - y) / period)| dy + sum_m (c - c_0)(q_m) Re(sigma_m e^(i q_m x)).

Half of a wave's period in contact without adhesion (Westergaard) has sigma = 2 p* cos(x/2) sqrt(1/2 - sin^2(x/2)),
first modes 3/8 and 1/8 p*, and pressure above p on 2/pi acos(sqrt(S)) of the period, S^2 - S/2 = (p / 2p*)^2.
Johnson's two edges give the tail P -> A |sigma|^-3, A = 4 E* gamma / (pi period).
"""

import numpy as np
import pytest

import bem
from validation.plugin.rows import Code, Quantity
from validation.references.closed_forms import Sinusoid, layer_compliance
from validation.references.waves import Waves
from validation.routes.scenes import TEN_DIGITS, posed, solved

E, NU, THICKNESS, APART = 1e6, 0.3, 1e-3, 20e-6
MODULUS = E / (1 - NU**2)
ORDERS = np.arange(1, 41)  # beyond, a layer of a tenth of the period is a half-space


def displacement(fields, edges, x, period):
    """Return the displacement without its mean at places in gaps, (n,) m, from the stored pressures."""
    u, modes, q = np.zeros(x.size), np.zeros(ORDERS.size, dtype=complex), 2 * np.pi * ORDERS / period
    for index, (left, right) in enumerate(edges):
        on_patch = fields["patch_0"] == index
        at = left + (fields["x_0"][on_patch] - left) % period
        force = fields["pressure_0"][on_patch] * np.sqrt((at - left) * (right - at)) * np.pi / at.size
        u -= 2 / (np.pi * MODULUS) * np.log(np.abs(2 * np.sin(np.pi * (x[:, None] - at) / period))) @ force
        modes += 2 / period * np.exp(-1j * np.outer(q, at)) @ force
    more = layer_compliance(q, THICKNESS, E, NU) - 2 / (MODULUS * q)
    return u + np.real(np.exp(1j * np.outer(x, q)) @ (more * modes))


@pytest.mark.quick
def test_fields_of_two_patches(rows):
    """Are displacement and gap those of the pressure that is stored beside them?"""
    tables = {"layer": {"thickness": THICKNESS}, "loading": {"control": "separation", "targets": [APART]},
              "output": {"shapes": [APART]}}
    result, scene = solved("layer_two_crests", **tables), posed("layer_two_crests", **tables).surface()
    (state,), fields = result.targets, result.fields
    surface, period, edges = Waves.of(scene), scene.period, np.array(state.edges)
    opening, closing = edges[:, 1], np.append(edges[1:, 0], edges[0, 0] + period)
    share = ((fields["x_0"] - opening[:, None]) % period) / (closing - opening)[:, None]
    middle = np.any(np.abs(share - 0.5) < 0.1, axis=0)  # of a gap
    x = fields["x_0"][middle]
    u = displacement(fields, edges, x, period)
    gap = u - surface.height(x) + surface.highest - state.penetration
    by_pressure = rows.between(Code.BEM, Code.EXACT, "Gauss-Chebyshev's rule on the stored pressure, c(q)",
                               "construction")
    for name, value, reference in (("displacement", "displacement_0", u), ("gap", "gap_0", gap)):
        by_pressure.compare(f"{name} in the middle of gaps", fields[value][middle], reference, unit="m",
                            quantity=Quantity.POINTS, required=1e-10 * np.max(np.abs(reference)),
                            because=TEN_DIGITS)


@pytest.mark.quick
def test_tail_of_the_pressure_distribution(rows):
    """Has the distribution of the pressure the tail of two edges with Johnson's stress intensity?"""
    wave = Sinusoid(1e-4, 0.01, E, 0.5, 0.3)
    result = solved("sinusoid", adhesion={"work_of_adhesion": wave.work_of_adhesion},
                    loading={"targets": [float(wave.penetration(1.0))]},
                    output={"pressure_distribution": True})
    tail = 4 * wave.modulus * wave.work_of_adhesion / (np.pi * wave.wavelength)
    rows.compare("coefficient of the tail", float(result.fields["tail_coefficient_0"]), tail, of=Code.BEM,
                 by=Code.EXACT, quantity=Quantity.SPECTRUM, unit="Pa^2", uncertainty=1e-12 * tail,
                 required=1e-10 * tail, because=TEN_DIGITS, source="Johnson 1995")


@pytest.mark.quick
def test_spectrum_and_distribution_of_westergaards_contact(rows):
    """Are spectrum and distribution of the pressure those of Westergaard's contact on half of the period?"""
    wave = Sinusoid(1e-4, 0.01, E, 0.5, 0.0)
    loading = {"control": "penetration", "targets": [float(wave.penetration(np.pi / 4))]}
    result = solved("sinusoid", adhesion=None, loading=loading,
                    output={"spectra": True, "pressure_distribution": True})
    fields, star = result.fields, wave.full_contact_pressure
    spectrum = np.array([(3 / 8 * star) ** 2, (star / 8) ** 2]) / (2 * np.pi / wave.wavelength)
    levels = fields["sigma_bounds_0"]
    shares = fields["P_0"] * np.diff(levels)
    square = 0.25 * (1 + np.sqrt(1 + 4 * (levels[:-1] / star) ** 2))
    above = 2 / np.pi * np.arccos(np.sqrt(np.minimum(square, 1.0)))
    exact = rows.between(Code.BEM, Code.EXACT, "Westergaard 1939, half of the period in contact")
    for name, value, reference, unit, scale in (
        (
            "two-sided pressure spectrum at the first two orders",
            fields["C_sigma_0"][:2],
            spectrum,
            "Pa^2 m",
            spectrum[0],
        ),
        ("share of the period above each pressure", np.cumsum(shares[::-1])[::-1], above, "", 1.0),
        ("integral of the pressure distribution", float(np.sum(shares)), 0.5, "", 1.0),
    ):
        exact.compare(name, value, reference, quantity=Quantity.SPECTRUM, unit=unit, uncertainty=1e-12 * scale,
                      required=1e-10 * scale, because=TEN_DIGITS)


@pytest.mark.quick
def test_spectra_on_a_layer(rows):
    """Is the displacement over the pressure, order by order, the compliance of the layer, whatever the contact?"""
    scene, orders = posed("layer_two_crests", adhesion=None, output={"spectra": True}), np.arange(1, 7)
    fields = bem.solve(scene).fields
    exact = layer_compliance(2 * np.pi * orders / scene.surface().period, 5e-3, E, NU)  # thickness of the scene
    rows.compare("displacement over pressure, orders 1 to 6", np.sqrt(fields["C_u_0"][:6] / fields["C_sigma_0"][:6]),
                 exact, of=Code.BEM, by=Code.EXACT, quantity=Quantity.SPECTRUM, unit="m/Pa",
                 uncertainty=1e-14 * exact[0], required=1e-10 * exact[0], because=TEN_DIGITS,
                 source="Carbone and Mangialardi 2008, c(q)")
