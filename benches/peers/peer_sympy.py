"""SymPy: symbolic derivatives. Variants: `numpy`, its `lambdify` with common subexpressions merged, over arrays of all
states; `c`, the same common subexpressions as one C loop over all states, compiled by gcc -O3 -march=native -ffast-math
(so that sines are vectorised as well)."""

import ctypes
import os
import subprocess
import tempfile

import numpy as np
import sympy

from model import symbolic_rows
from verdict import finish


def prepare(job, states, variant):
    x = sympy.symbols(job.model.states)
    rows = symbolic_rows(job, x, sympy, sympy.diff)
    nonzero = [(i, j) for i, row in enumerate(rows) for j, entry in enumerate(row) if entry != 0]
    entries = [rows[i][j] for i, j in nonzero]
    columns = np.ascontiguousarray(states.T)
    results = np.empty((len(entries), len(states)))
    if variant == "numpy":
        call = sympy.lambdify(x, entries, modules="numpy", cse=True)
        return finish(job, states, nonzero, lambda: call(*columns), lambda arrays: np.transpose(arrays))
    call = compiled(x, entries)
    pointers = [array.ctypes.data_as(ctypes.c_void_p) for array in (columns, results)]

    def evaluate():
        call(ctypes.c_long(len(states)), *pointers)
        return results

    return finish(job, states, nonzero, evaluate, np.transpose)


def compiled(x, entries):
    shared, values = sympy.cse(entries)
    body = [f"const double {symbol} = x[{i}*n + k];" for i, symbol in enumerate(x)]
    body += [f"const double {name} = {sympy.ccode(value)};" for name, value in shared]
    body += [f"y[{i}*n + k] = {sympy.ccode(value)};" for i, value in enumerate(values)]
    text = "#include <math.h>\nvoid rows(long n, const double *restrict x, double *restrict y) {\n"
    text += "for (long k = 0; k < n; k++) {\n" + "\n".join(body) + "\n}}\n"
    with tempfile.TemporaryDirectory() as folder:
        source, library = os.path.join(folder, "rows.c"), os.path.join(folder, "rows.so")
        with open(source, "w") as file:
            file.write(text)
        flags = ["-O3", "-march=native", "-ffast-math", "-shared", "-fPIC"]
        subprocess.run(["gcc", *flags, source, "-o", library, "-lmvec", "-lm"], check=True)
        return ctypes.CDLL(library).rows
