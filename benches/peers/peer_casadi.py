"""CasADi: derivatives by its own algorithmic differentiation of SX graphs, common subexpressions merged.

Variants: `vm`, its virtual machine; `c`, the C that it generates, compiled by gcc -O3; `native`, the same with
-march=native. All states in one call (its `map`), through its buffer interface, which copies nothing.
"""

import os
import subprocess
import tempfile

import casadi
import numpy as np

from verdict import finish


def function(job):
    names = job.model.states
    x = casadi.SX.sym("x", len(names))
    parts = casadi.vertsplit(x)
    fields = job.model.fields(parts, casadi)
    rows = []
    for output, word in job.rows:
        value = parts[names.index(output)]
        for field in word:
            rates = casadi.vertcat(*(fields[field].get(name, 0) for name in names))
            value = casadi.cse(casadi.jtimes(value, x, rates))
        rows.append(casadi.gradient(value, x)[list(job.columns)])
    # a row of the matrix is a column here, so that the entries that are stored come row after row
    result = casadi.cse(casadi.sparsify(casadi.horzcat(*rows)))
    columns, rows = result.sparsity().get_triplet()
    return casadi.Function("rows", [x], [result]), list(zip(rows, columns))


def prepare(job, states, variant):
    one, nonzero = function(job)
    many = one.map(len(states))
    if variant != "vm":
        many = compiled(many, ["-march=native"] if variant == "native" else [])
    results = np.empty((len(states), len(nonzero)))
    buffer, trigger = many.buffer()
    buffer.set_arg(0, memoryview(states))
    buffer.set_res(0, memoryview(results))

    def evaluate(_keep=(many, buffer)):
        trigger()
        return results

    return finish(job, states, nonzero, evaluate)


def compiled(many, flags):
    with tempfile.TemporaryDirectory() as folder:
        generator = casadi.CodeGenerator("rows.c")
        generator.add(many)
        source, library = generator.generate(folder + os.sep), os.path.join(folder, "rows.so")
        subprocess.run(["gcc", "-O3", *flags, "-shared", "-fPIC", source, "-o", library, "-lm"], check=True)
        return casadi.external(many.name(), library)
