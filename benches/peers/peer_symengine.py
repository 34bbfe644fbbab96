"""symengine: symbolic derivatives, common subexpressions merged, compiled in memory by its LLVM back end, which the wheels
on PyPI have. Without it symengine interprets, some fifty times slower; it is left out then."""

import numpy as np
import symengine

from model import symbolic_rows
from verdict import finish


def prepare(job, states, _variant):
    if not symengine.have_llvm:
        raise RuntimeError("this build of symengine has no LLVM back end")
    x = symengine.symbols(job.model.states)
    rows = symbolic_rows(job, x, symengine, lambda value, state: value.diff(state))
    nonzero = [(i, j) for i, row in enumerate(rows) for j, entry in enumerate(row) if entry != 0]
    entries = [rows[i][j] for i, j in nonzero]
    call = symengine.Lambdify(x, entries, backend="llvm", cse=True)
    results = np.empty((len(states), len(entries)))

    def evaluate():
        return call(states, out=results)

    return finish(job, states, nonzero, evaluate)
