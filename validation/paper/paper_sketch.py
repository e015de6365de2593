"""The paper's problem drawn: a layer pressed on a rigid profile, and the heights by which a contact is described.

A layer of thickness d, its upper face bonded to a rigid plate, on a profile h(x) of period lambda.  All heights are
above the mean plane of the profile: its highest crest h_max; the mean plane of the deformed face at the separation
s = h_max - Delta, Delta the penetration; the face as it would be without pressure at s - u_m, u_m its mean displacement

    u_m = d (1 - 2 nu) (1 + nu) / (E (1 - nu)) sigma_0,    the plate at s - u_m + d.

What is drawn is a solution: few waves, high beside their length and far from stiff, so that everything can be seen.

Source: Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65, arXiv:1006.0601, figures 1 and 2 and section 2.
"""

import numpy as np

from bem.scene.result import Result
from validation.harness.arrays import FloatArray
from validation.harness.figure_data import axes, bars, drawn, shaded, trace
from validation.harness.schema import Figure, Series
from validation.references.paper_problem import PERIOD, YOUNGS_MODULUS, Table, lines, scene

POISSON_RATIO, THICKNESS, WORK = 0.4, 0.15 * PERIOD, 3.0
ORDERS, AMPLITUDES, PHASES = (1, 3, 4, 7), (1.5e-4, 1.5e-4, 1.2e-4, 0.4e-4), (3.0, 0.6, 2.5, 1.0)  # m
SEPARATION = 1.6e-4  # m


def sketch_scene() -> Table:
    """Return the content of the sketch's scene file."""
    return scene(
        "layer on a profile of four waves",
        lines(ORDERS, AMPLITUDES, PHASES),
        {"control": "separation", "targets": [SEPARATION]},
        WORK,
        solid={"youngs_modulus": YOUNGS_MODULUS, "poisson_ratio": POISSON_RATIO},
        layer={"thickness": THICKNESS},
        output={"shapes": [SEPARATION]},
    )


def mean_displacement(mean_pressure: float) -> float:
    """Return u_m in m of the sketched layer under a mean pressure in Pa: its face cannot spread."""
    stiffness = YOUNGS_MODULUS * (1 - POISSON_RATIO) / ((1 - 2 * POISSON_RATIO) * (1 + POISSON_RATIO))
    return THICKNESS * mean_pressure / stiffness


def sketches(result: Result, layer_id: str, heights_id: str) -> tuple[Figure, Figure]:
    """Draw the layer on its profile, and its heights, from a result of `sketch_scene`."""
    state, fields = result.targets[0], result.fields
    around = np.append(np.arange(fields["x_0"].size), 0)  # the first place again at the end of the period
    x = np.append(fields["x_0"], fields["x_0"][0] + PERIOD) / PERIOD
    face = fields["displacement_0"][around] + state.separation
    profile = face - fields["gap_0"][around]
    touching = fields["patch_0"][around] >= 0
    u_m = mean_displacement(state.mean_pressure)
    heights = {"crest": state.separation + state.penetration, "face": state.separation, "free": state.separation - u_m}
    plate = heights["free"] + THICKNESS
    contact = trace("contact", x, [y * 1e3 if on else None for y, on in zip(face, touching, strict=True)], hue=1)
    rigid = _between("rigid profile h(x)", x, np.full(face.size, profile.min() - 1e-4), profile, 5)
    layer = drawn(
        layer_id,
        "The problem: an elastic layer of thickness d, bonded to a rigid plate, touches a rigid profile of period "
        f"λ in {state.n_patches} strips; adhesion pulls its face down beside them. A solution, drawn to scale.",
        axes(
            r"$x/\lambda$",
            "height / mm",
            rigid,
            _between("elastic layer", x, face, np.full(face.size, plate), 0),
            contact,
            trace("rigid plate", [x[0], x[-1]], [plate * 1e3] * 2, hue=5),
            _height("$d$", x[0] + 0.05, heights["free"], plate, 2),
        ),
    )
    described = drawn(
        heights_id,
        "Heights above the mean plane of the profile: the highest crest h_max, the mean plane of the deformed face at "
        "the separation s, the penetration Δ = h_max - s, and the mean displacement u_m of the face, which a layer "
        "that can be compressed has under its mean pressure, a half-space not.",
        axes(
            r"$x/\lambda$",
            "height / mm",
            rigid,
            trace("face of the layer", x, face * 1e3, hue=0),
            contact,
            *(
                trace(label, [x[0], x[-1]], [y * 1e3] * 2, "dashed", hue)
                for label, y, hue in (
                    ("mean plane of the face", heights["face"], 0),
                    ("the face without pressure", heights["free"], 4),
                )
            ),
            _height("$h_{max}$", x[0] + 0.05, 0.0, heights["crest"], 5),
            _height("$s$", x[0] + 0.12, 0.0, heights["face"], 2),
            _height(r"$\Delta$", x[0] + 0.19, heights["face"], heights["crest"], 3),
            _height("$u_m$", x[0] + 0.26, heights["free"], heights["face"], 4),
        ),
    )
    return layer, described


def _between(label: str, x: FloatArray, lower: FloatArray, upper: FloatArray, hue: int) -> Series:
    return shaded(label, x, lower * 1e3, upper * 1e3, hue)


def _height(label: str, x: float, lower: float, upper: float, hue: int) -> Series:
    """Draw a vertical dimension."""
    return bars(label, [x], [lower * 1e3], [upper * 1e3], hue)
