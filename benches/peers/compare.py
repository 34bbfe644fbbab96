"""Runs all peers and us on the same states, job by job, and prints how long each takes for a state.

Each peer is a process of its own (`worker.py`; ours is `ours.rs`), pinned to one core. After all have prepared, rounds go
from peer to peer, so that what else the machine does falls on all alike. A time is the least over the rounds (and the
median); a ratio is that of the least times. Results are compared with ours, entry by entry, scaled by the largest of the
row. Singular values are compared, scaled by the largest, with those that numpy finds for our entries: the peers' after the
customary scaling of rows to length one; ours, of what the unit rows leave, after the scaling that `palmistry` does. It
says by which factors it multiplied rows and columns; that they are positive and that rows and columns come out of one
length is checked too.
"""

import argparse
import json
import os
import platform
import re
import select
import shutil
import statistics
import subprocess
import sys
import tempfile
from importlib.metadata import version
from pathlib import Path

import numpy as np

from model import JOBS, UNSEEN
from verdict import Assembly

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
TOLERANCE = 1e-9
AVOIDED = 0.05

OURS = "palmistry"
PROVED = "palmistry, rank proved"
PEERS = {
    OURS: "computed",
    PROVED: "certified",
    "CasADi, generated C, gcc -O3": "peer_casadi:c",
    "CasADi, generated C, gcc -O3 -march=native": "peer_casadi:native",
    "SymPy cse, C loop, gcc -O3 -march=native -ffast-math": "peer_sympy:c",
    "symengine, LLVM": "peer_symengine",
    "JAX, jit and vmap": "peer_jax",
    "CasADi, virtual machine": "peer_casadi:vm",
    "SymPy, lambdify, numpy": "peer_sympy:numpy",
}
NEEDS_GCC = [name for name in PEERS if "gcc" in name]

# Squares of lengths after our scaling are as wanted to this part: twice that at which its iteration stops.
EQUAL = 2e-2

WHAT_IS_TIMED = """\
A verdict is the singular values that decide the rank, in one batch. Ours, in both columns: ten rows are handed over; that
six are unit rows is found in the preparation, and they leave with their columns; the 4x4 block that remains is computed,
rows and columns are scaled to one length (to one percent), and one-sided Jacobi rotations find the singular values, eight
or sixteen states at a time, each with the bits that it gets alone. "Rank proved" is what `palmistry rank` does: bounds on
the errors of all entries are carried along, and elimination with them proves the rank. Peers: in the first column they
are told which rows and columns remain and compute these 16 entries; in the second they compute the four rows and put the
six unit rows beside them. They scale the rows to length one, and find the singular values of the 4x4 or 10x10 matrices by
LAPACK through numpy, one matrix after the other (JAX by its own call of it)."""


class Left(Exception):
    """Why a peer is left out of a job."""


class Worker:
    """A peer's process on one job."""

    def __init__(self, command, environment, limit):
        self.errors = tempfile.TemporaryFile()
        self.process = subprocess.Popen(
            command, cwd=HERE, env=environment, bufsize=0,
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self.errors,
        )  # fmt: skip
        self.limit = limit
        self.prepared = float(self.answer("prepared"))

    def answer(self, word):
        """What comes after `word` on the next line."""
        if not select.select([self.process.stdout], [], [], self.limit)[0]:
            self.end()
            raise Left(f"not within {self.limit:g} s")
        line = self.process.stdout.readline().decode().split()
        if line[:1] != [word]:
            self.end()
            self.errors.seek(0)
            complaint = self.errors.read().decode().strip().splitlines() or ["it ended without a word"]
            raise Left(complaint[-1])
        return line[1] if len(line) > 1 else None

    def ask(self, order, word):
        self.process.stdin.write(f"{order}\n".encode())
        return self.answer(word)

    def end(self):
        self.process.kill()
        self.process.wait()


def main():
    options = arguments()
    executable = build()
    environment = one_thread()
    found, wrong, entries = {}, [], {}
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        for job in JOBS:
            found[job], disagreements = measure(job, executable, environment, folder, options, entries)
            wrong += disagreements
    report = {"machine": machine(), "states": options.states, "rounds": options.rounds, "seed": options.seed,
              "jobs": {job: {"title": JOBS[job].title, "peers": found[job]} for job in JOBS},
              "disagreements": wrong}  # fmt: skip
    note("")
    if options.json:
        print(json.dumps(report, indent=2))
    else:
        print(markdown(report) if options.markdown else text(report))
    for line in wrong:
        print(f"DISAGREES: {line}", file=sys.stderr)
    return 1 if wrong else 0


def arguments():
    parser = argparse.ArgumentParser(prog="benches/compare", description=__doc__)
    parser.add_argument("--states", type=int, default=20000, help="how many states (default %(default)s)")
    parser.add_argument("--rounds", type=int, default=15, help="how often each peer is timed (default %(default)s)")
    parser.add_argument("--limit", type=float, default=60, help="seconds that a preparation may take (default %(default)g)")
    parser.add_argument("--seed", type=int, default=1, help="of the states (default %(default)s)")
    parser.add_argument("--quick", action="store_true", help="2000 states, 3 rounds, 10 s: whether all works")
    form = parser.add_mutually_exclusive_group()
    form.add_argument("--markdown", action="store_true", help="the table of book/src/measurements.md")
    form.add_argument("--json", action="store_true", help="everything, for programs")
    options = parser.parse_args()
    if options.quick:
        options.states, options.rounds, options.limit = 2000, 3, 10
    return options


def build():
    """Builds our worker; the path of its executable."""
    note("building our worker")
    command = ["cargo", "bench", "--locked", "--bench", "peers", "--no-run", "--message-format=json"]
    built = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, check=False)
    if built.returncode != 0:
        sys.exit(2)
    messages = [json.loads(line) for line in built.stdout.splitlines() if line.startswith(b"{")]
    return next(m["executable"] for m in messages if m.get("executable") and m["target"]["name"] == "peers")


def one_thread():
    """The workers' environment; they inherit the one core as well."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    threads = ["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "RAYON_NUM_THREADS"]
    return os.environ | dict.fromkeys(threads, "1")


def draw(model, count, seed):
    """States from the sample box, as far from what is avoided as the sweep keeps them."""
    rng = np.random.default_rng(seed)
    states = np.empty((0, len(model.states)))
    while len(states) < count:
        more = rng.uniform(model.low, model.high, (count, len(model.states)))
        clear = np.min(np.abs(model.avoid(more.T)), axis=0) >= AVOIDED
        states = np.concatenate([states, more[clear]])
    return states[:count]


def measure(job_name, executable, environment, folder, options, entries):
    """Times and deviations of all peers on one job, by peer, and who disagrees. `entries` keeps our matrices, by model."""
    job = JOBS[job_name]
    states_file, results_file = folder / f"{job_name}.states", folder / f"{job_name}.results"
    states = draw(job.model, options.states, options.seed)
    states.tofile(states_file)
    note(job.title)
    found, workers = {}, {}
    for name, peer in PEERS.items():
        note(f"{job.title}: {name} prepares", passing=True)
        start = [executable, peer] if name in (OURS, PROVED) else [sys.executable, "worker.py", peer]
        try:
            if name == PROVED and not job.singular:
                raise Left("not a verdict")
            if name in NEEDS_GCC and not shutil.which("gcc"):
                raise Left("gcc is not there")
            workers[name] = Worker([*start, job_name, str(states_file), str(results_file)], environment, options.limit)
            found[name] = {"prepared_s": workers[name].prepared, "rounds_ns": []}
        except Left as reason:
            found[name] = {"left_out": str(reason)}
    for round_number in range(options.rounds):
        note(f"{job.title}: round {round_number + 1} of {options.rounds}", passing=True)
        for name, worker in workers.items():
            found[name]["rounds_ns"].append(float(worker.ask("run", "took")) / options.states * 1e9)
    results = {}
    for name, worker in workers.items():
        worker.ask("write", "written")
        results[name] = np.fromfile(results_file).reshape(options.states, -1)
        worker.end()
        times = found[name]["rounds_ns"]
        found[name] |= {"least_ns": min(times), "median_ns": statistics.median(times)}
    if OURS not in results:
        sys.exit(f"our own worker failed: {found[OURS]['left_out']}")
    if not job.singular:
        entries.setdefault(job.model, results[OURS])
        expected = results[OURS]
    else:
        matrices = entries[job.model].reshape(options.states, len(job.rows), -1)[:, :, list(job.columns)]
        places = list(np.ndindex(matrices.shape[1:]))
        expected = Assembly(job, states, places).singular_values(matrices.reshape(options.states, -1))
    wrong = []
    for name, values in results.items():
        found[name]["ratio"] = found[name]["least_ns"] / found[OURS]["least_ns"]
        if name in (OURS, PROVED) and job.singular:
            found[name]["deviation"], unequal = own_deviation(values, entries[job.model])
            if not unequal <= EQUAL:
                wrong.append(f"{job.title}: {name} leaves rows or columns unequal by {unequal:.1e}")
        else:
            found[name]["deviation"] = deviation(values, expected, 1 if job.singular else len(job.rows))
        if not found[name]["deviation"] <= TOLERANCE:
            wrong.append(f"{job.title}: {name} by {found[name]['deviation']:.1e}")
    return found, wrong


def deviation(values, reference, rows):
    """The largest difference, each scaled by the largest entry of its row."""
    values, reference = (matrix.reshape(len(matrix), rows, -1) for matrix in (values, reference))
    return float(np.max(np.abs(values - reference) / np.max(np.abs(reference), axis=2, keepdims=True)))


def own_deviation(values, entries):
    """How far our singular values are from those that numpy finds for our entries with rows and columns multiplied by our
    factors, and how far the squares of the lengths of these rows and columns are from one. `values` hold for every state
    the factors of rows, those of columns and the singular values.
    """
    size = len(UNSEEN)
    rows, columns, singular = np.split(values, [size, 2 * size], axis=1)
    block = entries.reshape(len(entries), size, -1)[:, :, list(UNSEEN)]
    scaled = rows[:, :, None] * block * columns[:, None, :]
    squares = np.concatenate([np.sum(scaled**2, axis=1), np.sum(scaled**2, axis=2)])
    unequal = np.inf if np.min(values[:, : 2 * size]) <= 0 else float(np.max(np.abs(squares - 1)))
    return deviation(singular, np.linalg.svd(scaled, compute_uv=False), 1), unequal


def machine():
    """The processor and the versions of everything that takes part."""

    def first_line(*command):
        try:
            return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout.splitlines()[0]
        except (OSError, subprocess.CalledProcessError, IndexError):
            return f"{command[0]}: not there"

    processor = platform.processor() or platform.machine()
    try:
        information = Path("/proc/cpuinfo").read_text()
        fields = dict(re.findall(r"^([\w ]+?)\s*: (.*)$", information.split("\n\n")[0], re.MULTILINE))
        vectors = [word for word in ("avx2", "avx512f") if word in fields.get("flags", "").split()]
        family = f"family {fields.get('cpu family')} model {fields.get('model')}"
        processor = f"{fields['model name']} ({', '.join([family, *vectors])})"
    except (OSError, KeyError):
        pass
    packages = ["casadi", "jax", "numpy", "symengine", "sympy"]
    return {
        "processor": processor,
        "cores": os.cpu_count(),
        "system": f"{platform.system()} {platform.machine()}",
        "palmistry": first_line("git", "describe", "--always", "--dirty"),
        "rustc": first_line("rustc", "--version"),
        "gcc": first_line("gcc", "--version"),
        "python": platform.python_version(),
    } | {name: version(name) for name in packages}


def headline(report):
    machine = report["machine"]
    versions = ", ".join(f"{name} {machine[name]}" for name in ("casadi", "jax", "numpy", "symengine", "sympy"))
    return (
        f"{machine['processor']}, {machine['cores']} cores of which one is used; {machine['system']}; "
        f"palmistry {machine['palmistry']}, {machine['rustc']}; {machine['gcc']}; Python {machine['python']}, {versions}; "
        f"{report['states']} states, seed {report['seed']}, least of {report['rounds']} interleaved rounds"
    )


def text(report):
    lines = [headline(report)]
    for job in report["jobs"].values():
        lines += ["", f"{job['title']:<54} ns a state    median     ratio   prepared   deviation"]
        for name, peer in job["peers"].items():
            if "left_out" in peer:
                lines.append(f"  {name:<52} left out: {peer['left_out']}")
            else:
                lines.append(
                    f"  {name:<52} {peer['least_ns']:>10.1f} {peer['median_ns']:>9.1f} {peer['ratio']:>9.2f} "
                    f"{peer['prepared_s']:>8.3f} s {peer['deviation']:>11.1e}"
                )
    return "\n".join([*lines, "", WHAT_IS_TIMED])


def markdown(report):
    jobs = report["jobs"]
    lines = ["| ns a state (ratio to ours) | " + " | ".join(job["title"] for job in jobs.values()) + " | its preparation |"]
    lines.append("|---" + "|---:" * (len(jobs) + 1) + "|")
    last = list(jobs)[-1]
    for name in PEERS:
        cells = []
        for job in jobs.values():
            peer = job["peers"][name]
            cells.append(peer.get("left_out") or f"{figures(peer['least_ns'])} ({figures(peer['ratio'])})")
        prepared = jobs[last]["peers"][name].get("prepared_s")
        cells.append("" if prepared is None else f"{prepared * 1e3:.0f} ms")
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    return "\n".join([*lines, "", WHAT_IS_TIMED, "", headline(report) + "."])


def figures(value):
    """Two digits, and no decimals from ten on."""
    return f"{value:.0f}" if value >= 10 else f"{value:.1f}" if value >= 1 else f"{value:.2g}"


def note(words, passing=False):
    """Progress: what is `passing` overwrites itself on a terminal, and is not written elsewhere."""
    if sys.stderr.isatty():
        print(f"\r\033[K{words}", end="" if passing else "\n", file=sys.stderr, flush=True)
    elif not passing:
        print(words, file=sys.stderr)


if __name__ == "__main__":
    sys.exit(main())
