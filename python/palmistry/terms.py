"""Terms: each is kept once, as a tuple of an operation and its operands, and known by its number."""

from fractions import Fraction

TERMS, NUMBERS, SLOPES = [], {}, {}


def term(*parts):
    """The number of a term."""
    if parts not in NUMBERS:
        NUMBERS[parts] = len(TERMS)
        TERMS.append(parts)
    return NUMBERS[parts]


def const(value):
    return term("const", Fraction(value))


def symbol(name):
    return term("symbol", name)


def value(a):
    """The number that a constant is."""
    return TERMS[a][1] if TERMS[a][0] == "const" else None


def add(a, b):
    if value(a) == 0 or value(b) == 0:
        return b if value(a) == 0 else a
    return const(value(a) + value(b)) if None not in (value(a), value(b)) else term("add", a, b)


def mul(a, b):
    # nothing is folded that may have no value: 0/x is no zero
    if value(a) == 1 or value(b) == 1:
        return b if value(a) == 1 else a
    return const(value(a) * value(b)) if None not in (value(a), value(b)) else term("mul", a, b)


def neg(a):
    return mul(const(-1), a)


def sub(a, b):
    return add(a, neg(b))


def div(a, b):
    return mul(a, power(b, -1))


def power(a, n):
    if value(a) and abs(n) < 10_000:
        return const(value(a) ** n)
    return a if n == 1 else const(1) if n == 0 else term("power", a, n)


def apply(function, a):
    return term("apply", function, a)


def operands(parts):
    return {"add": parts[1:], "mul": parts[1:], "power": parts[1:2], "apply": parts[2:]}.get(parts[0], ())


def reachable(roots):
    """All terms that some are made of, operands first."""
    seen, order, stack = set(), [], [(root, False) for root in roots]
    while stack:
        at, ready = stack.pop()
        if ready:
            order.append(at)
        elif at not in seen:
            seen.add(at)
            stack.append((at, True))
            stack.extend((below, False) for below in operands(TERMS[at]) if below not in seen)
    return order


def symbols(roots):
    return {TERMS[at][1] for at in reachable(roots) if TERMS[at][0] == "symbol"}


def slope(function, a, own):
    """The derivative of a function by its argument."""
    root = lambda: apply("sqrt", sub(const(1), power(a, 2)))
    return {
        "sin": lambda: apply("cos", a), "cos": lambda: neg(apply("sin", a)), "exp": lambda: own,
        "log": lambda: power(a, -1), "sqrt": lambda: power(mul(const(2), own), -1),
        "atan": lambda: power(add(const(1), power(a, 2)), -1),
        "asin": lambda: power(root(), -1), "acos": lambda: neg(power(root(), -1)),
    }[function]()


def derivative(root, by):
    """The derivative of a term by a symbol."""
    for at in reachable([root]):
        if (at, by) in SLOPES:
            continue
        parts, zero = TERMS[at], const(0)
        inner = [SLOPES[below, by] for below in operands(parts)]
        if at == by:
            found = const(1)
        elif all(below == zero for below in inner):
            found = zero
        elif parts[0] == "add":
            found = add(*inner)
        elif parts[0] == "mul":
            a, b = (zero if one == zero else mul(one, other) for one, other in zip(inner, reversed(parts[1:])))
            found = add(a, b)
        elif parts[0] == "power":
            found = mul(mul(const(parts[2]), power(parts[1], parts[2] - 1)), inner[0])
        else:
            found = mul(slope(parts[1], parts[2], at), inner[0])
        SLOPES[at, by] = found
    return SLOPES[root, by]


def replaced(root, by):
    """A term with other terms in the place of symbols, all at once."""
    images = {}
    for at in reachable([root]):
        parts = TERMS[at]
        if parts[0] == "symbol":
            images[at] = by.get(parts[1], at)
        elif parts[0] in ("add", "mul"):
            images[at] = (add if parts[0] == "add" else mul)(images[parts[1]], images[parts[2]])
        elif parts[0] == "power":
            images[at] = power(images[parts[1]], parts[2])
        else:
            images[at] = apply(parts[1], images[parts[2]]) if parts[0] == "apply" else at
    return images[root]


def determinant(rows):
    """By the minors of the first rows: each is kept."""
    minors = {(): const(1)}
    for row in rows:
        grown = {}
        for columns, minor in minors.items():
            for column, entry in enumerate(row):
                if column in columns or value(entry) == 0:
                    continue
                place = sum(1 for other in columns if other > column)
                part = mul(minor, entry if place % 2 == 0 else neg(entry))
                key = tuple(sorted((*columns, column)))
                grown[key] = add(grown[key], part) if key in grown else part
        minors = grown
    return next(iter(minors.values()), const(0))


def inverse(rows):
    """By Cramer's rule."""
    across, size = power(determinant(rows), -1), range(len(rows))
    without = lambda i, j: [[rows[k][l] for l in size if l != j] for k in size if k != i]
    part = lambda i, j: mul(determinant(without(j, i)), across)
    return [[part(i, j) if (i + j) % 2 == 0 else neg(part(i, j)) for j in size] for i in size]
