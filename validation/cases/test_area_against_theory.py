"""Contact area of rough profiles against Persson's theory: one profile, the paper's profile, many Hurst exponents.

The theory is a mean-field one.  Boundary elements exceed its area, most for roughness in one direction and for small
contact, because the theory neglects correlations between neighbouring contacts: a known deviation, with a band for
every load that fails on both sides.  The paper (Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65) states
about half the area in the theory at any load, with adhesion, H = 0.7.

Period 10 mm, h_rms = 50 um, E = 1 MPa, nu = 0.5, gamma = 0.03 J/m^2 with the slope term; 50 to 1000 harmonics.  Without
adhesion the theory knows roughness by its rms slope alone, A/A0 = erf(sqrt 2 sigma_0 / (E* h'_rms)).
"""

import numpy as np
import pytest

from validation.plugin.rows import Code, Quantity
from validation.routes.persson_scenes import persson_contact, persson_spectrum
from validation.routes.scenes import estimates, posed, solved, values

MODULUS = 1e6 / (1 - 0.5**2)
PAPER = "Carbone, Scaraggi, Tartaglino 2009"
CAUSE = "mean-field theory: it neglects correlations between neighbouring contacts, strongest in one direction"
NUMERICS = 1e-5  # relative: accuracy of the theory's numbers
HURST, LOADS = (0.3, 0.5, 0.7, 0.9), (0.02, 0.05, 0.1, 0.2)  # loads over E* h'_rms


def theory(scene, pressures):
    """Return contact fractions of the theory at mean pressures in Pa, which all realisations share."""
    return np.array(
        [persson_contact(scene, pressure, with_separation=False).contact_fraction for pressure in pressures]
    )


@pytest.mark.quick
def test_one_profile(rows):
    """With and without adhesion, how does contact area grow with load, and how far off is the theory?"""
    loads, fewer = np.array([0.002, 0.005, 0.01, 0.02]), {"harmonics": 50}
    loading = {"control": "mean_pressure", "targets": (loads * MODULUS).tolist()}
    states = solved("rough_100", profile=fewer, adhesion=None, loading=loading).targets
    without, adhesive = posed("rough_100", profile=fewer, adhesion=None), posed("rough_100", profile=fewer)
    areas, expected = values(states, "contact_fraction"), theory(without, loads * MODULUS)
    rows.known("contact fraction without adhesion over the theory, 0.002 to 0.02 E*", areas, expected,
               band=(1.25, 1.85), of=Code.BEM, by=Code.THEORY, quantity=Quantity.AREA, cause=CAUSE,
               source="Persson 2001",
               uncertainty=(estimates(states, "contact_fraction"), NUMERICS * expected))
    path = solved("rough_100", profile=fewer, loading={"targets": [30e-6]})
    wet = [state for state in path.states if state.mean_pressure > 0]
    along = np.geomspace(0.001, 0.03, 7)
    rows.curves("Contact area of one rough profile", "mean pressure / E*", "contact fraction",
                {"boundary elements, adhesion": (values(wet, "mean_pressure") / MODULUS,
                                                 values(wet, "contact_fraction")),
                 "theory, adhesion": (along, theory(adhesive, along * MODULUS)),
                 "boundary elements, no adhesion": (loads, areas),
                 "theory, no adhesion": (along, theory(without, along * MODULUS))})


@pytest.mark.standard
def test_paper_profile(rows):
    """For the paper's profile of 1000 harmonics, how large is the contact area, and how far off is the theory?"""
    loads, scene, result = np.arange(1, 9) * 0.0025, posed("paper_profile"), solved("paper_profile")
    assert all(state.certificate.ok for state in result.states)
    assert max(state.certificate.closure or 0.0 for state in result.states) < 1e-8
    states = result.targets[: loads.size]
    assert np.allclose(values(states, "mean_pressure"), loads * MODULUS, rtol=1e-10, atol=0)
    contacts = [persson_contact(scene, load * MODULUS) for load in loads]
    assert all(contact.status == "converged" for contact in contacts)
    areas, expected = values(states, "contact_fraction"), values(contacts, "contact_fraction")
    rows.known("contact fraction over the theory with adhesion, 0.0025 to 0.02 E*", areas, expected, band=(1.7, 2.9),
               of=Code.BEM, by=Code.THEORY, quantity=Quantity.AREA, source=PAPER,
               cause=f"{CAUSE}; at small loads this realisation touches near its highest crest only",
               uncertainty=(estimates(states, "contact_fraction"), NUMERICS * expected))
    rows.count("evaluations", sum(state.evaluations for state in result.states), of=Code.BEM)
    rows.count("patches at 0.02 E*", states[-1].n_patches, within=0.0, of=Code.BEM)
    height = persson_spectrum(scene).h_rms
    pressed = [state for state in result.states if state.n_patches and state.mean_pressure > 0]
    rows.curves("Contact area of the paper's profile", "mean pressure / E*", "contact fraction",
                {"boundary elements": (values(pressed, "mean_pressure") / MODULUS, values(pressed, "contact_fraction")),
                 "theory with adhesion": (loads, expected)})
    rows.curves("Separation of the mean planes", "separation / h_rms", "mean pressure / E*",
                {"boundary elements": (values(pressed, "separation") / height,
                                       values(pressed, "mean_pressure") / MODULUS),
                 "theory with adhesion": (values(contacts, "separation") / height, loads)}, log="y")


def realisation(hurst, seed, adhesive):
    """Return a scene of 100 harmonics and its mean pressures in Pa."""
    profile = {"hurst": hurst, "seed": seed}
    pressures = (np.array(LOADS) * posed("rough_100", profile=profile).surface().rms_slope * MODULUS).tolist()
    if not adhesive:
        loading = {"control": "mean_pressure", "targets": pressures}
        return {"profile": profile, "loading": loading, "adhesion": None}, pressures
    # by separation, because contact jumps under load control
    loading = {"control": "separation", "targets": [1e-6], "at_mean_pressures": pressures[:-1],
               "stop_at_mean_pressure": pressures[-1]}
    return {"profile": profile, "loading": loading}, pressures


def areas_of(hurst, seed, adhesive):
    """Return the contact fractions of one realisation at the loads."""
    tables, pressures = realisation(hurst, seed, adhesive)
    states = [state for state in solved("rough_100", **tables).targets if state.n_patches][: len(pressures)]
    assert np.allclose(values(states, "mean_pressure"), pressures, rtol=1e-9, atol=0)
    return values(states, "contact_fraction")


@pytest.mark.standard
@pytest.mark.parametrize(
    ("adhesive", "seeds", "bands"),
    [pytest.param(False, range(8), ((1.36, 1.76), (1.25, 1.66), (1.22, 1.55), (1.16, 1.39)), id="no adhesion"),
     pytest.param(True, range(2), ((1.9, 3.7), (1.65, 2.6), (1.6, 2.1), (1.35, 1.66)), id="adhesion")],
)
def test_hurst_exponents(rows, adhesive, seeds, bands):
    """Over loads and Hurst exponents, how does the mean area of realisations compare with the theory?"""
    areas = np.array([[areas_of(hurst, seed, adhesive) for seed in seeds] for hurst in HURST])
    expected = np.array([theory(posed("rough_100", **tables), pressures)
                         for tables, pressures in (realisation(hurst, 0, adhesive) for hurst in HURST)])
    means, spread = areas.mean(axis=1), 2 * areas.std(axis=1, ddof=1) / np.sqrt(len(seeds))
    for place, (load, band) in enumerate(zip(LOADS, bands, strict=True)):
        rows.known(f"mean contact fraction over the theory at {load:g} E* h'_rms, H = 0.3, 0.5, 0.7, 0.9",
                   means[:, place], expected[:, place], band=band, of=Code.BEM, by=Code.THEORY, quantity=Quantity.AREA,
                   cause=f"{CAUSE}; {len(seeds)} realisations scatter", source=PAPER,
                   uncertainty=(spread[:, place], NUMERICS * expected[:, place]))
    rows.curves("Contact fraction over load and Hurst exponent", "mean pressure / (E* h'_rms)", "contact fraction",
                {f"boundary elements, H = {hurst:g}": (LOADS, mean) for hurst, mean in zip(HURST, means, strict=True)}
                | {f"theory, H = {hurst:g}": (LOADS, line) for hurst, line in zip(HURST, expected, strict=True)},
                log="xy")
