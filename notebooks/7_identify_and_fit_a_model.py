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
# # Identify a model, and fit it
#
# A model comes as a file of StructuralIdentifiability.jl: prey and predators, of which the prey are counted. Which of its four rates are identifiable from such counts, what follows for the others, and what are they?
# Below is the answer; how it comes about is what follows.

# %%
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import palmistry
import workbench  # noqa: F401, pictures that are the same each time

MODEL = """
ode = @ODEmodel(
    prey'(t) = a*prey(t) - b*prey(t)*hunters(t),
    hunters'(t) = -c*hunters(t) + d*prey(t)*hunters(t),
    counted(t) = prey(t)
)
"""
TRUTH = {"prey": 1.0, "hunters": 0.5, "a": 1.1, "b": 0.9, "c": 0.8, "d": 0.7}
NOISE = 0.02


def population(times):
    """What was true, by Runge and Kutta's rule: code that knows nothing of Palmistry."""
    a, b, c, d = (TRUTH[name] for name in "abcd")
    rate = lambda z: np.array([a * z[0] - b * z[0] * z[1], -c * z[1] + d * z[0] * z[1]])
    path = [np.array([TRUTH["prey"], TRUTH["hunters"]])]
    for begin, end in zip(times[:-1], times[1:]):
        z, h = path[-1], (end - begin) / 20
        for _ in range(20):
            k1 = rate(z)
            k2 = rate(z + h / 2 * k1)
            k3 = rate(z + h / 2 * k2)
            z = z + h / 6 * (k1 + 2 * k2 + 2 * k3 + rate(z + h * k3))
        path.append(z)
    return np.array(path)


times = np.linspace(0, 12, 121)
true = population(times)
counts = true[:, 0] + np.random.Generator(np.random.PCG64(7)).normal(0, NOISE, times.size)

workplace = tempfile.TemporaryDirectory()
file = Path(workplace.name) / "hunt.jl"
file.write_text(MODEL)
model = palmistry.import_model(file)
RANGES = "\nsample prey in [0.2, 3]  hunters in [0.2, 3]  a in [0.2, 2]  c in [0.2, 2]  d in [0.2, 2]\n"
fixed = palmistry.System.parse(model.source.replace("param a, b, c, d unknown", "param b = 0.9\nparam a, c, d unknown") + RANGES)
found = palmistry.observe(fixed, {"time": times, fixed.outputs[0]: counts}, noise=NOISE)

figure, axes = plt.subplots()
for place, name in enumerate(("prey", "hunters")):
    value, bound = found.track[name], found.track[f"{name}_bound"]
    axes.fill_between(times, value - 2 * bound, value + 2 * bound, alpha=0.4, color=f"C{place}")
    axes.plot(times, value, color=f"C{place}", label=f"{name}, estimated")
    axes.plot(times, true[:, place], "k:", linewidth=1)
axes.plot(times, counts, ".", color="C0", markersize=3, label="counted")
axes.set(title="Hunters, who were never counted (dotted: truth)", xlabel="time")
axes.legend(fontsize="small")
plt.show()

# %% [markdown]
# ## Before any fit: what is identifiable from counts
#
# Of the six unknowns two are not identifiable. The direction along which no count changes says which, and what combination of them is: hunters in another unit, `b` for each of them smaller by as much.

# %%
print(model.observability(globally=True))
print(model.identifiability(globally=True))
print("identifiable functions:", model.identifiable_functions(), "  unobservable direction:", model.unobservable_directions())

# %%
verdicts = dict(zip(model.identifiability()["name"].tolist(), model.identifiability(globally=True)["verdict"].tolist()))
assert verdicts == {"a": "globally identifiable", "b": "non-identifiable", "c": "globally identifiable", "d": "globally identifiable"}
[direction] = model.unobservable_directions()
assert set(direction) == {"hunters", "b"}

# %% [markdown]
# So a fit of all six has no answer, whatever the optimiser: the observer says so, and what would make them identifiable.

# %%
everything = palmistry.System.parse(model.source + RANGES.rstrip() + "  b in [0.2, 2]\n")
all_six = palmistry.observe(everything, {"time": times, everything.outputs[0]: counts}, noise=NOISE, times=False)
assert not all_six.fits
print(all_six.text)

# %% [markdown]
# ## With one rate known
#
# Once `b` is known, from how often a hunter eats, all others follow: each within its standard deviation, and the residuals are what the noise explains.

# %%
print(found.estimates)
for name, value, deviation in zip(*(found.estimates[key] for key in ("name", "estimate", "deviation"))):
    assert abs(value - TRUTH[name]) < 4 * deviation, name
assert found.fits

# %%
workplace.cleanup()
