"""What the notebooks share: where the repository's files are, the program, pictures whose bytes are the same each time, and what was true of a robot that drives."""

import os
import shutil
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib_inline.backend_inline import set_matplotlib_formats

ROOT = Path(__file__).resolve().parent.parent
PROOFS = ROOT / "proofs"
SYSTEMS = ROOT / "examples" / "systems"

#: The program: the one that PALMISTRY names, the one on the path, or the one that `cargo build --release` has made.
PROGRAM = os.environ.get("PALMISTRY") or shutil.which("palmistry") or str(ROOT / "target" / "release" / "palmistry")

# names in a picture from a fixed salt, no date, words as words
matplotlib.rcParams.update({
    "svg.hashsalt": "palmistry", "svg.fonttype": "none", "figure.figsize": (6.4, 3.6), "figure.constrained_layout.use": True,
    "axes.spines.top": False, "axes.spines.right": False, "axes.axisbelow": True,
})
set_matplotlib_formats("svg", metadata={"Date": None}, bbox_inches=None)


def drive(times, speed, heading, start):
    """The path of a robot, a row a time: x, y (m) and heading (rad), from its speed (m/s) and heading as functions of time (s): the heading itself, the place by Simpson's rule with fine steps.
    Nothing of it is known to Palmistry."""
    path = [np.array(start, float)]
    for begin, end in zip(times[:-1], times[1:]):
        fine = np.linspace(begin, end, 21)
        rate = speed(fine) * np.array([np.cos(heading(fine)), np.sin(heading(fine))])
        weights = np.array([1] + [4, 2] * 9 + [4, 1]) * (fine[1] - fine[0]) / 3
        path.append(path[-1] + rate @ weights)
    return np.column_stack([np.array(path), heading(times)])
