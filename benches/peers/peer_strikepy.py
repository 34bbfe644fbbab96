"""A proof file handed to StrikePy, in a process of its own: `peer_strikepy.py FILE` prints the rank that it finds and how
long it took.

StrikePy (D. Rey Rostro and A. F. Villaverde, Bioinformatics 2023; on PyPI) derives outputs symbolically and takes the rank
of the observability-identifiability matrix, all input derivatives being symbols. Models are modules there; this one is made
from the file.
"""

import contextlib
import importlib
import io
import json
import math
import re
import sys
import time
import types

import sympy

from proof_file import ProofFile


def symbolic(model):
    """All nodes as expressions."""
    values = []
    for name, *operands in model.nodes:
        inner = [values[operand] for operand in operands] if name not in ("number", "constant", "state") else operands
        if name == "number":
            values.append(sympy.Rational(inner[0].numerator, inner[0].denominator))
        elif name == "constant":
            values.append(sympy.pi if inner[0] == "pi" else sympy.Symbol(inner[0]))
        elif name == "state":
            values.append(sympy.Symbol(model.states[inner[0]]))
        else:
            apply = {
                "+": lambda a, b: a + b,
                "-": lambda a, b: a - b,
                "*": lambda a, b: a * b,
                "/": lambda a, b: a / b,
                "^": lambda a, b: a**b,
            }.get(name) or getattr(sympy, name)
            values.append(apply(*inner))
    return values


def module(text):
    """The file as StrikePy has its models: states x, constants p, inputs u, rates f, outputs h."""
    model = ProofFile(text)
    values = symbolic(model)
    moving = [
        state
        for state in model.states
        if any(values[rates.get(state, 0)] != 0 for _, rates in model.fields if state in rates)
    ]
    moving = moving or model.states[:1]
    inputs = [sympy.Symbol(f"input_{index}") for index, (role, _) in enumerate(model.fields) if role == "input"]
    rates, known = dict.fromkeys(moving, sympy.Integer(0)), iter(inputs)
    for role, field in model.fields:
        factor = next(known) if role == "input" else 1
        for state, rate in field.items():
            if state in rates:
                rates[state] += factor * values[rate]
    made = types.ModuleType("StrikePy.models.made")
    made.x = [[sympy.Symbol(state)] for state in moving]
    made.p = [[sympy.Symbol(state)] for state in model.states if state not in moving]
    made.u = inputs if len(inputs) == 1 else [[symbol] for symbol in inputs]
    made.w = []
    made.f = [[rates[state]] for state in moving]
    made.h = [[values[output]] for output in model.outputs]
    if len(moving) == 1:  # it wants these flat
        made.x, made.f, made.h = [made.x[0][0]], [made.f[0][0]], [output[0] for output in made.h]
    made.variables_locales = {}
    return made


def main(path):
    made = module(open(path, encoding="utf-8").read())
    options = types.ModuleType("StrikePy.options")
    options.modelname, options.checkObser, options.maxLietime = "made", 1, math.inf
    options.nnzDerU, options.nnzDerW, options.prev_ident_pars = [math.inf] * max(1, len(made.u)), [math.inf], []
    package = importlib.import_module("StrikePy")
    sys.modules |= {"StrikePy.options": options, "StrikePy.models.made": made}
    package.options = options
    analysis, out = importlib.import_module("StrikePy.strike_goldd"), io.StringIO()
    importlib.import_module("symbtools")
    began = time.process_time()
    with contextlib.redirect_stdout(out):
        analysis.strike_goldd()
    ranks = re.findall(r"Rank = (\d+)", out.getvalue())
    print(json.dumps({"rank": int(ranks[-1]) if ranks else None, "seconds": time.process_time() - began}))


if __name__ == "__main__":
    main(sys.argv[1])
