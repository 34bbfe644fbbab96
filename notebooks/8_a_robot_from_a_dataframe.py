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
# # A robot from a DataFrame
#
# A robot has logged its speed, its turn rate and its distances to two beacons. The gyro has a bias that nobody has measured. Where was it, how large is the bias, and how sure is that? First the answer.

# %%
import matplotlib.pyplot as plt
import numpy as np
import palmistry
import pandas as pd
from workbench import drive

BEACONS = np.array([[-4.0, -3.0], [5.0, 4.0]])
NOISE, BIAS = 0.03, 0.05  # m, rad/s

times = np.linspace(0, 12, 181)
speed, turning = 1 + 0.3 * np.sin(times), 0.5 * np.cos(0.5 * times)
truth = drive(times, lambda t: 1 + 0.3 * np.sin(t), lambda t: 0.4 + np.sin(0.5 * t), (-1.0, -2.0))
ranges = np.hypot(*(truth[:, None, :2] - BEACONS).transpose(2, 0, 1))
log = pd.DataFrame({"near": ranges[:, 0], "far": ranges[:, 1], "v": speed, "gyro": turning + BIAS}, index=pd.Index(times, name="time"))
log[["near", "far"]] += np.random.Generator(np.random.PCG64(4)).normal(0, NOISE, (times.size, 2))


def rates(x, p, u):
    return [u.v * np.cos(x.theta), u.v * np.sin(x.theta), u.gyro - p.bias]


def distances(x):
    return {name: np.sqrt((x.px - a) ** 2 + (x.py - b) ** 2) for name, (a, b) in zip(("near", "far"), BEACONS.tolist())}


robot = palmistry.System.from_function(
    rates, distances, states="px, py, theta", parameters="bias", unknown="bias", inputs="v, gyro", angles="theta",
    sample={"px": (-3, 3), "py": (-4, 2), "theta": (-2, 2), "bias": (-0.2, 0.2)},
)
found = palmistry.observe(robot, log, noise=NOISE, times=False)

figure, (left, right) = plt.subplots(1, 2, figsize=(8, 3.6), width_ratios=(1, 1.2))
left.plot(*BEACONS.T, "k^", label="beacons")
left.plot(truth[:, 0], truth[:, 1], color="0.6", linewidth=5, label="true")
left.plot(found.track["px"], found.track["py"], label="estimated")
left.set(title="The drive", xlabel="x, m", ylabel="y, m", aspect="equal")
left.legend(fontsize="small")
for place, (name, column, unit) in enumerate((("px", 0, "m"), ("py", 1, "m"), ("theta", 2, "rad"))):
    error, bound = found.track[name] - truth[:, column], found.track[f"{name}_bound"]
    right.fill_between(times, 0.06 * place - 2 * bound, 0.06 * place + 2 * bound, alpha=0.3, color=f"C{place}")
    right.plot(times, 0.06 * place + error, color=f"C{place}", label=f"{name}, {unit}")
right.set(title="Error, and two standard deviations", xlabel="time, s", yticks=[0, 0.06, 0.12], ylim=(-0.03, 0.16), yticklabels=["0", "0", "0"])
right.legend(fontsize="small", ncols=3)
plt.show()

# %% [markdown]
# ## Can it know?
#
# The functions that simulate are the functions that are asked: they were called once, with symbols. Position, heading and bias are observable, generically; so a log determines them, if the robot moves.

# %%
print(robot.source)

# %%
print(robot.observability(), robot.identifiability(), sep="\n\n")
assert set(robot.rank(samples=0).unknowns["verdict"].tolist()) == {"locally observable", "locally identifiable"}

# %% [markdown]
# ## What the log says
#
# A row of the DataFrame is a sample; its index is the time. Each estimate has a standard deviation, which is the bound that no unbiased estimate beats, and a test says whether the residuals are what the noise explains.

# %%
print(found.text)

# %%
estimates = dict(zip(found.estimates["name"].tolist(), zip(found.estimates["estimate"], found.estimates["deviation"])))
for name, true in {"px": -1.0, "py": -2.0, "theta": 0.4, "bias": BIAS}.items():
    value, deviation = estimates[name]
    assert abs(value - true) < 4 * deviation, name
assert found.fits
correlation = found.covariance() / np.outer(found.estimates["deviation"], found.estimates["deviation"])
print("heading and bias are correlated by", round(correlation[2, 3], 2))

# %% [markdown]
# ## A model that is wrong says so
#
# Who forgets the bias gets a path as well, and not a word of warning from most least squares. Here the test fails.

# %%
careless = palmistry.observe(robot, log, noise=NOISE, unknowns=["px", "py", "theta"], known={"bias": 0})
assert not careless.fits
update = careless.updates[0]
print(update["status"], f"chi-square {update['fit']['chi_square']:.0f} of {update['fit']['degrees_of_freedom']}")
