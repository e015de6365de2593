"""Contact area of rough profiles against Persson's theory, over loads and Hurst exponents.

The theory is a mean-field one.  Boundary elements exceed its area, most for roughness in one direction and for small
contact, because the theory neglects correlations between neighbouring contacts: a known deviation, with a band for
every load that fails on both sides.  The bands were measured by boundary elements: their rows are regressions.  The
paper (Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65) states about half the area in the theory at any
load, with adhesion, H = 0.7: `linecontact replicate` judges that.

Period 10 mm, h_rms = 50 um, E = 1 MPa, nu = 0.5, gamma = 0.03 J/m^2 with the slope term; 100 harmonics.  Without
adhesion the theory knows roughness by its rms slope alone, A/A0 = erf(sqrt 2 sigma_0 / (E* h'_rms)).
"""

import numpy as np
import pytest
from scipy.stats import t

from validation.plugin.rows import Code, Quantity
from validation.routes.persson_scenes import persson_contact
from validation.routes.scenes import posed, solved, values

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
    ("adhesive", "exponents", "seeds", "bands"),
    [pytest.param(False, HURST, range(8), ((1.36, 1.76), (1.25, 1.66), (1.22, 1.55), (1.16, 1.39)), id="no adhesion"),
     pytest.param(True, (0.5, 0.9), range(5), ((1.9, 3.7), (1.65, 2.6), (1.6, 2.1), (1.35, 1.66)), id="adhesion")],
)
def test_hurst_exponents(rows, adhesive, exponents, seeds, bands):
    """Over loads and Hurst exponents, how does the mean area of realisations compare with the theory?"""
    areas = np.array([[areas_of(hurst, seed, adhesive) for seed in seeds] for hurst in exponents])
    expected = np.array([theory(posed("rough_100", **tables), pressures)
                         for tables, pressures in (realisation(hurst, 0, adhesive) for hurst in exponents)])
    means, standard = areas.mean(axis=1), areas.std(axis=1, ddof=1) / np.sqrt(len(seeds))
    spread = t.ppf(0.975, len(seeds) - 1) * standard
    for place, (load, band) in enumerate(zip(LOADS, bands, strict=True)):
        rows.known(f"mean contact fraction over the theory at {load:g} E* h'_rms, H = {', '.join(map(str, exponents))}",
                   means[:, place], expected[:, place], band=band, of=Code.BEM, by=Code.THEORY, quantity=Quantity.AREA,
                   kind="regression",
                   cause=f"{CAUSE}; {len(seeds)} realisations scatter", source=PAPER,
                   uncertainty=(spread[:, place], NUMERICS * expected[:, place]))
    rows.curves("Contact fraction over load and Hurst exponent", "mean pressure / (E* h'_rms)", "contact fraction",
                {f"{code}, H = {hurst:g}": (LOADS, line) for code, lines in
                 (("boundary elements", means), ("theory", expected)) for hurst, line in
                 zip(exponents, lines, strict=True)},
                log="xy")
