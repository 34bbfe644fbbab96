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
# # An observer on recorded data
#
# A robot has driven between three beacons and recorded, twenty times a second, its distances and what its motors did. Where was it, how sure is that, and what if a sensor
# was not as it should be?
#
# The recording is a CSV file. This one is made by a few lines of Python that know nothing of Palmistry, so that they can say at the end what was true. What comes out, of a scene that is shipped: each state
# over time, with two standard deviations.

# %%
import palmistry
from workbench import SYSTEMS, drive

axes = palmistry.observe(SYSTEMS / "beacons.toml").plot()

# %%
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from palmistry import observe

BEACONS = np.array([[-4.0, -3.0], [5.0, -2.0], [1.0, 6.0]])
NAMES = ["sqrt((px + 4)^2 + (py + 3)^2)", "sqrt((px - 5)^2 + (py + 2)^2)", "sqrt((px - 1)^2 + (py - 6)^2)"]
NOISE = 0.02  # m

times = np.linspace(0, 5, 101)
speed, turning = 1 + 0.3 * np.sin(times), 0.6 * np.cos(0.8 * times)
truth = drive(times, lambda t: 1 + 0.3 * np.sin(t), lambda t: 2.2 + 0.75 * np.sin(0.8 * t), (1.5, -1.0))
ranges = np.hypot(*(truth[:, None, :2] - BEACONS).transpose(2, 0, 1))
measured = ranges + np.random.Generator(np.random.PCG64(20)).normal(0, NOISE, ranges.shape)

workplace = tempfile.TemporaryDirectory()
folder = Path(workplace.name)


def record(name, measured):
    """Writes a recording."""
    with open(folder / name, "w", encoding="utf-8") as file:
        file.write(",".join(["time", *NAMES, "v", "w"]) + "\n")
        for row in np.column_stack([times, measured, speed, turning]):
            file.write(",".join(f"{value:.9f}" for value in row) + "\n")


record("drive.csv", measured)
print((folder / "drive.csv").read_text()[:330])

# %% [markdown]
# A scene says which equations to believe, how accurate the sensors are, and what is estimated. There is no first guess: observers begin in the middle of the box that the model's file
# gives for its states.

# %%
SCENE = f"""
title = "A drive between three beacons"
model = "{(SYSTEMS / 'beacons.proof').as_posix()}"

[data]
record = "drive.csv"

[sensor]
noise = {NOISE}

[observer]
methods = ["multiple-shooting"]
estimate = ["px", "py", "theta"]
guess = "sample"
window = 100
steps = 50
"""
(folder / "drive.toml").write_text(SCENE)
found = observe(folder / "drive.toml")
[observer] = found.observers
[update] = observer["updates"]
fit = update["fit"]
print(f"{update['status']}; chi square {fit['chi_square']:.0f} for {fit['degrees_of_freedom']} degrees of freedom; passes the chi-square test: {fit['fits']}")
for name, true in zip(("px", "py", "theta"), truth[0]):
    state = update["states"][name]
    print(f"{name:6} {state['recovered']:9.4f} +- {state['bound']:.4f}   true {true:7.4f}, off by {abs(state['recovered'] - true) / state['bound']:.1f} bounds")

# %% [markdown]
# The *bound* is that of Cramér and Rao: the standard deviation below which no unbiased estimate from these measurements can be. Least squares over the whole window reach it, so that
# an error of one bound is what is to be expected, and of four is not.

# %%
assert update["status"] == "converged" and fit["fits"] and fit["degrees_of_freedom"] == 300
for name, true in zip(("px", "py", "theta"), truth[0]):
    assert abs(update["states"][name]["recovered"] - true) < 4 * update["states"][name]["bound"] < 0.02

track = found.track
assert np.allclose(track["time"], times, rtol=0, atol=1e-9)
figure, (plane, errors) = plt.subplots(1, 2, figsize=(8, 3.8))
plane.plot(*BEACONS.T, "k^", label="beacons")
plane.plot(*truth[:, :2].T, color="0.6", linewidth=5, label="true")
plane.plot(track["px"], track["py"], color="C0", label="recovered")
plane.plot(*truth[0, :2], "o", color="C0")
plane.set(title="The drive", xlabel="x, m", ylabel="y, m", aspect="equal")
plane.legend(fontsize="small")
for place, (name, unit) in enumerate((("px", 1e3), ("py", 1e3), ("theta", 1e3))):
    bound = 2 * track[f"{name}_bound"] * unit
    errors.fill_between(times, 16 * place - bound, 16 * place + bound, color=f"C{place}", alpha=0.25, linewidth=0)
    errors.plot(times, 16 * place + (track[name] - truth[:, place]) * unit, color=f"C{place}")
errors.set(title="Error, and twice the bound", xlabel="time, s", yticks=[0, 16, 32], yticklabels=["px", "py", "theta"])
errors.plot([5.15, 5.15], [-5, 5], color="k", clip_on=False)
errors.text(5.2, 0, "10 mm,\n10 mrad", fontsize="x-small", va="center")
plt.show()

# %% [markdown]
# ## When a sensor is not as it should be
#
# Now the second range is two percent too large. The search still converges, to a state; the program says that the residuals are larger than the noise explains, and what would
# explain it.

# %%
wrong = measured * np.array([1, 1.02, 1])
record("drive.csv", wrong)
found = observe(folder / "drive.toml")
[update] = found.observers[0]["updates"]
fit = update["fit"]
best = max(update["suspects"], key=lambda suspect: suspect["would_explain"]["chi_square"] if suspect["would_explain"] else 0)
print(f"chi square {fit['chi_square']:.0f} for {fit['degrees_of_freedom']} degrees of freedom; passes the chi-square test: {fit['fits']}")
print(f"most likely {best['what']}, off by {100 * best['would_explain']['error']:.2f} %")
assert not fit["fits"] and fit["probability"] < 1e-6
assert best["what"] == f"the gain of {NAMES[1]}" and abs(best["would_explain"]["error"] - 0.02) < 0.004

# %%
workplace.cleanup()
