"""Complete contact and the last gaps before it, against closed forms that share no code with the solvers.

Pressed flat, every wave h_m of the profile carries the pressure h_m / c(q_m); on a half-space c = 2 / (E* q), on a
bonded layer c(q) of Carbone and Mangialardi (J. Mech. Phys. Solids 56 (2008) 684).  Energy per area: sum h_m^2 / (4
c(q_m)).

Without adhesion the last gap of one wave is Westergaard's at any load: with S = p / p* it is (2/pi) asin(sqrt(1 - S))
of the period wide, and the separation is D (1 - S + S ln S).  Elsewhere gaps close at the lowest pressures -Q of
complete contact, curvature k, as isolated cracks: T = Q - p = k c^2 / 4 for the half width c, s = 2 pi T^2 / (period
E* k) (references/isolated_crack.py).  This limit leaves out terms of the order of the missing load T / Q.

E = 1 MPa, period 10 mm, heights 100 um or 50 um (rms).
"""

import numpy as np
import pytest

import bem
from validation.plugin.rows import Code, Quantity
from validation.references.closed_forms import layer_compliance
from validation.references.isolated_crack import closing, crack, valleys
from validation.references.waves import Waves
from validation.routes.scenes import NOT_SELF_AFFINE, TEN_DIGITS, posed, solved, values

E, PERIOD, DEPTH = 1e6, 0.01, 1e-4
MISSING = (1e-3, 1e-6, 1e-9, 1e-12)  # load missing to complete contact, relative
NEAR = 1e-8  # missing load at which isolated cracks are compared: their limit and rounding leave least there


def complete(orders, amplitudes, phases, thickness, poisson_ratio):
    """Return the pressure of complete contact without its mean, Pa."""
    q = 2 * np.pi / PERIOD * np.asarray(orders)
    compliance = 2 * (1 - poisson_ratio**2) / (E * q)
    if thickness is not None:
        compliance = layer_compliance(q, thickness, E, poisson_ratio)
    return Waves(PERIOD, np.asarray(orders), np.asarray(amplitudes) / compliance, np.asarray(phases))


def solve_waves(orders, amplitudes, phases, control, targets, thickness=None, poisson_ratio=0.5):
    """Solve waves without adhesion and return the states at the targets."""
    profile = {"kind": "harmonics", "period": PERIOD, "orders": list(orders), "amplitudes": list(amplitudes),
               "phases": list(phases)}
    scene = {"solid": {"youngs_modulus": E, "poisson_ratio": poisson_ratio}, "profile": profile,
             "loading": {"control": control, "targets": list(targets)}}
    result = bem.solve(scene if thickness is None else scene | {"layer": {"thickness": thickness}})
    assert all(state.certificate.ok for state in result.targets)
    return result.targets


@pytest.mark.quick
def test_compressible_layer(rows):
    """Has a compressible layer pressed flat the energy, plate's displacement and fields of the closed form?"""
    nu, thickness, pressure = 0.3, 1e-3, 2e5
    orders, amplitudes, phases = [1, 2, 5], [20e-6, 10e-6, 3e-6], [0.0, 1.0, 2.0]
    profile = NOT_SELF_AFFINE | {"kind": "harmonics", "orders": orders, "amplitudes": amplitudes, "phases": phases}
    output = {"shapes": True, "spectra": True, "pressure_distribution": True}
    result = solved("rough_100", adhesion=None, solid={"poisson_ratio": nu}, profile=profile, output=output,
                    layer={"thickness": thickness}, loading={"control": "mean_pressure", "targets": [pressure]})
    (state,), fields = result.targets, result.fields
    compliance = layer_compliance(2 * np.pi * np.array(orders) / PERIOD, thickness, E, nu)
    highest = Waves(PERIOD, np.array(orders), np.array(amplitudes), np.array(phases)).highest
    carbone = rows.between(Code.BEM, Code.EXACT, "Carbone and Mangialardi 2008, wave by wave")
    energy = float(np.sum(np.square(amplitudes) / compliance)) / 4
    carbone.compare("elastic energy", state.elastic_energy, energy, quantity=Quantity.ENERGY, unit="J/m^2",
                    uncertainty=state.error_estimate.elastic_energy, required=1e-10 * energy,
                    because=TEN_DIGITS)
    uniform = thickness * (1 - 2 * nu) * (1 + nu) / (E * (1 - nu))
    carbone.compare("displacement of the plate", state.total_displacement, highest + uniform * pressure, unit="m",
                    quantity=Quantity.LENGTH, uncertainty=1e-12 * highest, required=1e-10 * highest,
                    because=TEN_DIGITS, source="h_max + c(0) p")
    waves = complete(orders, amplitudes, phases, thickness, nu)
    power, levels = waves.amplitudes**2 / 4, fields["sigma_bounds_0"]
    sorted_pressures = np.sort(pressure + waves.height(PERIOD * np.arange(200_000) / 200_000))
    for name, value, reference, unit in (
        ("pressure at points", fields["pressure_0"], pressure + waves.height(fields["x_0"]), "Pa"),
        ("displacement at points", fields["displacement_0"],
         Waves(PERIOD, np.array(orders), np.array(amplitudes), np.array(phases)).height(fields["x_0"]), "m"),
        ("power of the pressure at its orders", fields["C_sigma_0"][np.array(orders) - 1],
         power * PERIOD / (2 * np.pi), "Pa^2 m"),
        ("share of the period below each pressure", np.cumsum(fields["P_0"] * np.diff(levels)),
         np.searchsorted(sorted_pressures, levels[1:]) / sorted_pressures.size, ""),
    ):
        carbone.compare(name, value, reference, quantity=Quantity.POINTS, unit=unit,
                        uncertainty=1e-12 * np.max(np.abs(reference)) if unit else 10 / 200_000)  # ten crossings


@pytest.mark.quick
@pytest.mark.parametrize("poisson_ratio", [0.0, 0.3, 0.499999, 0.5])
def test_pressure_that_closes_a_thin_layer(rows, poisson_ratio):
    """Is the last gap on a thin layer closed by the pressure D / c(q0), bracketed to 1e-6?"""
    thickness = 2e-4
    closes = DEPTH / float(layer_compliance(2 * np.pi / PERIOD, thickness, E, poisson_ratio))
    loads = [closes * (1 - 1e-6), closes * (1 + 1e-6)]
    states = solve_waves([1], [DEPTH], [0.0], "mean_pressure", loads, thickness, poisson_ratio)
    rows.compare("complete contact below and above that pressure (1: yes)",
                 [state.status == "complete_contact" for state in states], [0, 1], of=Code.BEM, by=Code.EXACT,
                 quantity=Quantity.AREA, kind="construction", required=0.5, because="yes or no",
                 source="compliance of a bonded layer")


@pytest.mark.quick
@pytest.mark.parametrize("waves", [1, 3])
def test_last_gaps_of_one_wave(rows, waves):
    """Are gaps, separation, energy and stiffness of one wave right down to 1e-12 from complete contact?"""
    highest = np.pi * E / (1 - 0.5**2) * DEPTH / PERIOD * waves
    loads = [highest * (1 - missing) for missing in MISSING]
    missing = np.array([(highest - load) / highest for load in loads])  # of the loads as doubles
    k = np.arange(2, 30)
    separations = DEPTH * np.sum(missing[:, None] ** k / (k * (k - 1.0)), axis=1)  # 1 - S + S ln S without cancellation
    gaps = 2 / np.pi * np.arcsin(np.sqrt(missing))
    by_load = solve_waves([waves], [DEPTH], [0.0], "mean_pressure", loads)
    by_separation = solve_waves([waves], [DEPTH], [0.0], "separation", separations)
    westergaard = rows.between(Code.BEM, Code.EXACT, "Westergaard 1939; 1 - S missing")
    share = 1 - missing
    energy = highest * DEPTH * (share**2 / 4 - share**2 / 2 * np.log1p(-missing))
    for name, error, quantity in (
        ("at given load: relative error of the gap times 1 - S",
         ((1 - values(by_load, "contact_fraction")) / gaps - 1) * missing, Quantity.AREA),
        ("at given load: relative error of the separation times 1 - S",
         (values(by_load, "separation") / separations - 1) * missing, Quantity.LENGTH),
        ("at given load: relative error of the energy", values(by_load, "elastic_energy") / energy - 1,
         Quantity.ENERGY),
        ("at given load: relative error of the stiffness times 1 - S",
         (-values(by_load, "contact_stiffness") * DEPTH * np.log1p(-missing) / highest - 1) * missing,
         Quantity.STIFFNESS),
        ("at given separation: error of the contact fraction",
         values(by_separation, "contact_fraction") - (1 - gaps), Quantity.AREA),
    ):
        westergaard.compare(name, error, 0.0, quantity=quantity, uncertainty=2e-16, required=4e-15,
                            because="twenty roundings: loads and contact fractions round to 2e-16 of one")
    work = sum(state.evaluations for state in (*by_load, *by_separation))
    rows.count("evaluations", work, of=Code.BEM)


@pytest.mark.quick
@pytest.mark.parametrize(
    ("orders", "seed", "thickness", "poisson_ratio"),
    [pytest.param([1, 2], None, None, 0.5, id="two equal gaps"),
     pytest.param([2, 3], None, None, 0.5, id="orders 2 and 3"),
     pytest.param(None, 1, None, 0.5, id="100 harmonics"),
     pytest.param([1, 2], None, 5e-4, 0.3, id="layer of 0.05 periods")],
)
def test_isolated_cracks(rows, orders, seed, thickness, poisson_ratio):
    """Do the last gaps close as isolated cracks: in number, width, separation, and in the load at that separation?"""
    if seed is None:
        profile = orders, [DEPTH] * len(orders), [0.0] * len(orders)
    else:
        surface = posed("rough_100", profile={"seed": seed}).surface()
        profile = surface.orders.tolist(), surface.amplitudes.tolist(), surface.phases.tolist()
    modulus, pressure = E / (1 - poisson_ratio**2), complete(*profile, thickness, poisson_ratio)
    lowest, curvature = valleys(pressure)
    highest = -float(lowest.min())
    separation = 2 * np.pi / PERIOD * (highest * NEAR) ** 2 * float(np.sum(1 / curvature)) / modulus
    (state,) = solve_waves(*profile, "mean_pressure", [highest * (1 - NEAR)], thickness, poisson_ratio)
    (back,) = solve_waves(*profile, "separation", [separation], thickness, poisson_ratio)
    load, widths = closing(pressure, modulus, separation)
    cracks = rows.between(Code.BEM, Code.EXACT, "isolated cracks, T = k c^2 / 4 (Tada, Paris and Irwin)")
    for name, value, reference, quantity, unit, own in (
        ("gap, over the period", 1 - state.contact_fraction, float(widths.sum()) / PERIOD, Quantity.AREA, "",
         state.error_estimate.contact_fraction),
        ("separation", state.separation, separation, Quantity.LENGTH, "m", state.error_estimate.separation),
        ("missing load at that separation", highest - back.mean_pressure, highest - load, Quantity.PRESSURE, "Pa",
         back.error_estimate.mean_pressure),
    ):
        cracks.compare(name, value, reference, quantity=quantity, unit=unit, uncertainty=(own, 1e-6 * reference),
                       required=1e-6 * reference,
                       because="the limit leaves out a hundred times the missing load 1e-8")
    cracks.compare("gaps at given load and at given separation", [state.n_patches, back.n_patches], lowest.size,
                   quantity=Quantity.COUNT, kind="construction", required=0.5, because="a count")


@pytest.mark.quick
def test_narrow_flaw(rows):
    """Does complete contact open at a narrow flaw under the tension of Griffith's crack of its width?"""
    orders, heights, phases, nu, work, width = [1, 2], [DEPTH, DEPTH / 3], [0.3, 1.0], 0.3, 0.05, 1e-7
    pressure = complete(orders, heights, phases, None, nu)
    valley = Waves(PERIOD, pressure.orders, -pressure.amplitudes, pressure.phases).crests
    deepest = valley[np.argmin(pressure.height(valley))]
    surface = Waves(PERIOD, np.array(orders), np.array(heights), np.array(phases))
    flat = work / np.sqrt(1 + surface.height(deepest, 1) ** 2)  # `crack` counts adhesion along the slope, the scene not
    opens, _ = crack(surface, E / (1 - nu**2), flat, deepest - width / 2, deepest + width / 2)
    profile = {"kind": "harmonics", "period": PERIOD, "orders": orders, "amplitudes": heights, "phases": phases}
    loading = {"control": "mean_pressure", "targets": [1.1 * opens], "initial": "complete_contact", "flaw": width}
    result = bem.solve({"solid": {"youngs_modulus": E, "poisson_ratio": nu}, "profile": profile, "loading": loading,
                        "adhesion": {"work_of_adhesion": work}})
    opening = next(event for event in result.events if event.kind == "opening")
    rows.compare("mean pressure at which the flaw opens", opening.mean_pressure, opens, of=Code.BEM, by=Code.EXACT,
                 quantity=Quantity.PRESSURE, unit="Pa", required=-1e-9 * opens,
                 uncertainty=(opening.error_estimate.mean_pressure, -1e-10 * opens),
                 because="the crack is isolated to the square of its width, 1e-10",
                 source="Griffith; Tada, Paris and Irwin")
