"""Families of systems that grow, as proof files: what stops whom, and where. `families.py NAME SIZE` prints one."""

import sys


def proof(title, states, rates, outputs, params=(), inputs=(), cite="", ranges=None):
    """One proof file. `rates` by state, `inputs` a list of rates by state; parameters are states at rest."""
    lines = [f'system "{title}"' + (f'  cite "{cite}"' if cite else ""), ""]
    lines += ["state " + ", ".join([*states, *params]), "", "drift f"]
    lines += [f"  {state}' = {rates[state]}" for state in states if rates.get(state, "0") != "0"]
    if len(rates) < len(states) or params or any(rates[state] == "0" for state in states):
        lines.append("  others' = 0")
    for index, field in enumerate(inputs):
        lines += ["", f"input g{index + 1}", *(f"  {state}' = {rate}" for state, rate in field.items())]
        if len(field) < len(states) + len(params):
            lines.append("  others' = 0")
    lines += ["", "output " + ", ".join(outputs), "", "sample"]
    lines += [f"  {name} in " + (ranges or {}).get(name, "[1/2, 2]") for name in [*states, *params]]
    return "\n".join(lines) + "\n"


def ring(size):
    """Oscillators in a ring with unknown stiffnesses, known springs between them; one is seen. 3 unknowns each."""
    states = [name for i in range(size) for name in (f"x{i}", f"v{i}")]
    rates = {}
    for i in range(size):
        rates[f"x{i}"] = f"v{i}"
        rates[f"v{i}"] = f"-w{i}*x{i} + (x{(i + 1) % size} - 2*x{i} + x{(i - 1) % size})"
    return proof(f"A ring of {size} oscillators, one seen", states, rates, ["x0"], [f"w{i}" for i in range(size)])


def chain(size):
    """Compartments, each emptied into the next at an unknown rate; the first filled, the last seen. 2 unknowns each."""
    rates = {"x0": "-k0*x0"} | {f"x{i}": f"k{i - 1}*x{i - 1} - k{i}*x{i}" for i in range(1, size)}
    return proof(
        f"A chain of {size} compartments, the first filled, the last seen",
        list(rates),
        rates,
        [f"x{size - 1}"],
        [f"k{i}" for i in range(size)],
        [{"x0": "1"}],
    )


def loss_chain(size):
    """The same with flow both ways and the first compartment seen: all rates are identifiable."""
    rates = {}
    for i in range(size):
        terms = (
            [f"-k{i}*x{i}"]
            + ([f"k{i - 1}*x{i - 1}", f"-b{i - 1}*x{i}"] if i else [])
            + ([f"b{i}*x{i + 1}"] if i + 1 < size else [])
        )
        rates[f"x{i}"] = " + ".join(terms).replace("+ -", "- ")
    params = [f"k{i}" for i in range(size)] + [f"b{i}" for i in range(size - 1)]
    return proof(
        f"A chain of {size} compartments with flow both ways, the first filled and seen",
        list(rates),
        rates,
        ["x0"],
        params,
        [{"x0": "1"}],
    )


def two_inputs(size):
    """Two inputs that move every state, one output: words are 3^order."""
    states = [f"x{i}" for i in range(size)]
    rates = {f"x{i}": f"x{(i + 1) % size}*x{(i + 2) % size} - x{i}" for i in range(size)}
    inputs = [{f"x{i}": f"x{(i + 1) % size}" for i in range(size)}, {f"x{i}": f"{i + 1}*x{i}" for i in range(size)}]
    return proof(f"{size} states, two inputs on each, one seen", states, rates, ["x0"], (), inputs)


def lotka_volterra(size):
    """Species that are all seen, with every growth rate and interaction unknown: n + n + n^2 unknowns."""
    states = [f"x{i}" for i in range(size)]
    rates = {f"x{i}": f"x{i}*(r{i} + " + " + ".join(f"a{i}_{j}*x{j}" for j in range(size)) + ")" for i in range(size)}
    params = [f"r{i}" for i in range(size)] + [f"a{i}_{j}" for i in range(size) for j in range(size)]
    return proof(f"Lotka-Volterra with {size} species, all seen", states, rates, states, params)


def lotka_volterra_one(size):
    """The same with one species seen: every other species has a scale that is not."""
    return (
        lotka_volterra(size)
        .replace("output " + ", ".join(f"x{i}" for i in range(size)), "output x0")
        .replace("all seen", "one seen")
    )


def masses(size):
    """Masses on a line between springs, all unknown, pushed and seen at one end: the push gives the scale. 4 unknowns each."""
    rates, states = {}, []
    for i in range(size):
        states += [f"x{i}", f"v{i}"]
        rates[f"x{i}"] = f"v{i}"
        right = f" + k{i + 1}*(x{i + 1} - x{i})" if i + 1 < size else ""
        left = f"-k{i}*(x{i} - x{i - 1})" if i else "-k0*x0"
        rates[f"v{i}"] = f"({left}{right})/m{i}"
    params = [f"k{i}" for i in range(size)] + [f"m{i}" for i in range(size)]
    return proof(
        f"{size} masses between springs, pushed and seen at one end", states, rates, ["x0"], params, [{"v0": "1/m0"}]
    )


def goodwin(size):
    """A feedback loop of a gene and its products with saturation (Goodwin 1965), the first seen: scales are not. 3 unknowns each."""
    states = [f"x{i}" for i in range(size)]
    rates = {"x0": f"a0/(c + x{size - 1}^2) - b0*x0"} | {f"x{i}": f"a{i}*x{i - 1} - b{i}*x{i}" for i in range(1, size)}
    params = [f"a{i}" for i in range(size)] + [f"b{i}" for i in range(size)] + ["c"]
    return proof(
        f"A feedback loop of {size} products, the first seen",
        states,
        rates,
        ["x0"],
        params,
        cite="after Goodwin, Adv. Enzyme Regul. 3 (1965)",
    )


# the family, and how its size follows from a number of unknowns
FAMILIES = {
    "ring": (ring, lambda unknowns: unknowns // 3),
    "chain": (chain, lambda unknowns: unknowns // 2),
    "loss_chain": (loss_chain, lambda unknowns: (unknowns + 1) // 3),
    "two_inputs": (two_inputs, lambda unknowns: unknowns),
    "lotka_volterra": (lotka_volterra, lambda unknowns: int((1 + unknowns) ** 0.5) - 1),
    "lotka_volterra_one": (lotka_volterra_one, lambda unknowns: int((1 + unknowns) ** 0.5) - 1),
    "masses": (masses, lambda unknowns: unknowns // 4),
    "goodwin": (goodwin, lambda unknowns: (unknowns - 1) // 3),
}


def family(name, unknowns):
    """The member of a family with about so many unknowns, and not more."""
    make, size = FAMILIES[name]
    return make(size(unknowns))


if __name__ == "__main__":
    print(family(sys.argv[1], int(sys.argv[2])), end="")
