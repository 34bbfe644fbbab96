"""How many values give the same outputs, on random small systems: solutions.py BINARY [COUNT] [SEED]

The other way shares nothing with ours: Lie derivatives written out by SymPy, one more than there are unknowns, their values at a random
point modulo a prime, the reduced Groebner basis of the differences (with the denominators inverted) in lexicographic order for each unknown, and the
degree of the squarefree part of its last polynomial. Unknowns that are not locally seen are told by ranks of Jacobians, and held. Exit status 1 where
anything differs.
"""

import json
import random
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

import sympy as sp
from sympy.polys.domains import GF

PRIME = 2**31 - 1


def random_term(rng, names, degree):
    factors = [rng.choice(names) for _ in range(rng.randint(1, degree))]
    return rng.choice([1, 1, -1, 2]) * sp.Mul(*factors)


def random_system(rng):
    states = sp.symbols(f"x1:{rng.randint(1, 3) + 1}")
    constants = sp.symbols(f"k1:{rng.randint(1, 3) + 1}")
    names = list(states) + list(constants)
    rates = []
    for _ in states:
        rate = sum(random_term(rng, names, 3) for _ in range(rng.randint(1, 3)))
        if rng.random() < 0.2:
            rate = rate / (rng.choice(names) + rng.choice(states))
        rates.append(rate)
    output = rng.choice([states[0], random_term(rng, names, 2), states[0] ** 2, states[0] + rng.choice(names)])
    return states, constants, rates, output


def text_of(system):
    states, constants, rates, output = system
    power = lambda e: str(e).replace("**", "^")
    lines = [f'system "s" state {", ".join(map(str, states))} param {", ".join(map(str, constants))} unknown', "drift f"]
    lines += [f"  {state}' = {power(rate)}" for state, rate in zip(states, rates)]
    return "\n".join(lines + [f"output {power(output)}", ""])


def modulo(expression, point):
    top, bottom = sp.fraction(sp.together(expression.subs(point)))
    return int(top) * pow(int(bottom), -1, PRIME) % PRIME


def rank(rows, columns):
    if not rows or not columns:
        return 0
    matrix = sp.polys.matrices.DomainMatrix([[GF(PRIME)(row[c]) for c in columns] for row in rows], (len(rows), len(columns)), GF(PRIME))
    return matrix.rank()


def at_random(system, rng):
    """The unknowns, one Lie derivative more than there are unknowns, a random point, and the gradients there."""
    states, constants, rates, output = system
    names = list(states) + list(constants)
    words = [output]
    for _ in names:
        words.append(sp.together(sum(sp.diff(words[-1], s) * r for s, r in zip(states, rates))))
    point = {name: rng.randint(1, PRIME - 1) for name in names}
    return names, words, point, [[modulo(sp.diff(word, name), point) for name in names] for word in words]


def kept_and_held(names, rows):
    """The places of unknowns that the others are functions of the outputs with, and the others, which are held."""
    kept = []
    for k in range(len(names)):
        if rank(rows, kept + [k]) > len(kept):
            kept.append(k)
    return kept, [names[k] for k in range(len(names)) if k not in kept]


def theirs(system, rng):
    rates = system[2]
    names, words, point, rows = at_random(system, rng)
    full = rank(rows, range(len(names)))
    seen = [rank(rows, [c for c in range(len(names)) if c != k]) < full for k in range(len(names))]
    kept, held = kept_and_held(names, rows)
    free = [names[k] for k in kept]
    inverse = sp.Symbol("inverse")
    equations, bottoms = [], {sp.Integer(1)}
    for word in words + rates:
        bottoms.update(factor for factor, _ in sp.factor_list(sp.fraction(sp.together(word))[1])[1])
    for word in words:
        top, bottom = sp.fraction(word)
        equations.append(sp.expand((top - modulo(word, point) * bottom).subs({h: point[h] for h in held})))
    equations.append(sp.expand(inverse * sp.Mul(*bottoms).subs({h: point[h] for h in held}) - 1))
    equations = [e for e in equations if e != 0]
    found = {}
    for k, name in enumerate(names):
        if not seen[k]:
            found[str(name)] = "infinity"
            continue
        order = [inverse] + [other for other in free if other != name] + [name]
        basis = sp.groebner(equations, *order, modulus=PRIME, order="grevlex").fglm("lex")
        last = sp.Poly(basis.exprs[-1], name, modulus=PRIME)
        found[str(name)] = sum(factor.degree() for factor, _ in last.sqf_list()[1])
    return found


def ours(binary, text):
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "s.proof"
        file.write_text(text)
        run = subprocess.run([binary, "rank", str(file), "--global", "--json"], capture_output=True, text=True)
        if not run.stdout:
            return None
        answer = json.loads(run.stdout)
    if "unknowns" not in answer:
        return None
    return {of_it["name"]: of_it["values"] for of_it in answer["unknowns"]}


class TooSlow(Exception):
    """A basis that SymPy does not find in a few seconds."""


def give_up(*_):
    raise TooSlow


def main(binary, count=200, seed=1):
    rng = random.Random(int(seed))
    signal.signal(signal.SIGALRM, give_up)
    compared, left, wrong, several = 0, 0, 0, 0
    while compared < int(count):
        system = random_system(rng)
        text = text_of(system)
        answer = ours(binary, text)
        if answer is None or None in answer.values():
            left += 1
            continue
        signal.alarm(10)
        try:
            other = theirs(system, rng)
        except (TooSlow, ValueError, ZeroDivisionError, NotImplementedError):
            left += 1
            continue
        finally:
            signal.alarm(0)
        compared += 1
        several += any(value not in (1, "infinity") for value in other.values())
        if other != answer:
            wrong += 1
            print(f"{text}ours {answer}\ntheirs {other}\n", flush=True)
    print(f"{compared} systems compared, {several} of them with a finite number above one, {left} left out, {wrong} differ")
    return wrong > 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
