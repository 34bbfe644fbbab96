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
# # Speed against accuracy
#
# One determinant, that of appendix A.2 of Moll's thesis, in three forms that are equal for all values, by numbers of 8 to 24 digits. What each costs is counted in operations, which
# are the same on every machine; what it is worth, in digits that are right, against the certified value. The same question to the program, for all of its numbers and ways to a derivative, looks like this:

# %%
import matplotlib.pyplot as plt
import palmistry
from workbench import PROOFS

trade = palmistry.run("trade", PROOFS / "moll2002" / "same_rate.proof", samples=200).json
rows = [row for row in trade["derivatives"] if row["digits"]["kind"] == "measured"]
figure, axes = plt.subplots(figsize=(6.4, 0.3 * len(rows) + 0.8))
axes.barh([f"{row['derivative']}, {row['number']}" for row in rows], [row["digits"]["median"] for row in rows])
axes.invert_yaxis()
axes.set(xlabel="right digits of a determinant of Lie derivatives, the median of 200 states")
plt.show()

# %%
from decimal import Decimal, getcontext

import numpy as np
from expanded import NAMES, A, determinant_of
from palmistry import System

general = System.read(PROOFS / "moll2002" / "general.proof")


class Counted:
    """Decimals of so many digits, whose operations are counted."""

    def __init__(self, digits):
        self.digits, self.count = digits, 0
        getcontext().prec = digits

    def add(self, a, b):
        self.count += 1
        return a + b

    def times(self, a, b):
        self.count += 1
        return a * b

    def powers(self, base, exponents):
        """A table of the powers that occur: those of the inverse where they are negative, which costs a division."""
        found = {0: Decimal(1)}
        for sign in (1, -1):
            most = max((sign * exponent for exponent in exponents), default=0)
            if most > 0:
                found[sign] = base if sign > 0 else self.divide(Decimal(1), base)
                for exponent in range(2, most + 1):
                    found[sign * exponent] = self.times(found[sign * (exponent - 1)], found[sign])
        return found

    def divide(self, a, b):
        self.count += 1
        return a / b


# %% [markdown]
# **Term by term.** As computer algebra leaves it when it has expanded everything: 1052 products of powers, summed up.

# %%
def tables(numbers, polynomials, values):
    used = [set() for _ in NAMES]
    for polynomial in polynomials:
        for exponents in polynomial:
            for place, exponent in enumerate(exponents):
                used[place].add(exponent)
    return [numbers.powers(values[name], exponents) for name, exponents in zip(NAMES, used)]


def summed(numbers, polynomial, powers):
    found = None
    for exponents, factor in sorted(polynomial.items()):
        term = Decimal(factor)
        for table, exponent in zip(powers, exponents):
            if exponent:
                term = numbers.times(term, table[exponent])
        found = term if found is None else numbers.add(found, term)
    return Decimal(0) if found is None else found


determinant = determinant_of(A)


def term_by_term(numbers, values):
    return summed(numbers, determinant, tables(numbers, [determinant], values))


# %% [markdown]
# **Nested.** The same polynomial by Horner's scheme: common powers are taken out, variable after variable. With negative powers and ten variables that
# saves nothing here.

# %%
def horner(numbers, polynomial, values, place=0):
    if place == len(NAMES):
        [factor] = polynomial.values()
        return Decimal(factor)
    by_exponent = {}
    for exponents, factor in polynomial.items():
        by_exponent.setdefault(exponents[place], {})[exponents] = factor
    value, found, last = values[place], None, None
    for exponent in sorted(by_exponent, reverse=True):
        inner = horner(numbers, by_exponent[exponent], values, place + 1)
        if found is not None:
            for _ in range(last - exponent):
                found = numbers.times(found, value)
            inner = numbers.add(found, inner)
        found, last = inner, exponent
    for _ in range(abs(last)):
        found = numbers.times(found, value) if last > 0 else numbers.divide(found, value)
    return found


def nested(numbers, values):
    return horner(numbers, determinant, [values[name] for name in NAMES])


# %% [markdown]
# **By elimination.** The sixteen entries, each a short sum, and then Gauss with pivots: nothing is expanded.

# %%
def by_elimination(numbers, values):
    powers = tables(numbers, [entry for row in A for entry in row], values)
    rows = [[summed(numbers, entry, powers) for entry in row] for row in A]
    found = Decimal(1)
    for column in range(4):
        pivot = max(range(column, 4), key=lambda row: abs(rows[row][column]))
        if pivot != column:
            rows[column], rows[pivot], found = rows[pivot], rows[column], -found
        found = numbers.times(found, rows[column][column])
        for row in range(column + 1, 4):
            ratio = numbers.divide(rows[row][column], rows[column][column])
            for other in range(column + 1, 4):
                rows[row][other] = numbers.add(rows[row][other], -numbers.times(ratio, rows[column][other]))
    return found


# %% [markdown]
# At 24 states that are drawn from the sample box, rounded to three decimals so that they are exact in each kind of number. The truth has 40 certain digits.

# %%
BOX = {"r1": (0.5, 3), "r2": (0.5, 3), "omega0": (-3, 3), "rho": (0.3, 2), "s1": (0.5, 3), "s2": (0.5, 3), "omega1": (-3, 3), "omega2": (-3, 3), "phi2": (0.8, 2.4)}
generator = np.random.Generator(np.random.PCG64(4))
states = [{name: f"{generator.uniform(*ends):.3f}" for name, ends in BOX.items()} for _ in range(24)]
truths = [general.eval("det(A)", at={**state, "m": 1}, digits=40).decimal for state in states]
turns = [{name: general.eval(f"{name}(phi2)", at={"phi2": state["phi2"]}, digits=40).decimal for name in ("sin", "cos")} for state in states]

FORMS = {"term by term": term_by_term, "nested": nested, "by elimination": by_elimination}
DIGITS = (8, 10, 12, 16, 24)
right, costs = {}, {}
for form, evaluate in FORMS.items():
    for digits in DIGITS:
        found = []
        for state, truth, turn in zip(states, truths, turns):
            numbers = Counted(digits)
            rate1, rate12 = (Decimal(state["omega1"]) - Decimal(state["omega0"]), Decimal(state["omega1"]) + Decimal(state["omega2"]) - Decimal(state["omega0"]))
            values = {name: Decimal(state[name]) for name in ("r1", "r2", "omega0", "rho", "s1", "s2")}
            values |= {"p": 1 / rate1, "q": 1 / rate12, "c": +turn["cos"], "s": +turn["sin"]}
            value = evaluate(numbers, values)
            costs[form] = max(costs.get(form, 0), numbers.count)
            getcontext().prec = 60
            found.append(float(-max(abs(value / truth - 1), Decimal(10) ** -40).log10()))
        right[form, digits] = (np.median(found), min(found))

print(f"{'':16}operations   right digits with", *(f"{digits:>5}" for digits in DIGITS), "   digits carried, median")
for form in FORMS:
    print(f"{form:16}{costs[form]:10}{'':21}", *(f"{right[form, digits][0]:5.1f}" for digits in DIGITS))

# %%
assert (costs["term by term"], costs["nested"], costs["by elimination"]) == (9857, 13805, 1190)
for digits in DIGITS:
    # what is lost is lost by cancellation: as many digits, however many are carried
    assert digits - 3 < right["by elimination", digits][0] < digits
    assert right["term by term", digits][0] < right["by elimination", digits][0] - 1

figure, axes = plt.subplots()
for form, marker in zip(FORMS, "osD"):
    for digits in DIGITS:
        median, worst = right[form, digits]
        label = form if digits == DIGITS[0] else None
        axes.plot([costs[form]] * 2, [worst, median], color="0.8", zorder=0)
        axes.scatter(costs[form], median, c=digits, vmin=6, vmax=24, cmap="viridis", marker=marker, label=label)
        axes.annotate(digits, (costs[form], median), (5, -3), textcoords="offset points", fontsize="x-small")
axes.set(title="What a form costs, and what it is worth (labels: digits carried)", xlabel="operations", ylabel="right digits, median and worst", xlim=(0, 15500))
axes.legend(loc=(0.25, 0.72))
plt.show()

# %% [markdown]
# The form that costs least is also the best: not a trade at all. What is bought with more digits is bought one by one.
#
# ## The program's numbers
#
# `palmistry trade` asks the same of each kind of number and each way to a derivative and a rank. Digits and wrong ranks depend on the drawn states alone.

# %%
digits = {(row["derivative"], row["number"]): row["digits"] for row in trade["derivatives"] if row["digits"]["kind"] == "measured"}
for (derivative, number), found in digits.items():
    print(f"{derivative:22}{number:18}median {found['median']:6.2f}   worst {found['worst']:6.2f}")

# %%
for number, most in (("f32", 7.3), ("f64", 16)):
    assert most - 2 < digits["graph", number]["median"] <= most
    # a difference loses half of the digits, or a third
    assert digits["forward differences", number]["median"] < 0.6 * most
    assert digits["central differences", number]["median"] < 0.75 * most
certain = [row for row in trade["combinations"] if row["certified"] == 200]
assert certain and all(row["wrong"] == 0 for row in certain)
wrong = sorted({(row["number"], row["rank"]) for row in trade["combinations"] if row["wrong"]})
assert all(number == "f32" or "differences" in str(row) for number, row in wrong) or wrong
print(len(certain), "of", len(trade["combinations"]), "combinations prove the rank at all 200 states")

# %% [markdown]
# How long each takes depends on the machine. It is drawn where you run it, and not kept:

# %% tags=["times"]
figure, axes = plt.subplots()
for number in dict.fromkeys(row["number"] for row in trade["derivatives"]):
    rows = [row for row in trade["derivatives"] if row["number"] == number and row["digits"]["kind"] == "measured"]
    if rows:
        axes.semilogx([1e9 * row["seconds_a_state"] for row in rows], [row["digits"]["median"] for row in rows], "o", label=number)
axes.set(title="Derivatives on this machine", xlabel="nanoseconds a state", ylabel="right digits, median")
axes.legend()
plt.show()
