"""The modular power-series test of observability and identifiability in plain Python: an oracle that shares nothing with
ours.

A. Sedoglavic, A probabilistic algorithm to test local algebraic observability in polynomial time, J. Symbolic Computation
33 (2002): the outputs are power series in time at a random state modulo a prime, inputs are random series, and the rank of
what their coefficients depend on is the rank of the observability codistribution, unless chance made it smaller. Orders are
added until one adds nothing (the span of the differentials is then closed under d/dt) or the rank is full.

Functions are adjoined by their differential equations, with values at the state as if independent; what they hide is seen
at true states only (`Reals`), where the same series are computed in three hundred digits.
"""

import json
import math
import sys
import time
from fractions import Fraction

import numpy as np

from number_kinds import NoSuchState, Prime, Reals
from proof_file import ProofFile


LEAVES = ("number", "constant", "state", "input", "signal")


def derivative(model, name, node, argument):
    """The node of F'(a), where `node` is F(a): what the function's differential equation needs."""
    number = lambda value: model.node("number", Fraction(value))
    square = lambda value: model.node("*", value, value)
    one_less = lambda value: model.node("-", number(1), square(value))
    return {
        "exp": lambda: node,
        "log": lambda: model.node("/", number(1), argument),
        "sqrt": lambda: model.node("/", number(Fraction(1, 2)), node),
        "sin": lambda: model.node("cos", argument),
        "cos": lambda: model.node("-", number(0), model.node("sin", argument)),
        "tan": lambda: model.node("+", number(1), square(node)),
        "sinh": lambda: model.node("cosh", argument),
        "cosh": lambda: model.node("sinh", argument),
        "tanh": lambda: one_less(node),
        "atan": lambda: model.node("/", number(1), model.node("+", number(1), square(argument))),
        "asin": lambda: model.node("/", number(1), model.node("sqrt", one_less(argument))),
        "acos": lambda: model.node("/", number(-1), model.node("sqrt", one_less(argument))),
        "abs": lambda: model.node("/", argument, node),
    }[name]()


class Program:
    """Rates and outputs as nodes, functions with what their differential equations need."""

    def __init__(self, model):
        self.model = model
        for index, (name, *operands) in enumerate(model.nodes):  # x^r = exp(r log x)
            if name == "^":
                logarithm = model.node("*", operands[1], model.node("log", operands[0]))
                model.nodes[index] = ("exp", logarithm)
        self.rates = [model.node("number", Fraction(0)) for _ in model.states]
        for index, (role, rates) in enumerate(model.fields):
            for name, rate in rates.items():
                rate = rate if role == "drift" else model.node("*", model.node("input", index), rate)
                place = model.states.index(name)
                self.rates[place] = model.node("+", self.rates[place], rate)
        self.derivatives, done = {}, 0
        while done < len(model.nodes):  # the list grows
            name, *operands = model.nodes[done]
            if name not in (*LEAVES, "+", "-", "*", "/"):
                self.derivatives[done] = derivative(model, name, done, operands[0])
            done += 1
        still = [
            rate == model.node("number", Fraction(0)) or model.nodes[rate][0] == "number" and not model.nodes[rate][1]
            for rate in self.rates
        ]
        self.order, self.constant = self.sorted(), {}
        for node in self.order:
            name, *operands = model.nodes[node]
            self.constant[node] = (
                name in ("number", "constant")
                or name == "state"
                and still[operands[0]]
                or name not in ("input", "signal", "state")
                and all(self.constant[o] for o in operands)
            )

    def sorted(self):
        """What values need, operands first."""
        found, seen = [], set()
        for root in [
            *self.model.outputs,
            *self.rates,
            *(self.model.node("state", place) for place in range(len(self.rates))),
        ]:
            stack = [(root, False)]
            while stack:
                node, ready = stack.pop()
                if ready:
                    found.append(node)
                elif node not in seen:
                    seen.add(node)
                    name, *operands = self.model.nodes[node]
                    if node in self.derivatives:  # it comes behind: its lower orders are needed, and it may need this one
                        stack.append((self.derivatives[node], False))
                    stack.append((node, True))
                    if name == "state" and self.model.initial.get(operands[0]) is not None:
                        stack.append((self.model.initial[operands[0]], False))
                    if name not in LEAVES:
                        stack += [(operand, False) for operand in operands]
        return found


class Series:
    """The power series of all nodes at a random state with random inputs, and what they depend on at the beginning."""

    def __init__(self, model, numbers, size):
        self.model, self.numbers, self.program = model, numbers, Program(model)
        zeros = lambda *shape: np.full(shape, numbers.number(Fraction(0)), dtype=numbers.dtype)
        self.value = {node: zeros(size) for node in self.program.order}
        self.slope = {node: zeros(size, len(model.states)) for node in self.program.order}  # by the states at the beginning
        self.inverse = [None] + [numbers.invert(order) for order in range(1, size)]
        self.signals = {name: [numbers.draw("input") for _ in range(size + most)] for name, most in model.signals.items()}
        self.spans = {name: [constant(model, node, numbers) for node in span] for name, span in model.ranges.items()}

    def step(self, order):
        """All coefficients of this order, where those of lower ones are there."""
        program, numbers, value, slope = self.program, self.numbers, self.value, self.slope
        for node in program.order:
            name, *operands = self.model.nodes[node]
            if name in LEAVES:
                self.leaf(node, name, operands, order)
            elif not (order and program.constant[node]):
                value[node][order] = coefficient(
                    name,
                    [value[operand] for operand in operands],
                    value[node],
                    order,
                    numbers,
                    self.inverse,
                    value.get(program.derivatives.get(node)),
                )
        for node in program.order:
            name, *operands = self.model.nodes[node]
            if not (name in LEAVES or order and program.constant[node]):
                slope[node][order] = dependence(name, operands, node, order, value, slope, program, numbers)

    def leaf(self, node, name, operands, order):
        numbers, model, here, slope = self.numbers, self.model, self.value[node], self.slope[node]
        reduce = numbers.reduce
        if name == "input":
            here[order] = numbers.draw("input")
        elif name == "signal":
            here[order] = reduce(
                self.signals[operands[0]][order + operands[1]] * math.perm(order + operands[1], operands[1])
            )
        elif name == "state" and order:
            rate = self.program.rates[operands[0]]
            here[order] = reduce(self.value[rate][order - 1] * self.inverse[order])
            slope[order] = reduce(self.slope[rate][order - 1] * self.inverse[order])
        elif name == "state":
            begin = model.initial.get(operands[0])
            here[0] = (
                self.value[begin][0] if begin is not None else numbers.draw(None, self.spans.get(model.states[operands[0]]))
            )
            slope[0, operands[0]] = numbers.number(Fraction(1))
        elif order == 0:
            here[0] = (
                numbers.number(operands[0]) if name == "number" else numbers.draw(operands[0], self.spans.get(operands[0]))
            )


def generic_rank(model, numbers, limit=None):
    """Rank, dimension, the unknowns that are seen, and the order up to which series were needed."""
    model = ProofFile(model) if isinstance(model, str) else model
    unknowns = [index for index, unknown in enumerate(model.unknown) if unknown and index not in model.initial]
    # where something is known initial condition, what is seen is not closed under d/dt: a few orders more than ever were needed
    size = (limit or (2 * len(model.states) + 5 if model.initial else len(model.states))) + 1
    series, basis, everything = Series(model, numbers, size), [], []
    for order in range(size):
        series.step(order)
        before = len(everything)
        for output in model.outputs:
            insert(everything, series.slope[output][order].copy(), numbers)
            insert(basis, series.slope[output][order][unknowns], numbers)
        if len(basis) == len(unknowns) or len(everything) == before and not model.initial:
            break
    small, hidden = getattr(numbers, "small", 0), set(range(len(unknowns))) - {pivot for pivot, _ in basis}
    for pivot, row in basis:
        if any(abs(entry) > small for column, entry in enumerate(row) if column != pivot):
            hidden.add(pivot)
    return {
        "rank": len(basis),
        "dimension": len(unknowns),
        "order": order,
        "seen": [model.states[state] for column, state in enumerate(unknowns) if column not in hidden],
        "not_seen": [model.states[state] for column, state in enumerate(unknowns) if column in hidden],
    }


def accessible_rank(model, numbers):
    """The rank of the strong accessibility distribution and that of the distribution with the drift: what inputs reach to first order
    from a random trajectory, P(t)^-1 g(x(t)) with P the derivative of the flow, whose coefficients span it."""
    model = ProofFile(model) if isinstance(model, str) else model
    states, reduce = len(model.states), numbers.reduce
    size = states + 2
    series, basis = Series(model, numbers, size), []
    nodes = [model.node("state", place) for place in range(states)]
    inputs = [[rates.get(name) for name in model.states] for role, rates in model.fields if role == "input"]
    moved = [np.full((size, states), numbers.number(Fraction(0)), dtype=numbers.dtype) for _ in inputs]
    for order in range(size):
        series.step(order)
        flow = np.array([[series.slope[node][k] for node in nodes] for k in range(order + 1)])
        before = len(basis)
        for field, back in zip(inputs, moved):
            here = np.array([0 if rate is None else series.value[rate][order] for rate in field], dtype=numbers.dtype)
            for k in range(1, order + 1):
                here = reduce(here - reduce(flow[k] @ back[order - k]))
            back[order] = here
            insert(basis, here.copy(), numbers)
        if len(basis) == before:
            break
    strong = len(basis)
    insert(basis, np.array([series.value[rate][0] for rate in series.program.rates], dtype=numbers.dtype), numbers)
    return {"rank": len(basis), "strong": strong, "dimension": states}


def constant(model, node, numbers):
    """A number that is written in a range, in reals; of no use modulo a prime."""
    if isinstance(numbers, Prime):
        return None
    name, *operands = model.nodes[node]
    if name == "number":
        return numbers.number(operands[0])
    if name == "constant":
        return numbers.draw(operands[0])
    left, right = ([constant(model, operand, numbers) for operand in operands] + [None])[:2]
    return {"+": lambda: left + right, "-": lambda: left - right, "*": lambda: left * right, "/": lambda: left / right}.get(
        name, lambda: numbers.function(name, left)
    )()


def coefficient(name, operands, here, order, numbers, inverse, derived):
    """One coefficient of the power series of a node, from lower ones of its own and those of its operands."""
    reduce, (left, right) = numbers.reduce, (operands + [None])[:2]
    if name == "+":
        return reduce(left[order] + right[order])
    if name == "-":
        return reduce(left[order] - right[order])
    if name == "*":
        return reduce(np.dot(left[: order + 1], right[order::-1]))
    if name == "/":
        rest = reduce(np.dot(here[:order], right[order:0:-1])) if order else 0
        return reduce((left[order] - rest) * numbers.invert(right[0]))
    if order == 0:
        return numbers.function(name, left[0])
    weighted = reduce(left[1 : order + 1] * np.arange(1, order + 1))  # F(a)' = F'(a) a'
    return reduce(reduce(np.dot(weighted, derived[order - 1 :: -1])) * inverse[order])


def product(factor, factor_is_constant, slope, slope_is_constant, order, numbers):
    """One coefficient of a series times a series of slopes."""
    if factor_is_constant:
        return numbers.reduce(factor[0] * slope[order])
    if slope_is_constant:
        return numbers.reduce(factor[order] * slope[0])
    return numbers.reduce(np.dot(factor[: order + 1], slope[order::-1]))


def dependence(name, operands, node, order, value, slope, program, numbers):
    reduce, still = numbers.reduce, program.constant
    left, right = (operands + [None])[:2]
    if name == "+":
        return reduce(slope[left][order] + slope[right][order])
    if name == "-":
        return reduce(slope[left][order] - slope[right][order])
    times = lambda factor, of: product(value[factor], still[factor], slope[of], still[of], order, numbers)
    if name == "*":
        return reduce(times(left, right) + times(right, left))
    if name == "/":  # d(a/b) b = da - (a/b) db
        rest = times(node, right)
        if order and not still[right]:
            rest = rest + reduce(np.dot(value[right][1 : order + 1], slope[node][order - 1 :: -1]))
        return reduce(reduce(slope[left][order] - rest) * numbers.invert(value[right][0]))
    return times(program.derivatives[node], left)


def insert(basis, row, numbers):
    """Adds a row to a basis in reduced echelon form, if it is not in its span."""
    reduce = numbers.reduce
    if isinstance(numbers, Reals):
        largest = max((abs(entry) for entry in row), default=0)
        if largest < numbers.small:
            return
        row = row / largest
    for pivot, other in basis:
        row = reduce(row - row[pivot] * other)
    pivot = numbers.pivot(row)
    if pivot is None:
        return
    row = reduce(row * numbers.invert(row[pivot]))
    for place, (old, other) in enumerate(basis):
        basis[place] = (old, reduce(other - other[pivot] * row))
    basis.append((pivot, row))


def decide(text, seed=1, tries=2, numbers=Prime, question=generic_rank):
    """The best of several random states, for the text of a file or what was read of it."""
    answers, attempt = [], 0
    while len(answers) < tries:
        attempt += 1
        try:
            answers.append(question(text, numbers(1000 * seed + attempt)))
        except NoSuchState:
            if attempt > 200:
                raise
    return max(answers, key=lambda answer: (answer["rank"], answer.get("strong", 0), len(answer.get("seen", ""))))


if __name__ == "__main__":
    for path in [argument for argument in sys.argv[1:] if not argument.startswith("--")]:
        began = time.process_time()
        answer = decide(
            open(path, encoding="utf-8").read(),
            numbers=Reals if "--reals" in sys.argv else Prime,
            tries=1 if "--once" in sys.argv else 2,
        )
        print(json.dumps({"file": path, **answer, "seconds": round(time.process_time() - began, 4)}))
