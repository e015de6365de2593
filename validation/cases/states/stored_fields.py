"""Fields stored with a state: displacement, spectra and distributions, from its edges and pressure.

A layer of compressible material is pressed on two unequal crests.  With x_j = a_j + r_j (1 - cos theta) on a patch,
sigma r sin(theta) is smooth in theta, so that the stored pressures are nodes of Gauss-Chebyshev's rule: with the
modes sigma_m of the pressure and c(q) of the layer and of the half-space (layer_compliance), in the middle of a gap

    u(x) = -(2 / (pi E*)) int sigma(y) log|2 sin(pi (x - y) / period)| dy
           + sum_m (c - c_half)(q_m) Re(sigma_m e^(i q_m x)),

and the gap is u - (h - h_max + Delta).  Johnson's wave has two edges: P -> A |sigma|^-3,
A = 4 E* gamma / (pi period).  Spectrum and distribution of the pressure are those of Westergaard's contact.  SI units.
"""

import numpy as np

import bem
from bem.scene.result import State
from validation.cases.shared.checks import Against, Found, case, posed, solved
from validation.harness.arrays import FloatArray
from validation.references.closed_forms import Sinusoid, layer_compliance

THICKNESS, E, NU = 1e-3, 1e6, 0.3  # m, Pa, of the layer
APART = 20e-6  # m, separation
MODULUS = E / (1 - NU**2)
ORDERS = np.arange(1, 41)  # beyond, a layer of a tenth of the period is a half-space
MIDDLE = 0.2  # of a gap, where its displacement is asked for
WAVE = Sinusoid(1e-4, 0.01, 1e6, 0.5, 0.3)


def _displacement(fields: dict[str, FloatArray], state: State, at: FloatArray, period: float) -> FloatArray:
    """Mean-free displacement in gaps, from the stored pressures."""
    edges = np.array(state.edges)
    found, modes = np.zeros(at.size), np.zeros(ORDERS.size, dtype=np.complex128)
    wavenumbers = 2 * np.pi * ORDERS / period
    for index, (left, right) in enumerate(edges):
        of = fields["patch_0"] == index
        x = left + (fields["x_0"][of] - left) % period
        force = fields["pressure_0"][of] * np.sqrt((x - left) * (right - x)) * np.pi / x.size
        found -= 2 / (np.pi * MODULUS) * np.log(np.abs(2 * np.sin(np.pi * (at[:, None] - x) / period))) @ force
        modes += 2 / period * np.exp(-1j * np.outer(wavenumbers, x)) @ force
    more = layer_compliance(wavenumbers, THICKNESS, E, NU) - 2 / (MODULUS * wavenumbers)
    return np.asarray(found + np.real(np.exp(1j * np.outer(at, wavenumbers)) @ (more * modes)))


def _fields() -> Found:
    scene = posed("layer_two_crests", layer={"thickness": THICKNESS},
                  loading={"control": "separation", "targets": [APART]},
                  output={"shapes": [APART]})  # fmt: skip
    result, surface = bem.solve(scene), scene.surface()
    (state,), fields = result.targets, result.fields
    period, edges = surface.period, np.array(state.edges)
    opening, closing = edges[:, 1], np.append(edges[1:, 0], edges[0, 0] + period)
    share = ((fields["x_0"] - opening[:, None]) % period) / (closing - opening)[:, None]
    middle = np.any(np.abs(share - 0.5) < MIDDLE / 2, axis=0)
    x = fields["x_0"][middle]
    u = _displacement(fields, state, x, period)
    from_pressure = Against("exact", "Gauss-Chebyshev's rule on the stored pressure; Carbone and Mangialardi 2008")
    tail = solved("sinusoid", adhesion={"work_of_adhesion": WAVE.work_of_adhesion},
                  loading={"targets": [float(WAVE.penetration(1.0))]},
                  output={"pressure_distribution": True})  # fmt: skip
    # rounding of the state: the largest difference between the BLAS kernels of processors; either side is nearer
    yield from_pressure.row("displacement in the middle of gaps on a compressible layer", "m", u,
                            fields["displacement_0"][middle], 6.4e-15)  # fmt: skip
    yield from_pressure.row("gap there, over the largest", "m",
                            u - surface.height(x) + surface.max_height - state.penetration, fields["gap_0"][middle],
                            5.2e-15)  # fmt: skip
    yield Against("exact", "Johnson 1995: two edges").row(
        "tail of the pressure distribution", "Pa^2",
        4 * WAVE.modulus * WAVE.work_of_adhesion / (np.pi * WAVE.wavelength), float(tail.fields["tail_coefficient_0"]),
        3.8e-14)  # fmt: skip


def _spectra() -> Found:
    wave = Sinusoid(1e-4, 0.01, E, 0.5, 0.0)
    loading = {"control": "penetration", "targets": [float(wave.penetration(np.pi / 4))]}
    output = {"spectra": True, "pressure_distribution": True}
    result = solved("sinusoid", adhesion=None, loading=loading, output=output)
    fields, (state,), star = result.fields, result.targets, wave.full_contact_pressure
    # half of the period in contact: sigma = 2 p* cos(x/2) sqrt(1/2 - sin^2(x/2)), whose first modes are 3/8 and 1/8 p*
    exact = np.array([(0.375 * star) ** 2, (0.125 * star) ** 2]) / (2 * np.pi / wave.wavelength)
    levels = fields["sigma_bounds_0"]
    shares = fields["P_0"] * np.diff(levels)
    known = Against("exact", "Westergaard 1939, half of the period in contact")
    # rounding: the largest over the BLAS kernels of five processors (least: 6e-16 each)
    yield known.row("two-sided pressure spectrum at the first two orders", "Pa^2 m", exact, fields["C_sigma_0"][:2],
                    (5e-15, 1.5e-15))  # fmt: skip
    yield known.row("integral of the pressure distribution = contact fraction", "", 0.5, float(np.sum(shares)),
                    (2.5e-14, 9.1e-15))  # fmt: skip
    yield known.row("contact fraction", "", 0.5, state.contact_fraction, (3e-12, 1e-12))
    yield known.row("share of the period above each pressure of the distribution, up to the highest", "",
                    _share_above(levels[:-1] / star), np.cumsum(shares[::-1])[::-1], 9.1e-15, "absolute")  # fmt: skip
    # displacement over pressure, order by order: the compliance of the layer, whatever the contact
    scene, orders = posed("layer_two_crests", adhesion=None, output={"spectra": True}), np.arange(1, 7)
    fields, layer, solid = bem.solve(scene).fields, scene.layer, scene.solid
    assert layer is not None
    compliance = layer_compliance(2 * np.pi * orders / scene.surface().period, layer.thickness, solid.youngs_modulus,
                                  solid.poisson_ratio)  # fmt: skip
    found = np.sqrt(fields["C_u_0"][: orders.size] / fields["C_sigma_0"][: orders.size])
    yield Against("exact", "Carbone and Mangialardi 2008, c(q)").row(
        "displacement over pressure on a layer, spectra of orders 1 to 6", "m/Pa", compliance, found, 3e-16
    )


def _share_above(pressure: FloatArray) -> FloatArray:
    """Share of the period above pressures over p*, half of it in contact.

    With S = cos^2(x/2) the pressure p = 2 p* cos(x/2) sqrt(S - 1/2) gives S^2 - S/2 = (p / 2 p*)^2.
    """
    square = 0.25 * (1.0 + np.sqrt(1.0 + 4.0 * pressure**2))
    return np.asarray(2.0 / np.pi * np.arccos(np.sqrt(np.minimum(square, 1.0))))


CASES = (
    case("stored-fields", "identities", _fields,
         "Are the fields that are stored with a state those of its edges and its pressure?",
         r"$u = c \ast \sigma$ in gaps of a layer; "
         r"$P \to \frac{4 E^\ast \gamma}{\pi \lambda} |\sigma|^{-3}$",
         "carbone2008 johnson1995", "layer adhesion slope_term shapes pressure_distribution",
         scene="layer_two_crests", problem="two crests on a layer"),
    case("westergaard-spectrum", "closed forms", _spectra,
         "Are spectrum and distribution of the pressure those of Westergaard's contact?",
         r"$\sigma = 2 p^\ast \cos \frac{x}{2} \sqrt{\sin^2 \psi - \sin^2 \frac{x}{2}}$, "
         r"$C_\sigma(m q_0) = \sigma_m^2 / q_0$",
         "westergaard1939", "half_space spectra pressure_distribution", scene="sinusoid",
         problem="wave without adhesion"),
)  # fmt: skip
