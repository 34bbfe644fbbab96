"""Where the published models are: those with claims of their own in proofs/benchmarks, the others in tests/models."""

from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TABLE = ROOT / "tests/models/expected.toml"
BENCHMARKS = ROOT / "proofs/benchmarks"


def model_path(name):
    """The file of a model of the table."""
    path = BENCHMARKS / f"{name}.proof"
    return path if path.exists() else ROOT / f"tests/models/{name}.proof"


def model_paths(table):
    """All files in tests/models, and those of the benchmarks of which the table has the answer, by name."""
    paths = [*(ROOT / "tests/models").glob("*.proof"), *(path for path in BENCHMARKS.glob("*.proof") if path.stem in table)]
    return {path.stem: path for path in sorted(paths, key=lambda path: path.stem)}
