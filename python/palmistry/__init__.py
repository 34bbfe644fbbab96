"""Observability, identifiability and published equations of nonlinear control systems: the answers of the program `palmistry`, to the last bit, in Python.

    import palmistry
    system = palmistry.System.read("pendulum.proof")
    system.prove()                                  # every claim with its verdict
    system.rank(samples=100_000)                    # what is observable, certified state by state
    system.eval("L(f, f, phi)", at={"phi": "1/3", "omega": 2}, digits=40)
    system.verdicts(states)                         # numpy in, numpy out
    system.certify(boxes=1000)                      # full rank on whole boxes
    system.observability(), system.identifiability(globally=True)   # tables
    palmistry.observe("scene.toml")                 # observers, on simulated or recorded measurements
    palmistry.observe(system, frame, noise=0.01)    # the same of a system at hand and a DataFrame
    palmistry.System.from_function(f, h, states="phi, omega")       # of Python functions; also of SymPy's and CasADi's expressions
    palmistry.import_model("model.xml")             # a model of another program
    palmistry.import_problem("problem.yaml", "fit.toml")            # a problem in the format PEtab, for observe

`palmistry.recheck` (a second checker) and `palmistry.cluster` (sweeps over many machines) need nothing of this, and work from the source
tree too, where nothing is compiled.
"""

_HOMES = {
    "Accessibility": "answers",
    "Certificate": "answers",
    "Claim": "answers",
    "Claims": "answers",
    "Designs": "answers",
    "Error": "errors",
    "EvaluationError": "errors",
    "Map": "answers",
    "Motions": "answers",
    "Observation": "answers",
    "Page": "answers",
    "Poses": "answers",
    "Printed": "program",
    "Rank": "answers",
    "ReadError": "errors",
    "Recheck": "answers",
    "SingularSet": "answers",
    "Solutions": "answers",
    "Stress": "answers",
    "System": "system",
    "Table": "tables",
    "Trade": "answers",
    "Value": "answers",
    "Verdicts": "answers",
    "advise": "studies",
    "check": "studies",
    "from_casadi": "translation",
    "from_function": "traced",
    "from_sympy": "translation",
    "import_model": "system",
    "import_problem": "system",
    "latex": "system",
    "observe": "observing",
    "poses": "studies",
    "recheck_file": "system",
    "run": "program",
    "stream": "observing",
    "sweep": "cluster",
    "threads": "system",
    "verify": "system",
}

__all__ = sorted(_HOMES)


def __getattr__(name):
    """Loads what is asked for: the compiled half only where it is needed."""
    home = _HOMES.get(name)
    if home is None:
        raise AttributeError(f"module 'palmistry' has no attribute '{name}'")
    import importlib

    found = getattr(importlib.import_module(f"palmistry.{home}"), name)
    globals()[name] = found
    return found


def __dir__():
    return sorted([*globals(), *__all__])
