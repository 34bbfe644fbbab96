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
# # Is my system observable?
#
# A robot in the plane has a position `(x, y)` and a heading `theta`. It drives and turns as it is commanded, and measures how far away a beacon is.
# Can it know where it is? We write the system down as a paper would, and ask. With three beacons the answer looks like this: over the plane, how well it knows the worst of the three,
# as a part of what it knew before.

# %%
import palmistry
from workbench import SYSTEMS

axes = palmistry.System.read(SYSTEMS / "beacons.proof").map("px", "py", at={"theta": 0.3, "v": 1, "w": 0.2}, size=80).plot()

# %% [markdown]
# What is observable with one beacon, and what with two, comes now.

# %%
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import LogNorm
from palmistry import System

ROBOT = """
system "A robot that measures its distance to beacons"

state x, y, theta                  # position and heading
param b = 2                        # beacons at (0, 0) and (b, 0)
angle theta

input drive                        # forward
  x'     = cos(theta)
  y'     = sin(theta)
  theta' = 0

input turn                         # on the spot
  theta'  = 1
  others' = 0

let q1 = (x^2 + y^2)/2             # half the squared distances
let q2 = ((x - b)^2 + y^2)/2
output OUTPUTS

sample x in [-3, 5]  y in [-3, 3]  theta in [-3, 3]
"""

one = System.parse(ROBOT.replace("OUTPUTS", "q1"))
found = one.rank(samples=1000)
found.generic, found.dimension, found.histogram, found.certified

# %% [markdown]
# The rank is two of three: generically, and at each of a thousand drawn states, where the rank is proved at that very state. It stays so
# however long one drives.

# %%
assert found.generic == 2 and found.json["higher_derivatives_cannot_raise_it"]
assert found.histogram == {2: 1000} and found.certified == 1000
{str(name): str(verdict) for name, verdict in zip(found.unknowns["name"], found.unknowns["verdict"])}

# %% [markdown]
# ## What is unobservable
#
# None of the three is observable alone. The unobservable direction is a vector field: along it no measurement of the beacon changes. It is found in
# closed form, and so are functions of the states that *are* observable.

# %%
[field] = found.json["unobservable_directions"]["fields"]
assert field["components"] == {"x": "-y", "y": "x", "theta": "1"}
observable = [function["text"] for function in found.json["unobservable_directions"]["functions"]]
assert sorted(observable) == ["x*cos(theta) + y*sin(theta)", "x*sin(theta) - y*cos(theta)"]
print("unobservable direction:", field["text"])
print("observable:", ", ".join(observable))

# %% [markdown]
# It turns the robot about the beacon, heading and all. Below, the three robots of one colour have the same measurements for ever, whatever they do: here all of
# them drive along the same arc, and their distances stay the same.

# %%
def along(state, angle):
    """The flow of the unobservable vector field: a rotation."""
    x, y, theta = state
    c, s = np.cos(angle), np.sin(angle)
    return np.array([c * x - s * y, s * x + c * y, theta + angle])


def arc(state, steps=60, step=0.025, turning=0.9):
    """The path of a robot that drives and turns."""
    path = [np.array(state, float)]
    for _ in range(steps):
        x, y, theta = path[-1]
        middle = theta + turning * step / 2
        path.append(np.array([x + step * np.cos(middle), y + step * np.sin(middle), theta + turning * step]))
    return np.array(path)


figure, (plane, ranges) = plt.subplots(1, 2, figsize=(8, 3.8))
grid = np.linspace(-3, 3, 9)
gx, gy = np.meshgrid(grid, grid)
plane.quiver(gx, gy, -gy, gx, color="0.8", width=0.004)
for colour, start in (("C0", (2.0, 0.5, 2.0)), ("C1", (0.6, 1.2, 0.2))):
    for angle, style in ((0, "-"), (2.1, "--"), (4.2, ":")):
        path = arc(along(start, angle))
        plane.plot(path[:, 0], path[:, 1], style, color=colour)
        plane.plot(*path[0, :2], "o", color=colour, markersize=5)
        ranges.plot(0.025 * np.arange(len(path)), np.hypot(path[:, 0], path[:, 1]), style, color=colour, linewidth=3 - 0.4 * angle)
plane.plot(0, 0, "k^")
plane.annotate("beacon", (0, 0), (0.15, -0.45))
plane.set(title="Six robots, and the unobservable direction", xlabel="x", ylabel="y", aspect="equal")
ranges.set(title="What they read", xlabel="time", ylabel="distance")
plt.show()

# each path is the first one, rotated, and reads the same
same = np.hypot(*arc(along((2.0, 0.5, 2.0), 2.1))[:, :2].T) - np.hypot(*arc((2.0, 0.5, 2.0))[:, :2].T)
assert np.abs(same).max() < 1e-12

# %% [markdown]
# That nothing changes along it can be claimed, and is proved: for all states, and not for those that were drawn.

# %%
claimed = System.parse(ROBOT.replace("OUTPUTS", "q1") + """
claim turning: [d(q1); d(L(drive, q1)); d(L(turn, drive, q1))]*[-y; x; 1] = [0; 0; 0]
""")
[claim] = claimed.prove()
assert claim.verdict == "proved"
claim.statement, claim.verdict

# %% [markdown]
# ## A second beacon
#
# With two all three states are observable, and without any longer derivative than the rates of the distances. How well differs from place to place: where each of
# these is measured up to its own range, a state is known up to a standard deviation, in parts of what is known of it before. Drawn is that of the worst of the three.

# %%
two = System.parse(ROBOT.replace("OUTPUTS", "q1, q2"))
found = two.rank(samples=1000)
assert found.generic == 3 and found.histogram == {3: 1000} and found.certified == 1000

x, y = np.meshgrid(np.linspace(-3, 5, 161), np.linspace(-2.975, 2.975, 120))
verdicts = two.verdicts({"x": x.ravel(), "y": y.ravel(), "theta": np.full(x.size, 0.5)})
assert (verdicts.rank == 3).all() and verdicts.certified.all()
deviations = two.standard_deviations({"x": x.ravel(), "y": y.ravel(), "theta": np.full(x.size, 0.5)}, order=1)
worst = np.max([deviations[name] for name in ("x", "y", "theta")], axis=0).reshape(x.shape)

figure, axes = plt.subplots()
drawn = axes.imshow(worst, origin="lower", extent=(-3, 5, -3, 3), interpolation="nearest", norm=LogNorm(), cmap="magma_r")
axes.plot([0, 2], [0, 0], "w^", markeredgecolor="k")
axes.set(title="How well the worst state is observable, at heading 0.5", xlabel="x", ylabel="y")
figure.colorbar(drawn, label="standard deviation / prior (light: well observable)")
plt.show()

# %% [markdown]
# Best beside the beacons, poorly on their line, and the more so the farther out. It is the map that `palmistry verify` draws of this file. At each of these 19320 states the rank is certified. That it is full at *all*
# states of a box, and not at those that one looks at, takes another engine, which covers the box with boxes on which a minor keeps its sign:

# %%
line, beside = worst[60], worst[110]
assert 0 <= x[0][np.argmin(line)] <= 2 and line[0] > 2 * line.min() and line[-1] > 2 * line.min()
assert beside[80] < 0.5 * line.min()
certificate = two.certify(boxes=1000)
assert certificate.proved_fraction == 1
print(f"proved on {100 * certificate.proved_fraction:.0f} % of the box, by {certificate.json['boxes']} boxes")
