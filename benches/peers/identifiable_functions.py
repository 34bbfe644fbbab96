"""Generators of all identifiable functions, on random small systems and compartments: identifiable_functions.py BINARY [COUNT] [SEED]

The other way shares nothing with ours: Lie derivatives written out by SymPy, one more than there are unknowns, their values at a random point modulo a prime, and a
Groebner basis of the differences by SymPy, with the unknowns that are not locally determined held at other random values. Every function that the program
prints has to have the point's value modulo that basis; and where the program says that its functions generate all, the functions and the Lie derivatives have to have as many points in common with the point, by
the standard monomials of two bases. Half of the systems are linear compartments with one output. Exit status 1 where anything differs.
"""

import json
import random
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

import sympy as sp
from solutions import PRIME, TooSlow, at_random, give_up, kept_and_held, modulo, random_system, text_of


def random_compartments(rng):
    """Two or three compartments that exchange and lose what they hold, the first one measured."""
    size = rng.randint(2, 3)
    states = sp.symbols(f"x1:{size + 1}")
    rates, constants = [sp.Integer(0)] * size, []
    for here in range(size):
        for there in range(size + 1):
            if there == here or rng.random() < 0.4:
                continue
            constants.append(sp.Symbol(f"k{here + 1}{there + 1}"))
            rates[here] -= constants[-1] * states[here]
            if there < size:
                rates[there] += constants[-1] * states[here]
    return states, tuple(constants), rates, states[0]


def numerator(expression):
    """What is to vanish, with integer coefficients."""
    return sp.expand(sp.fraction(sp.together(sp.expand(expression)))[0])


def vanishes(expression, variables):
    """Whether it does modulo the prime."""
    return sp.Poly(numerator(expression), *variables, modulus=PRIME).is_zero


def standard(basis, variables):
    """How many standard monomials a basis has; none where they are not finitely many or more than a hundred."""
    leads = [sp.Poly(e, *variables, modulus=PRIME).monoms(order="grevlex")[0] for e in basis.exprs]
    if not all(any(lead[k] and not any(lead[j] for j in range(len(variables)) if j != k) for lead in leads) for k in range(len(variables))):
        return None
    found, waiting = set(), [(0,) * len(variables)]
    while waiting and len(found) <= 100:
        monomial = waiting.pop()
        if monomial in found or any(all(a <= b for a, b in zip(lead, monomial)) for lead in leads):
            continue
        found.add(monomial)
        waiting += [tuple(m + (j == k) for j, m in enumerate(monomial)) for k in range(len(variables))]
    return len(found) if len(found) <= 100 else None


def fibre(functions, point, held, free):
    """The basis of where functions have the values of a point, with some unknowns held; and what it is in."""
    bottoms, equations = {sp.Integer(1)}, []
    for function in functions:
        top, bottom = sp.fraction(sp.together(function))
        bottoms.update(factor for factor, _ in sp.factor_list(bottom)[1])
        equations.append(numerator((top - modulo(function, point) * bottom).subs(held)))
    variables = list(free)
    product = sp.Mul(*bottoms).subs(held)
    if product.free_symbols:
        inverse = sp.Symbol("inverse")
        variables.insert(0, inverse)
        equations.append(numerator(inverse * product - 1))
    equations = [e for e in equations if not vanishes(e, variables)]
    return sp.groebner(equations, *variables, modulus=PRIME, order="grevlex"), variables


def check(system, functions, generate_all, rng):
    """What differs, in words, or nothing."""
    names, words, point, rows = at_random(system, rng)
    words = [word for word in words if word.free_symbols]
    kept, held = kept_and_held(names, rows)
    free = [names[k] for k in kept]
    elsewhere = {name: rng.randint(1, PRIME - 1) for name in held}
    basis, variables = fibre(words, point, elsewhere, free)
    for function in functions:
        top, bottom = sp.fraction(sp.together(function))
        difference = numerator((top - modulo(function, point) * bottom).subs(elsewhere))
        rest = basis.reduce(difference)[1] if difference.free_symbols else difference
        if not vanishes(rest, variables):
            return f"{function} has another value on the fibre"
    if generate_all and free:
        here = {name: point[name] for name in held}
        of_words, of_functions = (standard(*fibre(list_, point, here, free)) for list_ in (words, functions))
        if of_words is not None and of_words != of_functions:
            return f"the outputs leave {of_words} points and the functions {of_functions}"
    return None


def ours(binary, text):
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "s.proof"
        file.write_text(text)
        run = subprocess.run([binary, "rank", str(file), "--functions", "--json"], capture_output=True, text=True)
        return json.loads(run.stdout).get("identifiable_functions") if run.stdout else None


def main(binary, count=200, seed=1):
    rng = random.Random(int(seed))
    signal.signal(signal.SIGALRM, give_up)
    compared, complete, left, wrong = 0, 0, 0, 0
    while compared < int(count):
        system = random_system(rng) if compared % 2 else random_compartments(rng)
        if not system[1]:
            continue
        text = text_of(system)
        answer = ours(binary, text)
        if answer is None or not answer["functions"]:
            left += 1
            continue
        symbols = {str(name): name for name in system[0] + system[1]}
        functions = [sp.sympify(of_it["function"].replace("^", "**"), locals=symbols) for of_it in answer["functions"]]
        signal.alarm(10)
        try:
            differs = check(system, functions, answer["generate_all"], rng)
        except (TooSlow, ValueError, ZeroDivisionError, NotImplementedError):
            left += 1
            continue
        finally:
            signal.alarm(0)
        compared += 1
        complete += answer["generate_all"]
        if differs:
            wrong += 1
            print(f"{text}{functions}\n{differs}\n", flush=True)
    print(f"{compared} systems compared, {complete} of them with generators of all, {left} left out, {wrong} differ")
    return wrong > 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
