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

    def observe(self, text, *words, readings=None):
        """What `palmistry observe` says of a scene, its seconds of the processor, and its most memory in bytes; TimeoutError has these. Readings
        that come as a stream are answered by a line for each window."""
        path = self.folder / "scene.toml"
        path.write_text(text)
        launched = [sys.executable, "-I", "-S", "-c", LAUNCHER, str(self.most)]
        run = subprocess.run([*launched, self.binary, "observe", str(path), "--json", *words], input=readings, capture_output=True, text=True)
        complaint, _, last = run.stderr.strip().rpartition("\n")
        status, seconds, memory = (float(word) for word in last.split())
        if status in (-signal.SIGXCPU, -signal.SIGKILL):
            raise TimeoutError(seconds, int(memory))
        if status not in (0, 1):
            raise RuntimeError(f"{run.stdout}{complaint}\n{text}")
        told = run.stdout if readings is None else f"[{','.join(run.stdout.splitlines())}]"
        return json.loads(told), seconds, int(memory)

    def record(self, text, motion):
        """The readings of a scene as text; its motion goes into a file."""
        path = self.folder / "scene.toml"
        path.write_text(text)
        words = [self.binary, "observe", str(path), "--record", "-", "--motion", motion]
        return subprocess.run(words, capture_output=True, text=True, check=True).stdout

    def recover(self, system, method, text, *words, readings=None):
        """The states by name, nothing where the method took too long; seconds, and memory."""
        try:
            told, seconds, memory = self.observe(text, *words, readings=readings)
        except TimeoutError as late:
            return None, *late.args
        # of a stream the last line is about all windows
        windows = told[:-1] if readings else [told]
        observers = [window["observers"][0] for window in windows]
        found = [observer["end"] for observer in observers[-1:]] if method in FILTERS else [update for observer in observers for update in observer["updates"]]
        states = found[0]["states"] if found and found[0] else {}
        values = [states.get(name, {}).get("recovered") for name in system.box]
        return np.array([math.nan if value is None else value for value in values], dtype=float), seconds, memory


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
    text = scene(system, noisy, start, "trust-region", seed)
    record, motion = (observers.folder / name for name in ("record.csv", "motion.csv"))
    told, _, _ = observers.observe(text, "--record", str(record), "--motion", str(motion))
    return recorded(list(system.box), len(system.read), record, motion, told["observers"][0]["updates"][0], told["sensor"]["noise"])


def recorded(names, outputs, record, motion, update, noise):
    """A recording for the peers, from the files and an update that began at the truth."""
    rows = list(csv.reader(record.open()))
    values = np.array([[float(value) for value in row] for row in rows[1:]])
    table = list(csv.DictReader(motion.open()))
    truth = [np.array([float(row.get(name, "nan")) for name in names]) for row in (table[0], table[-1])]
    bound = np.array([update["states"].get(name, {}).get("bound") or math.nan for name in names])
    read = values[:, 1 : 1 + outputs]
    spread = np.maximum((read.max(0) - read.min(0)) / 2, 1e-9)
    columns = dict(zip(rows[0], values.T))
    return {"times": values[:, 0], "read": read, "truth": truth, "bound": bound, "sigma": noise or 1e-9, "spread": spread, "columns": columns}
