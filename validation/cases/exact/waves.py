"""One sinusoid: the JKR curve of Johnson on a whole loop, and Westergaard's without adhesion.

And a rough profile, and waves on a compressible layer, pressed flat.  Closed forms:
validation/references/closed_forms.py.  SI units.
"""

from functools import partial

import numpy as np

import bem
from validation.cases.shared.checks import OVER_STATES, Against, Found, case, column, posed, refused, solved, work
from validation.corpus.convergence_curves import bem_curves
from validation.corpus.hard.hard_case_scenes import waves_of
from validation.harness.figure_data import axes, drawn, marks, semilogy, trace
from validation.references.adapters import NOT_SELF_AFFINE
from validation.references.closed_forms import Sinusoid, full_contact_amplitudes, layer_compliance

AMPLITUDE, WAVELENGTH, YOUNGS_MODULUS, POISSON_RATIO = 1e-4, 0.01, 1e6, 0.5
SMALLEST_SHOWN = 1e-17
# errors measured, the largest over the BLAS kernels of five processors: mean pressure, penetration, pull-off, by alpha
JOHNSON = {0.1: (6.3e-13, 2.3e-13, 1.5e-14), 0.3: (1.5e-13, 1.6e-13, 1.5e-14), 0.5: (5.3e-13, 2.3e-13, 9.5e-15)}


def _wave(alpha: float) -> Sinusoid:
    return Sinusoid(AMPLITUDE, WAVELENGTH, YOUNGS_MODULUS, POISSON_RATIO, alpha)


def _johnson(alpha: float) -> Found:
    """Load from first touch to contact fraction 0.95, unload beyond pull-off."""
    wave = _wave(alpha)
    closed, lowest = float(wave.penetration(0.95 * np.pi / 2)), float(wave.penetration(wave.fold()))
    loading = list(np.linspace(0.02 * closed, closed, 14))
    unloading = list(np.linspace(closed, lowest + 1e-3 * (closed - lowest), 16)[1:])
    targets = [*loading, *unloading, lowest - 0.05 * closed]
    result = solved("sinusoid", adhesion={"work_of_adhesion": wave.work_of_adhesion}, loading={"targets": targets})
    states = [state for state in result.states if state.n_patches == 1]
    fraction, pressure, penetration = (
        np.array(column(states, name)) for name in ("contact_fraction", "mean_pressure", "penetration")
    )
    psi, star, (of_pressure, of_penetration, of_fold) = fraction * np.pi / 2, wave.full_contact_pressure, JOHNSON[alpha]
    known = Against("exact", "Johnson 1995, at the solver's own contact width")
    pull_off = [event.penetration for event in result.events if event.kind == "pull_off"]
    # between targets states lie where steps end
    yield known.row("mean pressure over p*", "Pa", wave.mean_pressure(psi), pressure, of_pressure, OVER_STATES, star,
                    pinned="unconverged")  # fmt: skip
    yield known.row("penetration over amplitude", "m", wave.penetration(psi), penetration, of_penetration, OVER_STATES,
                    AMPLITUDE)  # fmt: skip
    yield Against("exact", "fold of Johnson's penetration").row(
        "penetration at pull-off over amplitude", "m", lowest, pull_off[:1] or [None], of_fold, "absolute",
        AMPLITUDE)  # fmt: skip
    yield Against("exact", "every state of the loop is an equilibrium").count(
        "states whose certificate is not ok", 0.0, refused(result))  # fmt: skip
    curve = np.linspace(0.01, 0.97, 300)
    yield drawn(f"johnson-{alpha:g}",
                f"Mean pressure against contact fraction on loading and unloading, alpha = {alpha:g}.",
                axes("contact fraction", "mean pressure / p*",
                     trace("Johnson 1995", curve, wave.mean_pressure(curve * np.pi / 2) / star),
                     marks("bem", fraction, pressure / star)),
                axes("contact fraction", "signed error",
                     marks("mean pressure / p*", fraction, (pressure - wave.mean_pressure(psi)) / star),
                     marks("penetration / amplitude", fraction,
                           (penetration - wave.penetration(psi)) / AMPLITUDE)))  # fmt: skip
    yield work("unknowns evaluations states", result)


def _westergaard() -> Found:
    wave, fractions = _wave(0.0), np.array([0.02, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99])
    psi, star = fractions * np.pi / 2, wave.full_contact_pressure
    targets = wave.penetration(psi)
    result = solved("sinusoid", adhesion=None, loading={"targets": targets.tolist()})
    found, known = np.array(column(result.targets, "contact_fraction")), Against("exact", "Westergaard 1939")
    # errors measured: the largest over the BLAS kernels of five processors (least 1.3e-11)
    yield known.row("contact fraction", "", fractions, found, 5.5e-11, OVER_STATES, 1.0, required=1e-10)
    yield known.row("mean pressure over p*", "Pa", wave.mean_pressure(psi), column(result.targets, "mean_pressure"),
                    8.2e-13, OVER_STATES, star)  # fmt: skip
    at = targets / AMPLITUDE
    yield drawn("westergaard", "Contact fraction against penetration without adhesion.",
                axes("penetration / amplitude", "contact fraction", trace("Westergaard 1939", at, fractions),
                     marks("bem", at, found)),
                axes("penetration / amplitude", "signed error of the contact fraction",
                     marks("bem", at, found - fractions)))  # fmt: skip
    yield work("unknowns evaluations", result)


def _convergence() -> Found:
    """The load and stress intensity of a Johnson state at its exact edges, for one tolerance after the other."""
    wave, fraction = _wave(0.3), 0.6
    psi, half = fraction * np.pi / 2, fraction * WAVELENGTH / 2
    profile, solid = bem.Profile.from_harmonics(WAVELENGTH, [1], [AMPLITUDE]), bem.Solid(YOUNGS_MODULUS, POISSON_RATIO)
    critical = float(np.sqrt(2 * wave.modulus * wave.work_of_adhesion))
    unknowns, load_error, intensity_error = [], [], []
    for exponent in range(0, 14):
        tolerance = 10.0**-exponent if exponent else 0.3
        state = bem.ContactState(profile, solid, [[-half, half]], float(wave.penetration(psi)), tolerance=tolerance)
        if state.evaluation.unknowns in unknowns:
            continue
        unknowns.append(state.evaluation.unknowns)
        load_error.append(abs(state.mean_pressure - float(wave.mean_pressure(psi))) / wave.full_contact_pressure)
        intensity_error.append(float(np.max(np.abs(state.stress_intensity / critical - 1))))
    known = Against("exact", "Johnson 1995, contact fraction 0.6, alpha 0.3")
    # rounding: the largest over the BLAS kernels of five processors (least 1.4e-15)
    yield known.row("mean pressure over p* at the finest setting", "", 0.0, load_error[-1], (2e-15, 3e-16), "absolute")
    yield known.row("stress intensity over critical at the finest setting", "", 0.0, intensity_error[-1],
                    (2e-14, 7.4e-15), "absolute")  # fmt: skip
    dense, _ = bem_curves(fraction, range(4, 31, 2))
    shown = (
        ("mean pressure / p*", unknowns, load_error),
        ("stress intensity", unknowns, intensity_error),
        ("stress intensity, dense", dense.sizes, dense.errors),
    )
    curves = (marks(label, x, [max(error, SMALLEST_SHOWN) for error in errors]) for label, x, errors in shown)
    yield drawn("landing-error-against-unknowns",
                "What accuracy costs: error of one adhesive contact against the unknowns of its system, for the "
                "compressed evaluation and the plain dense one; the reference is Johnson's closed form.",
                semilogy("unknowns", "relative error", *curves))  # fmt: skip
    yield {"unknowns": unknowns[-1]}


def _complete() -> Found:
    """A rough profile under loads below and above that of complete contact."""
    surface = posed("rough_100").surface()
    amplitude = full_contact_amplitudes(surface.orders, surface.amplitudes, surface.period, 1e6 / (1 - 0.5**2))
    x = np.linspace(0, surface.period, 1 << 14, endpoint=False)
    shape = np.cos(2 * np.pi * np.outer(x / surface.period, surface.orders) + surface.phases) @ amplitude
    least = -float(shape.min())
    loading = {"control": "mean_pressure", "targets": [0.5 * least, 0.9 * least, 1.02 * least]}
    result = solved("rough_100", adhesion=None, loading=loading)
    before, last = result.targets[-2:]
    known = Against("exact", "every mode carries E* m q0 h_m / 2")
    energy = float(np.sum(amplitude * surface.amplitudes)) / 4
    # the energy to 2.2e-16 here; sums of 100 terms in another order
    yield known.row("elastic energy per nominal area, relative", "J/m^2", energy, last.elastic_energy, (1e-13, 4e-14))
    yield known.count("contact fraction just above the pressure of complete contact", 1.0, last.contact_fraction, 1e-15)
    yield known.count("gaps left at nine tenths of that pressure (1: some)", 1.0, before.contact_fraction < 1, 1e-15)
    part = slice(0, 1 << 14, 1 << 3)
    yield drawn("complete-contact",
                "Pressure of complete contact under the least mean pressure that keeps it compressive everywhere.",
                axes("x / mm", "pressure / MPa",
                     trace("closed form", x[part] * 1e3, (shape + least)[part] / 1e6)))  # fmt: skip
    yield work("evaluations", result)


def uniform_compliance(thickness: float, nu: float) -> float:
    """c(0) of a layer in m/Pa, the limit of c(q) for long waves."""
    return thickness * (1 - 2 * nu) * (1 + nu) / (YOUNGS_MODULUS * (1 - nu))


def _layer_complete() -> Found:
    nu, thickness, pressure = 0.3, 0.1 * WAVELENGTH, 2e5
    orders, amplitudes, phases = np.array([1, 2, 5]), np.array([20e-6, 10e-6, 3e-6]), [0.0, 1.0, 2.0]
    profile = NOT_SELF_AFFINE | waves_of(bem.Profile.from_harmonics(WAVELENGTH, orders, amplitudes, phases))
    (state,) = solved("rough_100", adhesion=None, solid={"poisson_ratio": nu}, profile=profile,
                      layer={"thickness": thickness},
                      loading={"control": "mean_pressure", "targets": [pressure]}).targets  # fmt: skip
    compliance = layer_compliance(2 * np.pi * orders / WAVELENGTH, thickness, YOUNGS_MODULUS, nu)
    x = np.linspace(0, WAVELENGTH, 1 << 16)
    height = np.cos(2 * np.pi * np.outer(x, orders) / WAVELENGTH + phases) @ amplitudes
    modes = Against("exact", "Carbone and Mangialardi 2008, mode by mode")
    yield modes.row("elastic energy of complete contact", "J/m^2", float(np.sum(amplitudes**2 / compliance)) / 4,
                    state.elastic_energy, (1e-14, 2e-16))  # fmt: skip
    # the highest point on a grid of 65536
    yield modes.row("total displacement, with the mean compression", "m",
                    float(height.max()) + uniform_compliance(thickness, nu) * pressure, state.total_displacement,
                    (2e-10, 7.4e-11))  # fmt: skip


CASES = (
    *(
        case(f"johnson-alpha-{alpha:g}", "closed forms", partial(_johnson, alpha),
             "Does the solver follow the JKR curve of one sinusoid along a whole loop, up to pull-off?",
             r"$p = p^\ast [\sin^2 \psi - \alpha \sqrt{\tan \psi}]$, "
             r"$\Delta = D S (1 - \ln S) + \frac{\alpha p^\ast \lambda}{\pi E^\ast} \sqrt{\tan \psi} \ln S$, "
             r"$S = \sin^2 \psi$, $\psi = \pi a / \lambda$, $p^\ast = \pi E^\ast D / \lambda$",
             "johnson1995 carbone2009", "half_space adhesion unloading", scene="sinusoid",
             problem=f"adhesive wave, alpha {alpha:g}, loop to pull-off")
        for alpha in JOHNSON
    ),
    case("sinusoid-convergence", "convergence", _convergence,
         "How many unknowns does an adhesive contact need for a given accuracy?",
         r"geometric decay: the coupled modes of a patch fall as $\rho^{-n}$, $\rho$ from the nearest gap",
         "johnson1995", "half_space adhesion", problem="adhesive wave, given edges"),
    case("westergaard", "closed forms", _westergaard,
         "Does contact without adhesion reproduce the sinusoid of Westergaard?",
         r"contact fraction $2 \psi / \pi$ at $\Delta = D S (1 - \ln S)$, $p = p^\ast S$, $S = \sin^2 \psi$",
         "westergaard1939", "half_space", scene="sinusoid", problem="wave without adhesion"),
    case("complete-contact", "closed forms", _complete,
         "Does load control end in complete contact at the right pressure and with the right energy?",
         r"$\sigma = \sigma_0 + \sum_m \frac{E^\ast m q_0 h_m}{2} \cos(m q_0 x + \varphi_m)$, "
         r"$U_{\text{el}} = \sum_m \frac{E^\ast m q_0 h_m^2}{8}$",
         "carbone2009 johnson1995", "half_space load_control", scene="rough_100"),
    case("layer-complete-contact", "closed forms", _layer_complete,
         "Has a compressible layer pressed flat the energy and the displacement of its closed form?",
         r"$U_{\text{el}} = \sum_m \frac{h_m^2}{4 c(q_m)}$, $u_{\text{tot}} = h_{\text{max}} + c(0) \sigma_0$",
         "carbone2008", "layer load_control", problem="complete contact of a layer"),
)  # fmt: skip
