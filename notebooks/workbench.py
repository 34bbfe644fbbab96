"""What the notebooks share: where the repository's files are, the program, and pictures whose bytes are the same each time."""

import os
import shutil
from pathlib import Path

import matplotlib
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
