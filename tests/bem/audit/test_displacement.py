"""The displacement of a given pressure against adaptive integration of its defining integral."""

import numpy as np
import pytest
from scipy.integrate import quad

from bem.audit.displacement import DisplacementField, GapPoints, regular_part
from bem.geometry.patches import PatchPressure

WIDE = PatchPressure(np.array([0.4]), np.array([6.1]), (np.array([1.0, 0.3, -0.4, 0.2, 0.05]),))
TWO = PatchPressure(
    np.array([0.2, 5.0]),
    np.array([1.7, 6.4]),
    (np.array([0.7, -0.3, 0.4, 0.1]), np.array([-0.2, 0.5, 0.1, 0.3, 0.2, -0.1])),
)
NARROW = PatchPressure(np.array([3.0]), np.array([3.001]), (np.array([0.5, 0.2, -0.1]),))
ROUGH = PatchPressure(np.array([1.0]), np.array([2.5]), (np.cos(1.3 * np.arange(60) ** 2) / (1 + np.arange(60)),))
NEARLY_COMPLETE = PatchPressure(np.array([0.01]), np.array([2 * np.pi - 0.01]), (np.array([1.0, 0.2, -0.1, 0.3]),))
pressures = pytest.mark.parametrize(
    "pressure", [WIDE, TWO, NARROW, ROUGH, NEARLY_COMPLETE], ids=["wide", "two", "narrow", "rough", "nearly complete"]
)


def integrated(pressure, x, angle=None, owner=None):
    """-(1/pi) int log|2 sin((x - x')/2)| sigma dx' by adaptive quadrature; `angle` of x in its patch `owner`."""
    total = 0.0
    for i, charge in enumerate(pressure.charges):
        c, r = (pressure.left[i] + pressure.right[i]) / 2, (pressure.right[i] - pressure.left[i]) / 2

        def integrand(b, c=c, r=r, charge=charge, own=i == owner):
            # within a patch the difference of cosines as a product, without cancellation
            half = r * np.sin((b + angle) / 2) * np.sin((b - angle) / 2) if own else (x - c - r * np.cos(b)) / 2
            return np.log(np.abs(2 * np.sin(half))) * np.polynomial.chebyshev.chebval(np.cos(b), charge)

        breaks = [angle] if i == owner and 0 < angle < np.pi else None
        total += quad(integrand, 0, np.pi, points=breaks, epsabs=1e-12, epsrel=1e-12, limit=400)[0]
    return -total / np.pi


def at_extrema(pressure):
    angles = [np.arange(q.size + 1) * np.pi / q.size for q in pressure.charges]
    centers, radii = (pressure.left + pressure.right) / 2, (pressure.right - pressure.left) / 2
    x = np.concatenate([c + r * np.cos(a) for c, r, a in zip(centers, radii, angles, strict=True)])
    owner = np.repeat(np.arange(len(angles)), [a.size for a in angles])
    return x, owner, np.concatenate(angles)


def gap_points(pressure, gap, fractions):
    left = pressure.right[gap]
    width = np.append(pressure.left[1:], pressure.left[0] + 2 * np.pi)[gap] - left
    share = np.asarray(fractions)
    return GapPoints(np.full(share.size, gap), width * share, width * (1 - share))


@pressures
def test_displacement_in_contact_is_the_integral(pressure):
    x, owner, angle = at_extrema(pressure)
    exact = [integrated(pressure, *point) for point in zip(x, angle, owner, strict=True)]
    # measured 1.2e-13, the error of the adaptive rule
    np.testing.assert_allclose(DisplacementField(pressure).in_contact(x, owner), exact, rtol=0, atol=3e-13)


@pytest.mark.filterwarnings("ignore::scipy.integrate.IntegrationWarning")
@pressures
@pytest.mark.parametrize("gap", [0, -1], ids=["first gap", "last gap"])
def test_displacement_in_a_gap_is_the_integral(pressure, gap):
    field = DisplacementField(pressure)
    points = gap_points(pressure, gap % field.count, [1e-3, 0.02, 0.3, 0.5, 0.8, 0.999])
    exact = [integrated(pressure, x) for x in field.positions(points)]
    np.testing.assert_allclose(field.in_gaps(points), exact, rtol=0, atol=5e-12)


@pressures
def test_displacement_is_continuous_at_the_edges(pressure):
    field = DisplacementField(pressure)
    x, owner, angle = at_extrema(pressure)
    inside = field.in_contact(x, owner)
    edges = np.concatenate([inside[angle == 0], inside[np.isclose(angle, np.pi)]])  # right edges, then left ones
    width = np.append(pressure.left[1:], pressure.left[0] + 2 * np.pi) - pressure.right
    gaps, zero = np.arange(field.count), np.zeros(field.count)
    from_right = field.in_gaps(GapPoints(gaps, zero, width))
    from_left = field.in_gaps(GapPoints((gaps - 1) % field.count, np.roll(width, 1), zero))
    np.testing.assert_allclose(np.concatenate([from_right, from_left]), edges, rtol=0, atol=1e-14)  # measured 2e-15


@pressures
def test_opening_beside_an_edge_is_given_by_the_stress_intensity(pressure):
    # u(rho) - u(0) = K sqrt(2 rho / pi), K = -sqrt(pi / r) q(1), relative error sqrt(rho/r)
    field = DisplacementField(pressure)
    radius = (pressure.right[0] - pressure.left[0]) / 2
    rho = 1e-12 * radius
    gap = float(np.append(pressure.left[1:], pressure.left[0] + 2 * np.pi)[0] - pressure.right[0])
    u = field.in_gaps(GapPoints(np.zeros(2, dtype=int), np.array([0.0, rho]), np.array([gap, gap - rho])))
    stress_intensity = -np.sqrt(np.pi / radius) * pressure.charges[0].sum()
    assert (u[1] - u[0]) / np.sqrt(2 * rho / np.pi) == pytest.approx(stress_intensity, rel=2e-5)


def many():
    """Sixty patches, the narrowest 1e-4 of the widest, some next to one another, with up to 40 terms."""
    random = np.random.default_rng(4)
    width, gap = 10 ** random.uniform(-4, 0, 60), 10 ** random.uniform(-4, 0, 60)
    share = 2 * np.pi / (width.sum() + gap.sum())
    right = np.cumsum(width + gap) * share
    sizes = random.integers(2, 40, 60)
    charges = tuple(w * random.normal(size=n) / np.arange(1, n + 1) for w, n in zip(width, sizes, strict=True))
    return PatchPressure(right - width * share, right, charges)


def alone(pressure, i):
    part = slice(i, i + 1)
    return DisplacementField(PatchPressure(pressure.left[part], pressure.right[part], pressure.charges[part]))


def test_patches_far_and_near_superpose():
    pressure = many()
    fields = [alone(pressure, i) for i in range(pressure.left.size)]
    gaps = [gap_points(pressure, i, [1e-3, 0.3, 0.9]) for i in range(len(fields))]
    points = GapPoints(*(np.concatenate([getattr(part, f) for part in gaps]) for f in GapPoints.__annotations__))
    x, total = pressure.right[points.gap] + points.from_left, np.zeros(points.gap.size)
    for i, field in enumerate(fields):
        from_left = np.where(points.gap == i, points.from_left, (x - pressure.right[i]) % (2 * np.pi))
        before = (points.gap + 1) % len(fields) == i
        from_right = np.where(before, points.from_right, (pressure.left[i] - x) % (2 * np.pi))
        total += field.in_gaps(GapPoints(np.zeros(x.size, dtype=int), from_left, from_right))
    np.testing.assert_allclose(DisplacementField(pressure).in_gaps(points), total, rtol=0, atol=2e-14)  # measured 7e-15


def test_patches_far_and_near_superpose_in_contact():
    pressure = many()
    x, owner, _ = at_extrema(pressure)
    total = np.empty(x.size)
    for i in range(pressure.left.size):
        own = owner == i
        total[own] = alone(pressure, i).in_contact(x[own], np.zeros(int(own.sum()), dtype=int))
        for j in range(pressure.left.size):
            if j == i:
                continue
            to_right, to_left = (x[own] - pressure.right[j]) % (2 * np.pi), (pressure.left[j] - x[own]) % (2 * np.pi)
            total[own] += alone(pressure, j).in_gaps(GapPoints(np.zeros(to_left.size, dtype=int), to_right, to_left))
    # measured 3e-14: positions lose 1e-15 beside narrow gaps
    np.testing.assert_allclose(DisplacementField(pressure).in_contact(x, owner), total, rtol=0, atol=8e-14)


def test_rotation_by_a_period_changes_nothing():
    field = DisplacementField(TWO)
    moved = DisplacementField(PatchPressure(TWO.left - 2 * np.pi, TWO.right - 2 * np.pi, TWO.charges))
    points = gap_points(TWO, 0, [0.1, 0.6])
    np.testing.assert_allclose(field.in_gaps(points), moved.in_gaps(points), rtol=0, atol=1e-14)


def test_layer_scales_the_modes_of_the_pressure():
    plain = DisplacementField(TWO)
    soft = DisplacementField(TWO, lambda m: np.where(m == 2, 0.7, 1.0))
    points = gap_points(TWO, 0, [0.1, 0.4, 0.6])
    x = plain.positions(points)
    sigma = 0j
    for a, b, q in zip(TWO.left, TWO.right, TWO.charges, strict=True):
        t = np.cos((np.arange(40) + 0.5) * np.pi / 40)
        value = np.polynomial.chebyshev.chebval(t, q) * (np.pi / 40)
        sigma += np.sum(value * np.exp(-2j * ((a + b) / 2 + (b - a) / 2 * t))) / (2 * np.pi)
    expected = -0.3 * 2 * (sigma / 2 * np.exp(2j * x)).real
    np.testing.assert_allclose(soft.in_gaps(points) - plain.in_gaps(points), expected, rtol=0, atol=1e-14)


def test_a_ratio_that_never_tends_to_one_is_refused():
    with pytest.raises(ValueError, match="not 1 to rounding"):
        DisplacementField(TWO, lambda m: 0 * m + 0.9)


def test_regular_part_is_the_series():
    charge = np.array([0.3, -0.2, 0.5])
    np.testing.assert_allclose(
        regular_part(charge, 3), np.polynomial.chebyshev.chebval(np.cos(np.arange(4) * np.pi / 3), charge), atol=1e-15
    )
