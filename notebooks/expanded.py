"""The determinant of appendix A.2 of Moll's thesis as a computer algebra system expands it: a sum of products of ten quantities.

A polynomial is a table from exponents, in the order of `NAMES`, to coefficients. The mass is 1.
"""

from itertools import combinations

NAMES = "r1 r2 omega0 rho s1 s2 p q c s".split()  # p, q: one over the relative rates of the contacts; c, s: of phi2


def power(name, exponent=1):
    return {tuple(exponent * (name == other) for other in NAMES): 1}


def total(*terms):
    found = {}
    for term in terms:
        for exponents, factor in term.items():
            found[exponents] = found.get(exponents, 0) + factor
    return {exponents: factor for exponents, factor in found.items() if factor}


def times(first, *others):
    for other in others:
        found = {}
        for left, a in first.items():
            for right, b in other.items():
                key = tuple(map(int.__add__, left, right))
                found[key] = found.get(key, 0) + a * b
        first = {exponents: factor for exponents, factor in found.items() if factor}
    return first


def minus(term):
    return {exponents: -factor for exponents, factor in term.items()}


def derivative(term, name):
    place, found = NAMES.index(name), {}
    for exponents, factor in term.items():
        if exponents[place]:
            key = exponents[:place] + (exponents[place] - 1,) + exponents[place + 1:]
            found[key] = found.get(key, 0) + factor * exponents[place]
    if name == "omega0":  # p = 1/(omega1 - omega0), q = 1/(omega1 + omega2 - omega0)
        return total(found, times(derivative(term, "p"), power("p", 2)), times(derivative(term, "q"), power("q", 2)))
    return found


def along(field, function):
    """The Lie derivative."""
    return total(*(times(derivative(function, name), rate) for name, rate in field.items()))


r1, r2, rho, s1, s2, p, q, c = map(power, "r1 r2 rho s1 s2 p q c".split())
over_s = power("s", -1)
d1 = total(times(r1, c, over_s), times(r2, over_s), minus(s1))            # 3.18
d2 = total(minus(times(r2, c, over_s)), minus(times(r1, over_s)), s2)     # 3.19
mixed = total(times(rho, rho, c), minus(times(d1, d2)))
by1, by2 = (times(power("rho", -2), power(name, -1)) for name in ("s1", "s2"))
g1 = {"omega0": minus(times(d1, by1)), "s1": times(total(times(rho, rho), times(d1, d1)), by1, p), "s2": times(mixed, by1, q)}
g2 = {"omega0": times(d2, by2), "s1": times(mixed, by2, p), "s2": times(total(times(rho, rho), times(d2, d2)), by2, q)}
words = [along(g1, s1), along(g1, along(g1, s1)), along(g2, s2), along(g2, along(g2, s2))]
A = [[derivative(word, name) for name in ("r1", "r2", "omega0", "rho")] for word in words]



def determinant_of(matrix):
    """By its minors of two upper and two lower rows."""
    def minor(upper, lower, a, b):
        return total(times(matrix[upper][a], matrix[lower][b]), minus(times(matrix[upper][b], matrix[lower][a])))
    found = {}
    for a, b in combinations(range(4), 2):
        product = times(minor(0, 1, a, b), minor(2, 3, *(column for column in range(4) if column not in (a, b))))
        found = total(found, product if (a + b) % 2 else minus(product))
    return found
