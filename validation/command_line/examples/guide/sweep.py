"""A sweep over the work of adhesion: a pandas table of all answers, and a figure (pip install pandas)."""

import pandas as pd

import bem

FACE = bem.Profile.self_affine(period=1e-3, hurst=0.8, rms_height=2e-6, harmonics=40, seed=1)
RUBBER = bem.Solid(youngs_modulus=8e6, poisson_ratio=0.49)
LOADING = {"control": "mean_pressure", "start": 50e3, "stop": 400e3, "count": 8}
works = [0.01, 0.02, 0.04]  # J/m^2
results = [bem.solve(profile=FACE, solid=RUBBER, loading=LOADING, adhesion=bem.Adhesion(w)) for w in works]
tables = [pd.DataFrame(result.to_table("targets")) for result in results]
table = pd.concat(tables, keys=works, names=["work_of_adhesion", None]).reset_index("work_of_adhesion")
curves = table.pivot(index="target", columns="work_of_adhesion", values="contact_fraction")
print(curves)
curves.plot(xlabel="mean pressure / Pa", ylabel="contact fraction").get_figure().savefig("sweep.png", dpi=150)
