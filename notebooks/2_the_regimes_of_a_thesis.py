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
# # The regimes of a thesis
#
# M. Moll's thesis (*Shape Reconstruction Using Active Tactile Sensors*, 2002) holds an unknown body between two palms and asks whether touch alone determines how it
# moves. In each of four regimes it finds so many differentials of Lie derivatives that their determinant is not zero at one state. Here they are asked
# about at thousands, and the determinants of appendix A.2 to forty digits. Below, over the two distances from the contacts to the body's centre of mass: how well the worst of ten unknowns is observable
# in the general regime.

# %%
import palmistry
from workbench import PROOFS

general = palmistry.System.read(PROOFS / "moll2002" / "general.proof")
HELD = {"r1": 1.5, "r2": 1.5, "omega0": 1, "s1": 1, "s2": 2, "phi1": 0.5, "omega1": 2, "phi2": 2, "omega2": 1.5, "rho": 0.5, "alpha1": 0, "alpha2": 0}
others = {name: HELD[name] for name in general.coordinates() if name not in ("r1", "r2")}
axes = general.map("r1", "r2", ranges={"r1": (0.2, 3), "r2": (0.2, 3)}, at=others, size=60).plot()

# %%
from decimal import Decimal, getcontext

import matplotlib.pyplot as plt
import numpy as np
from expanded import NAMES, A, determinant_of
from matplotlib.colors import LogNorm
from palmistry import System

REGIMES = {
    "general": "both palms swing",
    "same_rate": "both palms turn at one constant rate",
    "one_palm_fixed": "one palm is fixed",
    "fixed_palms": "both palms are fixed",
}
systems = {name: System.read(PROOFS / "moll2002" / f"{name}.proof") for name in REGIMES}
ranks = {name: system.rank(samples=2000) for name, system in systems.items()}
for name, found in ranks.items():
    print(f"{REGIMES[name]:38} {found.dimension:2} unknowns, rank {found.generic:2}; at drawn states {found.histogram}, certified at {found.certified}")

# %% [markdown]
# In all four the rank condition holds, generically and at each state that was drawn. The palms' own sensors measure some states; what remains to be observed are
# three unknowns or four, the two radii, the body's rate, and in the general case its radius of gyration.

# %%
assert [found.generic for found in ranks.values()] == [10, 6, 6, 5]
for found in ranks.values():
    assert found.histogram == {found.dimension: 2000} and found.certified == 2000
    # what never changes, as the radius of gyration, counts as a parameter
    assert set(found.unknowns["verdict"]) <= {"locally observable", "locally identifiable"}

# %% [markdown]
# ## Where the states are observable well
#
# Full rank says nothing of how well. The standard deviation of a state over its prior one does, where each Lie derivative is measured up to its own range: on the ridges two states read
# nearly the same. Drawn is the worst state, by all derivatives that were taken. All coordinates are held but two; at every point of the maps the rank is full, and certified.

# %%
MAPS = {
    "general": (("r1", 0.2, 3), ("r2", 0.2, 3)),
    "same_rate": (("omega0", -3, 3), ("phi1", -1.5, 1.5)),
    "one_palm_fixed": (("omega0", -1, 4), ("r1", 0.2, 6)),
    "fixed_palms": (("omega0", -3, 3), ("r1", 0.2, 3)),
}
POINTS = 90


def middles(low, high):
    """Points of a grid; none of them is a round number."""
    return low + (high - low) * (np.arange(POINTS) + 0.5) / POINTS


figure, all_axes = plt.subplots(2, 2, figsize=(8, 6))
worst = {}
for axes, (name, ((first, *across), (second, *up))) in zip(all_axes.flat, MAPS.items()):
    grid = dict(zip((first, second), np.meshgrid(middles(*across), middles(*up))))
    system = systems[name]
    states = {state: grid[state].ravel() if state in grid else np.full(POINTS**2, float(HELD[state])) for state in system.coordinates()}
    verdicts = system.verdicts(states)
    assert (verdicts.rank == ranks[name].dimension).all() and verdicts.certified.all(), name
    deviations = system.standard_deviations(states)
    worst[name] = np.max([deviations[unknown] for unknown in deviations], axis=0).reshape(POINTS, POINTS)
    drawn = axes.imshow(worst[name], origin="lower", extent=(*across, *up), aspect="auto", norm=LogNorm(), cmap="magma_r", interpolation="nearest")
    axes.set(title=REGIMES[name], xlabel=first, ylabel=second)
    figure.colorbar(drawn, ax=axes)
figure.suptitle("Standard deviation of the worst state over its prior one (light: well observable)")
plt.show()

# %% [markdown]
# The number does not depend on units. The radii of a body that does not turn are unobservable, and the slower it turns the worse they are observable:

# %%
same_rate = systems["same_rate"]
medians = {}
for rate in ("1", "1/10", "1/100"):
    deviations = same_rate.rank(samples=400, at={"omega0": rate}).json["standard_deviations"]["of"]
    medians[rate] = {row["state"]: row["median"] for row in deviations}
    print(f"omega0 = {rate:6} standard deviation over the prior one: r1 {medians[rate]['r1']:10.1f}   r2 {medians[rate]['r2']:10.1f}")
assert 30 < medians["1/100"]["r1"] / medians["1/10"]["r1"] < 300 and 30 < medians["1/100"]["r2"] / medians["1/10"]["r2"] < 300

# on the set itself, where states are drawn that meet the equation exactly, two are lost
floor = same_rate.rank(samples=100, where="omega0 = 0")
assert floor.histogram == {4: 100} and floor.certified == 100
[kind["example"] for kind in floor.json["unobservable"]]

# %% [markdown]
# ## The determinants, and why their digits are wrong
#
# The thesis prints three determinants of its matrix `A`, each to ten digits. Here they are to as many digits as one likes, all of them certain:

# %%
WHERE = {"m": 1, "rho": 0.5, "phi2": 2, "s1": 1, "s2": 2, "r1": 1.5, "r2": 1.5, "omega0": 1}
PRINTED = [((2, 3), "25.67009841"), ((2, 0), "1647.940473"), ((0, 2), "1634.446156")]


def right_figures(value, truth):
    """How many figures of a number are right: by its relative error."""
    return int(-(abs(Decimal(value) - Decimal(truth)) / abs(Decimal(truth))).log10() + Decimal("0.3"))


general = systems["general"]
truths = []
for (omega1, omega2), printed in PRINTED:
    truth = general.eval("det(A)", at={**WHERE, "omega1": omega1, "omega2": omega2}, digits=40).value
    truths.append(truth)
    print(f"printed {printed:12}  certain {truth}  right figures: {right_figures(printed, truth)}")
assert truths[0] == "25.66837164143751007333938458550988284346"
assert [right_figures(printed, truth) for (_, printed), truth in zip(PRINTED, truths)] == [4, 6, 4]

# %% [markdown]
# Why? The thesis says that Maple computed with ten digits. We expand the determinant as a computer algebra system does, and put numbers into it term by term, with ten digits. All
# that occurs are products of ten quantities, so that some lines of Python suffice (`expanded.py`): a polynomial is a table from exponents to coefficients.

# %%
determinant = determinant_of(A)
entries = sum(len(entry) for row in A for entry in row)
print(len(determinant), "terms; the sixteen entries of the matrix have", entries)
assert (len(determinant), entries) == (1052, 176)


# %%
def term_by_term(digits, omega1, omega2):
    """The expanded determinant by numbers of so many digits, and the size of its terms."""
    getcontext().prec = digits
    sine, cosine = (Decimal(general.eval(f"{name}(phi2)", at={"phi2": 2}, digits=digits).value) for name in ("sin", "cos"))
    values = {"r1": Decimal("1.5"), "r2": Decimal("1.5"), "omega0": Decimal(1), "rho": Decimal("0.5"), "s1": Decimal(1), "s2": Decimal(2),
              "p": 1 / Decimal(omega1 - 1), "q": 1 / Decimal(omega1 + omega2 - 1), "c": cosine, "s": sine}
    found, size = Decimal(0), Decimal(0)
    for exponents, factor in sorted(determinant.items()):
        term = Decimal(factor)
        for name, exponent in zip(NAMES, exponents):
            term *= values[name] ** exponent
        found, size = found + term, size + abs(term)
    return found, size


for ((omega1, omega2), printed), truth in zip(PRINTED, truths):
    ten, size = term_by_term(10, omega1, omega2)
    lost = float((size / abs(ten)).log10())
    print(f"printed {printed:12} with ten digits, term by term {ten:12}  certain {truth[:12]}  the terms are 10^{lost:.1f} times as large")
    assert 5 < lost < 7 and right_figures(ten, truth) <= 6
    # with forty digits the same terms are right: it is the cancellation alone
    getcontext().prec = 40
    assert right_figures(term_by_term(40, omega1, omega2)[0], truth) >= 30

# %% [markdown]
# The terms are a million times as large as their sum, and cancel: of ten digits four remain. Another order of the same terms errs otherwise, by as much. Each digit more that is
# carried is one more that is right:

# %%
carried = list(range(8, 31))
getcontext().prec = 60
figure, axes = plt.subplots()
for ((omega1, omega2), printed), truth in zip(PRINTED, truths):
    errors = [abs(term_by_term(digits, omega1, omega2)[0] / Decimal(truth) - 1) for digits in carried]
    axes.semilogy(carried, [float(error) for error in errors], ".-", label=f"omega1 = {omega1}, omega2 = {omega2}")
    getcontext().prec = 60
    axes.plot(10, float(abs(Decimal(printed) / Decimal(truth) - 1)), "k*", markersize=10)
axes.plot([], [], "k*", markersize=10, label="printed")
axes.semilogy(carried, [10.0 ** -digits for digits in carried], color="0.7", label="what was carried")
axes.set(title="Error of the expanded determinant", xlabel="digits that are carried", ylabel="relative error")
axes.legend()
plt.show()

# %% [markdown]
# The conclusion of the thesis, that the determinant is not zero, holds all the same. In its file the three are errata, the printed form refuted and the right one proved:

# %%
errata = [claim for claim in general.prove("A.section2") if claim.verdict == "erratum"]
assert len(errata) == 3
for claim in errata:
    printed, corrected = claim.json["printed"]["verdict"], claim.json["corrected"]["verdict"]
    assert (printed, corrected) == ("refuted", "proved")
    print(f"{claim.id:26} printed: {printed}, corrected: {corrected}")
