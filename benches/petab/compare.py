"""The table of the book's page on several experiments: this program beside pyPESTO with AMICI and fides, on the four problems of examples/petab.

    pip install pypesto amici fides petab cmake        # AMICI builds its models by CMake and a BLAS
    python3 benches/petab/compare.py [--program target/release/palmistry] [--starts 20] [--without-peer]

Processor time, one core each, after models are compiled; log-likelihoods of the best end.
"""

import argparse
import json
import logging
import os
import resource
import subprocess
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PROBLEMS = sorted(path for path in (ROOT / "examples/petab").iterdir() if path.is_dir())


def ours(program, problem, starts):
    """Log-likelihoods at the nominal values and at the best, arrivals, processor time in s."""
    with tempfile.TemporaryDirectory() as folder:
        scene = Path(folder, "problem.toml")
        subprocess.run([program, "import", problem, "--out", scene], check=True, capture_output=True)
        scene.write_text(scene.read_text() + f"\n[search]\nstarts = {starts}\n")
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        run = subprocess.run([program, "observe", scene, "--json"], check=False, capture_output=True, env={**os.environ, "RAYON_NUM_THREADS": "1"})
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        found = json.loads(run.stdout)
        best = found["best"]
        return found["nominal"]["log_likelihood"], best["log_likelihood"], best["arrived"]["from_random_starts"], after.ru_utime - before.ru_utime


def peer(problem, starts):
    """The best log-likelihood of pyPESTO, arrivals, processor time in s."""
    import fides
    import petab.v1 as petab
    import pypesto.optimize as optimize
    from pypesto.engine import SingleCoreEngine
    from pypesto.petab import PetabImporter

    os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")
    logging.disable(logging.CRITICAL)
    task = PetabImporter(petab.Problem.from_yaml(str(problem))).create_problem()
    begin = time.process_time()
    optimizer = optimize.FidesOptimizer(verbose=logging.ERROR)
    ends = optimize.minimize(task, optimizer=optimizer, n_starts=starts, engine=SingleCoreEngine(), progress_bar=False).optimize_result.list
    best = min(end.fval for end in ends)
    return -best, sum(end.fval < best + 0.1 for end in ends), time.process_time() - begin


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=str(ROOT / "target/release/palmistry"))
    parser.add_argument("--starts", type=int, default=20)
    parser.add_argument("--without-peer", action="store_true")
    arguments = parser.parse_args()
    print("| problem | log-likelihood, published values | best | of the starts there | processor time | pyPESTO, AMICI, fides |\n|---|---:|---:|---:|---:|---|")
    for folder in PROBLEMS:
        problem = folder / f"{folder.name}.yaml"
        nominal, best, arrived, seconds = ours(arguments.program, problem, arguments.starts)
        other = "not run"
        if not arguments.without_peer:
            found, there, spent = peer(problem, arguments.starts)
            other = f"{found:.3f}, {there} of {arguments.starts}, {spent:.1f} s"
        print(f"| {folder.name} | {nominal:.3f} | {best:.3f} | {arrived} of {arguments.starts} | {seconds:.1f} s | {other} |", flush=True)


if __name__ == "__main__":
    main()
