"""Random systems as proof files, each from a seed: rational ones and with functions, with and without inputs, with unseen motions put
in on purpose, and the edges at which programs stumble. `random_systems.py SEED` prints one.
"""

import random
import sys

from families import proof

POSITIVE = "[1/2, 2]"


class Maker:
    def __init__(self, seed):
        self.random = random.Random(seed)
        self.functions = self.random.random() < 0.4
        self.rational = self.random.random() < 0.6
        self.extreme = self.random.random() < 0.1

    def chance(self, probability):
        return self.random.random() < probability

    def number(self):
        if self.extreme and self.chance(0.3):
            return self.random.choice(
                ["1000000007", "1/1000000000", "123456789/1000", "0.000000001", "99999999999999999999", "7/1000003"]
            )
        return self.random.choice(["1", "2", "3", "5", "1/2", "2/3", "7", "0.25", "10"])

    def expression(self, names, depth=3):
        """Finite and smooth where all names are positive."""
        choice = self.random.random()
        if depth == 0 or choice < 0.2:
            return self.random.choice(names) if names and self.chance(0.8) else self.number()
        inner = lambda: self.expression(names, depth - 1)
        if choice < 0.4:
            return f"({inner()} + {inner()})"
        if choice < 0.5:
            return f"({inner()} - {inner()})"
        if choice < 0.75:
            return f"{inner()}*{inner()}"
        if choice < 0.82:
            exponent = self.random.choice([2, 2, 3, 20]) if self.extreme or self.chance(0.1) else 2
            return f"({inner()})^{exponent}"
        if choice < 0.92 and self.rational:
            return f"{inner()}/(1 + {self.positive(names, depth - 1)})"
        if self.functions:
            name = self.random.choice(["exp", "log", "sqrt", "sin", "cos", "exp", "sqrt", "atan"])
            if name in ("log", "sqrt"):
                return f"{name}(1 + {self.positive(names, depth - 1)})"
            if name == "exp":
                return f"exp(-{self.positive(names, 0)})"  # not too small for three hundred digits
            return f"{name}({self.expression(names, min(depth - 1, 1))})"
        return f"({inner()} - 2*{inner()})"

    def positive(self, names, depth):
        name = self.random.choice(names) if names else self.number()
        return self.random.choice(
            [
                name,
                f"{name}^2",
                f"{name}*{self.random.choice(names) if names else 2}",
                f"({self.expression(names, min(depth, 1))})^2" if depth else f"{name}^2",
            ]
        )

    def system(self):
        """A system in itself: rates, outputs, inputs."""
        states = [f"x{i}" for i in range(self.random.choice([1, 2, 2, 3, 3, 4, 5]))]
        params = [f"k{i}" for i in range(self.random.choice([0, 1, 1, 2, 3]))]
        names = states + params
        depth = self.random.choice([1, 2, 2, 3])
        near = lambda: self.random.sample(names, min(len(names), self.random.choice([1, 2, 3])))
        rates = {state: self.expression(near(), depth) for state in states}
        outputs = [
            self.expression(near(), self.random.choice([0, 0, 1, 2])) for _ in range(self.random.choice([1, 1, 1, 2]))
        ]
        inputs = []
        for _ in range(self.random.choice([0, 0, 1, 1, 2])):
            moved = self.random.sample(states, self.random.randint(1, len(states)))
            inputs.append({state: self.expression(near(), self.random.choice([0, 1, 2])) for state in moved})
        return states, params, rates, outputs, inputs

    def hide(self, states, params, rates, outputs, inputs):
        """The same system in more coordinates, so that a motion is not seen: what is known of the rank is that of the old ones."""
        import re

        chosen = [state for state in states if self.chance(0.6)] or states[:1]
        how = self.random.choice(["scaling", "translation", "translation", "power", "unseen", "lost parameter"])
        extra = "e"

        def put(text, old, new):
            return re.sub(rf"\b{old}\b", new, text)

        if how == "unseen":
            moving = self.expression(states + [extra], 1)
            return states + [extra], params, rates | {extra: moving}, outputs, inputs
        if how == "lost parameter":
            return states, params + [extra], rates, outputs, inputs
        new = {"scaling": "({0}*e)", "translation": "({0} - e)", "power": "({0}*e^2)"}[how]
        moving = self.expression([*chosen, extra], 1) if how == "translation" else "0"

        def through(text):
            for state in chosen:
                text = put(text, state, new.format(state))
            return text

        def back(state, text, own):
            text = through(text)
            if state not in chosen:
                return text
            return f"{text} + ({own})" if how == "translation" else f"({text})/e" if how == "scaling" else f"({text})/e^2"

        rates = {state: back(state, rate, moving) for state, rate in rates.items()}
        inputs = [{state: back(state, rate, "0") for state, rate in field.items()} for field in inputs]
        outputs = [through(output) for output in outputs]
        if how == "translation" and moving != "0":
            return states + [extra], params, rates | {extra: moving}, outputs, inputs
        return states, params + [extra], rates, outputs, inputs


def random_system(seed):
    maker = Maker(seed)
    parts = maker.system()
    if maker.chance(0.45):
        parts = maker.hide(*parts)
    states, params, rates, outputs, inputs = parts
    if maker.chance(0.1):
        outputs = outputs + [outputs[0]]
    order = states[:]
    maker.random.shuffle(order)
    title = f"random system {seed}"
    return proof(title, order, rates, outputs, params, inputs)


def declared_system(seed):
    """A system whose constants, signals, values at the beginning and experiments are declared: what the language has words for."""
    maker = Maker(seed)
    maker.functions = maker.functions and maker.chance(0.3)
    states, params, _, _, _ = maker.system()
    params = params or ["k0"]
    known = ["u"] if maker.chance(0.7) else []
    unknown = ["w"] if maker.chance(0.4) else []
    names = states + params + known + unknown + (["u'"] if known and maker.chance(0.3) else [])
    near = lambda: maker.random.sample(names, min(len(names), maker.random.choice([2, 3, 4])))
    lines = [f'system "declared system {seed}"']
    experiments = maker.random.choice([1, 1, 1, 2, 2, 3])
    if experiments > 1:
        lines.append(f"experiments {experiments}")
    lines.append("state " + ", ".join(states))
    hint = lambda: " = 3/2" if maker.chance(0.2) else ""
    fixed = maker.chance(0.3)
    lines.append("param " + ", ".join(f"{param}{hint()} unknown" for param in params) + (", c = 3/2 known" if fixed else ""))
    names += ["c"] if fixed else []
    if known:
        lines.append("known u(t)")
    order = maker.random.choice([0, 1, 1, 2])
    if unknown:
        lines.append(f"unknown w(t) order {order}")
    begins = [state for state in states if maker.chance(0.25)]
    for state in begins:
        lines.append(
            f"initial {state} known"
            if maker.chance(0.5)
            else f"initial {state} = {maker.random.choice(['0', '1', '3/2', '0'])}"
        )
    valued = {line.split()[1] for line in lines if line.startswith("initial") and "=" in line}
    depth = maker.random.choice([1, 2, 2])
    lines += ["", "drift f", *(f"  {state}' = {maker.expression(near(), depth)}" for state in states), ""]
    if maker.chance(0.2):
        lines += [
            "input g",
            f"  {states[0]}' = {maker.expression(near(), 1)}",
            *(["  others' = 0"] if len(states) > 1 or unknown else []),
            "",
        ]
    lines.append(
        "output "
        + ", ".join(maker.expression(near(), maker.random.choice([0, 0, 1])) for _ in range(maker.random.choice([1, 1, 2])))
    )
    lines.append("sample")
    drawn = [name for name in states if name not in valued] + params + known + unknown
    drawn += ["u'"] if any("u'" in line for line in lines) else []
    drawn += ["w" + "'" * place for place in range(1, order + 1)] if unknown else []
    return "\n".join([*lines, *(f"  {name} in {POSITIVE}" for name in drawn)]) + "\n"


def related_system(seed):
    """Functions that satisfy relations, or nearly do: products of exponentials, logarithms of products, multiples of angles, roots."""
    dice = random.Random(seed)
    names = ["x", "k", "z"][: dice.choice([2, 2, 3])]
    a, b = dice.choice(names), dice.choice(names)
    near = lambda number: number if dice.random() < 0.7 else number + 1  # a relation, or nearly one
    n, m = dice.choice([2, 3]), dice.choice([1, 2])
    arguments = [f"{a} + {b}", f"{a}*{b}", f"{m}*{a} - {b}", f"{a}^2", f"{a}/{b}", f"{a} + 1", f"{b}/2", f"{m}/{n}*{a}"]
    p, q = dice.choice(arguments), dice.choice(arguments)
    relations = [
        f"exp({p})*exp({q}) - exp({p} + {near(1)}*({q}))",
        f"exp({n}*({p})) - exp({p})^{near(n)}",
        f"exp(({p})/{n})^{near(n)}*exp(-({p})) + {dice.choice(names)}*0",
        f"log(({a})^{n}*{b}) - {near(n)}*log({a}) - log({b})",
        f"log({a}*{b}) - log({a})*{near(0)} - log({b})",
        f"sin(2*({p})) - {near(2)}*sin({p})*cos({p})",
        f"cos({p} + {q}) - cos({p})*cos({q}) + sin({p})*sin({q})*{near(1)}",
        f"sin({p})^2 + {near(1)}*cos({p})^2",
        f"sqrt({a})*sqrt({b}) - sqrt({a}*{b}*{near(1)})",
        f"sqrt(({a})^2*{b}) - {near(1)}*({a})*sqrt({b})",
        f"sqrt({a} + {b})^2 - {near(1)}*{a} - {b}",
        f"exp(log({a}) + log({b})) - {near(1)}*{a}*{b}",
        f"exp(log({a})/2) - {near(1)}*sqrt({a})",
        f"exp({n}*log({a})) - ({a})^{near(n)}",
        f"log(exp({p})) - ({p})*{near(1)}",
        f"tan({a}/4)*cos({a}/4) - sin({a}/4)*{near(1)}",
        f"atan({a}) + atan(1/{a})*{near(1)}",
        f"log(sqrt({a})) - log({a})/{near(2)}",
        f"exp({p})/(1 + exp({p})) + 1/({near(1)} + exp({p}))",
    ]
    chosen = dice.sample(relations, dice.choice([1, 1, 2]))
    outputs = [f"{relation} + {dice.choice(names + ['0', '0', '0'])}*{dice.choice(['0', '1'])}" for relation in chosen]
    rates = {
        name: dice.choice(
            [
                "0",
                "1",
                name,
                dice.choice(names),
                f"-{name}*{dice.choice(names)}",
                f"exp(-{dice.choice(names)})",
                f"sqrt({dice.choice(names)})",
                dice.choice(relations),
            ]
        )
        for name in names
    }
    return proof(f"related system {seed}", names, rates, outputs)


EDGES = {
    "one unknown": "state x\ndrift f  x' = x^2\noutput x\nsample x in [1, 2]\n",
    "one unknown, seen by its square": "state x\ndrift f  x' = 0\noutput x^2\nsample x in [1, 2]\n",
    "no dynamics": "state x, y, z\ndrift f  others' = 0\noutput x*y, y*z\nsample x in [1, 2] y in [1, 2] z in [1, 2]\n",
    "no dynamics, rank one": "state x, y\ndrift f  others' = 0\noutput x + y, (x + y)^2\nsample x in [1, 2] y in [1, 2]\n",
    "an output that is constant": "state x, y\ndrift f  x' = y  y' = x\noutput 3\nsample x in [1, 2] y in [1, 2]\n",
    "an output that is zero in disguise": "state x, y\ndrift f  x' = y  y' = x\noutput x*y - y*x\nsample x in [1, 2] y in [1, 2]\n",
    "an output that is constant in disguise": "state x, y\ndrift f  x' = y  y' = x\noutput (x^2 - y^2)/((x - y)*(x + y))\nsample x in [3, 4] y in [1, 2]\n",
    "a state that appears nowhere": "state x, y, z\ndrift f  x' = y  y' = -x  z' = 0\noutput x\nsample x in [1, 2] y in [1, 2] z in [1, 2]\n",
    "a state that cancels": "state x, y, z\ndrift f  x' = y + z - z  y' = -x  z' = x\noutput x + 0*z\nsample x in [1, 2] y in [1, 2] z in [1, 2]\n",
    "two equal outputs": "state x, y\ndrift f  x' = y  y' = 0\noutput x, x\nsample x in [1, 2] y in [1, 2]\n",
    "huge constants": "state x, y\ndrift f  x' = 10^30*y  y' = -x/10^30\noutput 123456789123456789*x\nsample x in [1, 2] y in [1, 2]\n",
    "constants that vanish modulo small primes": "state x, y\ndrift f  x' = 2147483647*y  y' = 134217487*x\noutput 2305843009213693951*x\nsample x in [1, 2] y in [1, 2]\n",
    "2^61 - 1 in a denominator": "state x, y\ndrift f  x' = y/2305843009213693951  y' = x/4611686018427387847\noutput x/134217487\nsample x in [1, 2] y in [1, 2]\n",
    "degree 20": "state x, y\ndrift f  x' = y^20  y' = x^20 - y\noutput x^20\nsample x in [1, 2] y in [1, 2]\n",
    "degree 200": "state x, y\ndrift f  x' = y^200  y' = x\noutput x^200\nsample x in [1, 2] y in [1, 2]\n",
    "pole within": "state x, y\ndrift f  x' = y/(x - 1)  y' = 1/y\noutput 1/(x - y)\nsample x in [0, 2] y in [0, 2]\n",
    "a denominator that is a square less its expansion plus one": "state x, y\ndrift f  x' = y  y' = 1/((x + y)^2 - x^2 - 2*x*y - y^2 + 1)\noutput x\nsample x in [1, 2] y in [1, 2]\n",
    "deep nesting": "state x, y\ndrift f  x' = "
    + "1/(1 + " * 25
    + "y"
    + ")" * 25
    + "  y' = x\noutput x\nsample x in [1, 2] y in [1, 2]\n",
    "deep polynomial nesting": "state x, y\ndrift f  x' = "
    + "(1 + y*" * 25
    + "x"
    + ")" * 25
    + "  y' = x\noutput y\nsample x in [1, 2] y in [1, 2]\n",
    "x^5 z": "state x, z\ndrift f  x' = 1  z' = 0\noutput x^5*z\nsample x in [1, 2] z in [1, 2]\n",
    "x^5 z about zero": "state x, z\ndrift f  x' = 1  z' = 0\noutput x^5*z\nsample x in [-1, 1] z in [-1, 1]\n",
    "hidden exponential identity": "state x, k\ndrift f  x' = 1  k' = 0\noutput exp(x)*exp(k) - exp(x + k)\nsample x in [0, 1] k in [0, 1]\n",
    "a row that is hidden, and one behind it": "state x, k, z\ndrift f  x' = z  others' = 0\noutput exp(x)*exp(k) - exp(x + k) + x\nsample x in [0, 1] k in [0, 1] z in [1, 2]\n",
    "double angle": "state x, k\ndrift f  x' = k  k' = 0\noutput sin(2*x) - 2*sin(x)*cos(x)\nsample x in [0, 1] k in [0, 1]\n",
    "double angle, and what it hides": "state x, k\ndrift f  x' = k  k' = 0\noutput sin(2*x) - 2*sin(x)*cos(x) + k\nsample x in [0, 1] k in [0, 1]\n",
    "logarithm of a product": "state x, k\ndrift f  x' = x  k' = 0\noutput log(x*k) - log(x) - log(k)\nsample x in [1, 2] k in [1, 2]\n",
    "logarithm of a product, seen": "state x, k\ndrift f  x' = x  k' = 0\noutput log(x*k), log(x) + log(k)\nsample x in [1, 2] k in [1, 2]\n",
    "root of a square, right": "state x, y\ndrift f  others' = 0\noutput x + sqrt(x^2)\nsample x in [1, 2] y in [1, 2]\n",
    "root of a square, left": "state x, y\ndrift f  others' = 0\noutput x + sqrt(x^2)\nsample x in [-2, -1] y in [1, 2]\n",
    "exponential of a logarithm": "state x, k\ndrift f  x' = k*x  k' = 0\noutput exp(log(x)) - x\nsample x in [1, 2] k in [1, 2]\n",
    "exponential of half": "state x, k\ndrift f  x' = k*x  k' = 0\noutput exp(x/2)^2 - exp(x)\nsample x in [1, 2] k in [1, 2]\n",
    "roots of one product": "state x, y\ndrift f  x' = y  y' = x\noutput sqrt(x)*sqrt(y) - sqrt(x*y)\nsample x in [1, 2] y in [1, 2]\n",
    "scale in an exponent": "state x, a, b\ndrift f  x' = -a*b*x  others' = 0\noutput exp(x)\nsample x in [1, 2] a in [1, 2] b in [1, 2]\n",
    "Arrhenius": "state x, A, E, T\ndrift f  x' = -A*exp(-E/T)*x  T' = x - T  others' = 0\noutput T\nsample x in [1, 2] A in [1, 2] E in [1, 2] T in [1, 2]\n",
    "Arrhenius at one temperature": "state x, A, E\nparam T = 2\ndrift f  x' = -A*exp(-E/T)*x  others' = 0\noutput x\nsample x in [1, 2] A in [1, 2] E in [1, 2]\n",
    "unicycle by one beacon": "state x, y, theta\ninput v  x' = cos(theta)  y' = sin(theta)  theta' = 0\ninput w  theta' = 1  others' = 0\noutput x^2 + y^2\nsample x in [1, 2] y in [1, 2] theta in [0, 1]\n",
    "inputs only, commuting": "state x, y\ninput a  x' = 1  y' = 0\ninput b  x' = 0  y' = 1\noutput x\nsample x in [1, 2] y in [1, 2]\n",
    "an input that does nothing": "state x, y\ndrift f  x' = y  y' = 0\ninput g  others' = 0\noutput x\nsample x in [1, 2] y in [1, 2]\n",
    "only an input tells": "state x, y\ndrift f  x' = -x  y' = 0\ninput g  x' = y  y' = 0\noutput x\nsample x in [1, 2] y in [1, 2]\n",
    "a bilinear input": "state x, y, z\ndrift f  x' = 0  y' = 0  z' = 0\ninput g  x' = y*z  y' = -x*z  z' = 0\noutput x\nsample x in [1, 2] y in [1, 2] z in [1, 2]\n",
    "sixteen outputs": "state x, y\ndrift f  x' = y  y' = x\noutput "
    + ", ".join(f"(x + y)^{n}" for n in range(1, 17))
    + "\nsample x in [1, 2] y in [1, 2]\n",
    "a constant that is a parameter without a value": "state x, y\nparam a\ndrift f  x' = a*y  y' = 0\noutput x\nsample x in [1, 2] y in [1, 2] a in [1, 2]\n",
    "a parameter whose value is zero": "state x, y\nparam a = 0\ndrift f  x' = a*y  y' = 0\noutput x\nsample x in [1, 2] y in [1, 2]\n",
    "a parameter whose value hides": "state x, y\nparam a = 1\ndrift f  x' = (a - 1)*y  y' = 0\noutput x\nsample x in [1, 2] y in [1, 2]\n",
    "pi": "state x, y\ndrift f  x' = pi*y  y' = sin(pi)*x\noutput x\nsample x in [1, 2] y in [1, 2]\n",
    "a root of two": "state x, y\ndrift f  x' = (sqrt(2)^2 - 2)*y  y' = x\noutput x\nsample x in [1, 2] y in [1, 2]\n",
    "a constant identity": "state x, y\ndrift f  x' = (sqrt(2)*sqrt(3) - sqrt(6))*y  y' = x\noutput x\nsample x in [1, 2] y in [1, 2]\n",
    "logarithms of numbers": "state x, y\ndrift f  x' = (log(8) - 3*log(2))*y  y' = x\noutput x\nsample x in [1, 2] y in [1, 2]\n",
}


def edge_systems():
    return {name: f'system "{name}"\n' + text for name, text in EDGES.items()}


if __name__ == "__main__":
    kinds = {"--declared": declared_system, "--related": related_system}
    print(kinds.get(sys.argv[-1], random_system)(int(sys.argv[1])), end="")
