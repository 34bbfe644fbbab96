"""Our program as an observer of a scene, for observe_compare.py: it simulates, records and recovers; what it needs of the processor
and of memory.
"""

import csv
import json
import math
import re
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "examples/systems"
FILTERS = {"kalman", "unscented", "high-gain", "integration"}
# A child begins with the memory of who forked it, and its peak is never less: this forks the program from next to nothing (9 MB).
LAUNCHER = """
import os, resource, sys
most = int(sys.argv[1])
child = os.fork()
if child == 0:
    resource.setrlimit(resource.RLIMIT_CPU, (most, most))
    os.execv(sys.argv[2], sys.argv[2:])
_, status, spent = os.wait4(child, 0)
print(os.waitstatus_to_exitcode(status), spent.ru_utime + spent.ru_stime, 1024 * spent.ru_maxrss, file=sys.stderr)
"""


class Observers:
    """The program, the seconds of the processor that it may take, and a folder for its files."""

    def __init__(self, binary, most, folder):
        self.binary, self.most, self.folder = binary, most, folder

    def observe(self, text, *words):
        """What `palmistry observe` says of a scene, its seconds of the processor, and its most memory in bytes; TimeoutError has these."""
        path = self.folder / "scene.toml"
        path.write_text(text)
        launched = [sys.executable, "-I", "-S", "-c", LAUNCHER, str(self.most)]
        run = subprocess.run([*launched, self.binary, "observe", str(path), "--json", *words], capture_output=True, text=True)
        complaint, _, last = run.stderr.strip().rpartition("\n")
        status, seconds, memory = (float(word) for word in last.split())
        if status in (-signal.SIGXCPU, -signal.SIGKILL):
            raise TimeoutError(seconds, int(memory))
        if status not in (0, 1):
            raise RuntimeError(f"{run.stdout}{complaint}\n{text}")
        return json.loads(run.stdout), seconds, int(memory)

    def recovered(self, names, method, text, *words):
        """The states by name, nothing where the method took too long; seconds, and memory."""
        try:
            told, seconds, memory = self.observe(text, *words)
        except TimeoutError as late:
            return None, *late.args
        observer = told["observers"][0]
        update = observer["end"] if method in FILTERS else next(iter(observer["updates"]), None)
        states = update["states"] if update else {}
        values = [states.get(name, {}).get("recovered") for name in names]
        return np.array([math.nan if value is None else value for value in values], dtype=float), seconds, memory

    def recover(self, system, noisy, guess, method, seed):
        return self.recovered(system.box, method, scene(system, noisy, guess, method, seed))


def scene(system, noisy, guess, method, seed):
    """The system's scene with another method, guess, noise and seed."""
    text = (FOLDER / f"{system.name}.toml").read_text()
    text = re.sub(r'^model = "', f'model = "{FOLDER}/', text, flags=re.M)
    text = re.sub(r"^methods = .*$", f'methods = ["{method}"]', text, flags=re.M)
    if not noisy:
        text = re.sub(r"^noise = .*$", "noise = 0", text, flags=re.M)
    text = re.sub(r"^duration", f"seed = {seed}\nduration", text, flags=re.M)
    values = ", ".join(f"{name} = {value!r}" for name, value in guess.items())
    return re.sub(r"^window = ", f"guess = {{ {values} }}\nwindow = ", text, flags=re.M)


def recording_of(observers, system, noisy, seed):
    """Times, readings a row a sample, the truth at the first and the last sample, noise, and the bound at the first."""
    text = (FOLDER / f"{system.name}.toml").read_text()
    start = {name: float(value) for name, value in re.findall(r"^(\w+) = (-?[\d.e-]+)$", text.split("[start]")[1].split("[")[0], re.M)}
    return recorded(observers, list(system.box), len(system.read), scene(system, noisy, start, "trust-region", seed))


def recorded(observers, names, outputs, text):
    """The same of any scene whose guess is the truth."""
    record, motion = (observers.folder / name for name in ("record.csv", "motion.csv"))
    told, _, _ = observers.observe(text, "--record", str(record), "--motion", str(motion))
    rows = list(csv.reader(record.open()))
    values = np.array([[float(value) for value in row] for row in rows[1:]])
    table = list(csv.DictReader(motion.open()))
    truth = [np.array([float(row.get(name, "nan")) for name in names]) for row in (table[0], table[-1])]
    states = told["observers"][0]["updates"][0]["states"]
    bound = np.array([states.get(name, {}).get("bound") or math.nan for name in names])
    read = values[:, 1 : 1 + outputs]
    spread = np.maximum((read.max(0) - read.min(0)) / 2, 1e-9)
    columns = dict(zip(rows[0], values.T))
    return {"times": values[:, 0], "read": read, "truth": truth, "bound": bound, "sigma": told["sensor"]["noise"] or 1e-9, "spread": spread, "columns": columns}
