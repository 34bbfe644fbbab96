# ---
# jupyter:
#   jupytext:
#     text_representation:
#       extension: .py
#       format_name: percent
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---

# %% [markdown]
# # A sweep over many workers
#
# Work over many states, or many draws of noise, is cut into shards; workers do them in any order, on any machine, and the merged answer is that of a single run, to the last
# bit. Here the workers are two processes of this machine; with `dask_jobqueue.SLURMCluster` they are jobs of a cluster, and nothing else changes.

# %%
import logging
import os
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from dask.distributed import Client, LocalCluster
import palmistry
from palmistry import System, observe
from palmistry.cluster import missing, sweep_command
from workbench import PROGRAM, PROOFS, SYSTEMS

workplace = tempfile.TemporaryDirectory()
folder = Path(workplace.name)
cluster = LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None, silence_logs=logging.CRITICAL)
client = Client(cluster)

# %% [markdown]
# ## The rank at many states
#
# The question is that of a single run. The shards whose parts are missing are submitted, and merged.

# %%
system = System.read(PROOFS / "moll2002" / "general.proof")
found = palmistry.sweep(system, samples=2e4, client=client, shards=7, folder=folder / "parts", progress=False)
assert found.histogram == {10: 20000} and found.certified == 20000
print("rank 10 at", found.histogram[10], "states, certified at", found.certified)
print(*sorted(os.listdir(folder / "parts")), sep="\n")
axes = found.plot()

# %% [markdown]
# In one run it is the same: not nearly, but in every digit of every field. Whose part is lost has it done again, and nothing else.

# %%
alone = system.rank(samples=20000, times=False)
assert alone.json == found.json
(folder / "parts" / "rank-5-of-7.json").unlink()
assert missing(["rank", system.name, "--samples", "20000", "--seed", "1"], 7, folder / "parts", PROGRAM) == [5]
assert palmistry.sweep(system, 2e4, client=client, shards=7, folder=folder / "parts", progress=False).json == alone.json

# %% [markdown]
# ## Studies of an observer
#
# The trials of a scene's studies are cut in the same way: draws of noise at several levels, and first guesses on a grid. A Van der Pol oscillator is measured by its position; position, speed and
# damping are estimated.

# %%
scene = (SYSTEMS / "van_der_pol.toml").read_text()
scene = scene.replace('model = "van_der_pol.proof"', f'model = "{(SYSTEMS / "van_der_pol.proof").as_posix()}"')
scene = scene.replace("duration = 8\nsamples = 161", "duration = 2\nsamples = 21").replace("window = 160\nsteps = 50", "window = 20\nsteps = 12")
scene = scene.replace('["multiple-shooting", "trust-region"]', '["trust-region"]').replace("noise = 0.01", "noise = 1e-4")
scene += """
[study.noise]
levels = [1e-3, 1e-2]
seeds = 8

[study.basin]
x = [-2, 3]
y = [-3, 3]
points = 6
"""
(folder / "oscillator.toml").write_text(scene)
studies = ["observe", str(folder / "oscillator.toml")]
answer = sweep_command(studies, shards=6, folder=folder / "studies", client=client, program=PROGRAM, progress=False)
assert answer == observe(folder / "oscillator.toml", studies=True, times=False).json

# %% [markdown]
# On the left the error over the draws is the bound of Cramér and Rao; on the right, from which first guesses of position and speed the search arrives within one percent of the truth (star).

# %%
names = list(answer["noise"][0]["bound"])
levels = np.array([level["noise"] for level in answer["noise"]])
errors = np.array([[level["root_mean_square_error"][name] for name in names] for level in answer["noise"]])
bounds = np.array([[level["bound"][name] for name in names] for level in answer["noise"]])
assert all(level["converged"] == level["seeds"] == 8 for level in answer["noise"])
# a mean square of 8 draws is within four of its own deviations
assert (np.abs(errors / bounds - 1) < 4 / np.sqrt(2 * 8)).all()

figure, (left, axes) = plt.subplots(1, 2, figsize=(8, 3.4), width_ratios=(1.2, 1))
for place, name in enumerate(names):
    left.loglog(levels, bounds[:, place], color=f"C{place}", label=f"bound of {name}")
    left.loglog(levels, errors[:, place], "o", color=f"C{place}")
left.set(title="Error of 8 draws", xlabel="noise", ylabel="error")
left.legend(fontsize="small")
[basin] = answer["basins"]
x, y = map(np.array, basin["values"])
arrives = np.array(basin["arrives"]).reshape(len(y), len(x))
axes.pcolormesh(x, y, arrives, shading="nearest", cmap="Blues", vmin=0, vmax=1.6, edgecolors="white")
axes.plot(1.2, -0.5, "k*", markersize=10)
axes.set(title=f"{basin['method']} arrives from {100 * basin['fraction']:.0f} %", xlabel="first guess of x", ylabel="first guess of y")
plt.show()
# from the neighbourhood of the truth it does
assert arrives[np.abs(y - -0.5).argmin(), np.abs(x - 1.2).argmin()]
assert arrives.sum() == round(basin["fraction"] * arrives.size)

# %%
client.close()
cluster.close()
workplace.cleanup()
