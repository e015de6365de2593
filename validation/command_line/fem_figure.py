"""The deformed layer with its stress: triangles of the finite elements, displaced, coloured by the normal stress.

Displacements are drawn larger than they are by a factor that is told, the rigid profile with them; only the part near
the face, where contacts are felt, is shown. Colours end where a twentieth of the area has more: the stress is singular
at adhesive edges. Lengths in micrometres, stress in Pa.
"""

import numpy as np
from matplotlib.colors import TwoSlopeNorm
from matplotlib.figure import Figure
from matplotlib.tri import Triangulation

from bem.scene.plots import ShownFigure, own_settings
from fem_reference import Result
from fem_reference.export import field_mesh

SHOWN = 0.5  # periods of depth
RELIEF = 0.08  # of the period: how tall the profile is drawn
BEYOND = 0.05  # of the area: with stresses beyond the ends of the colours


@own_settings()
def deformed_mesh(result: Result) -> Figure:
    """Draw the layer of a state near its face; SI units inside, micrometres on the axes."""
    problem, mesh = result.problem, field_mesh(result)
    x, y = mesh.points[:, 0], mesh.points[:, 1]
    corners = mesh.cells[0].data[:, :3]
    stress = mesh.cell_data["stress"][0][:, 4]
    at = np.linspace(x.min(), x.max(), 1000)
    rigid = (problem.height(at / problem.period) - problem.highest) * problem.unit_height + result.total_displacement
    factor = _round(RELIEF * problem.period / max(float(np.ptp(rigid)), np.finfo(float).tiny))
    moved = np.column_stack([x, y]) + factor * mesh.point_data["displacement"][:, :2]
    shown = y[corners].min(axis=1) < SHOWN * problem.period
    sides = np.diff(np.column_stack([x[corners], x[corners[:, :1]]]), axis=1)
    area = 0.5 * np.abs(
        sides[:, 0] * (y[corners[:, 2]] - y[corners[:, 0]])
        - (x[corners[:, 2]] - x[corners[:, 0]]) * (y[corners[:, 1]] - y[corners[:, 0]])
    )
    order = np.argsort(stress[shown])
    share = np.cumsum(area[shown][order]) / np.sum(area[shown])
    low, high = (float(stress[shown][order][np.searchsorted(share, at)]) for at in (0.5 * BEYOND, 1 - 0.5 * BEYOND))
    span = max(abs(low), abs(high), np.finfo(float).tiny)
    figure = ShownFigure(figsize=(9.0, 5.0), layout="constrained")
    axes = figure.add_subplot(xlabel="x / µm", ylabel=f"depth / µm, displacements times {factor:g}")
    triangles = Triangulation(moved[:, 0] * 1e6, moved[:, 1] * 1e6, corners[shown])
    drawn = axes.tripcolor(
        triangles, stress[shown], cmap="RdBu_r", norm=TwoSlopeNorm(0.0, -span, span), rasterized=True
    )
    axes.triplot(triangles, color="0.3", linewidth=0.15, rasterized=True)
    axes.fill_between(at * 1e6, factor * rigid * 1e6, factor * float(rigid.min()) * 1e6, color="0.8", zorder=-1)
    axes.plot(at * 1e6, factor * rigid * 1e6, color="black", linewidth=1.0)
    axes.invert_yaxis()
    figure.colorbar(drawn, label="normal stress across the layer / Pa (tension positive)", extend="both")
    axes.set_title(f"{result.status}: contact fraction {result.contact_fraction:.4g}, {result.mean_pressure:.4g} Pa")
    return figure


def _round(factor: float) -> float:
    """Round a factor to one digit; 1 if nothing is to be enlarged."""
    if not np.isfinite(factor) or factor > 1e12:
        return 1.0
    return float(f"{factor:.0e}")
