"""Studies before an experiment is made, and what is wrong with a file."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable

from .answers import Motions, Poses
from .errors import Error
from .system import _asked, _native


def advise(
    scene: str | os.PathLike[str],
    *,
    trials: int | None = None,
    angle1: tuple[float, float] = (0.2, 1.2),
    angle2: tuple[float, float] = (0.8, 1.9),
    rate: float | None = None,
    runs: int | None = None,
    seed: int | None = None,
) -> Motions:
    """Motions of two palms that touch all normals of a scene's body and hold it all the time; of a scene in space, runs that widen the hull of all contacts.

    trials: how many motions are tried, 400 unless given; in space for each run, 32 unless given. angle1, angle2: the least and the greatest angle of palm 1 against the ground and of palm 2
    against palm 1, in rad. rate: the greatest rate of either palm, 3 rad/s unless given; in space that at which the body is set turning, 0.5 unless given. runs: how many in space, 4 unless
    given. seed: in place of the scene's. More trials may find better ones; the same seed finds the same ones on any number of threads.

    >>> scene = pathlib.Path(ROOT, "proofs", "moll2002", "scenes", "general.toml")
    >>> found = palmistry.advise(scene, trials=2)
    >>> found.json["tried"]
    2
    """
    for name, (low, high) in {"angle1": angle1, "angle2": angle2}.items():
        if not float("-inf") < low < high < float("inf"):
            raise Error(f"{name}: {low} to {high} is no range of angles", "give the least and the greatest angle, in rad")
    if rate is not None and not 0.0 <= rate < float("inf"):
        raise Error(f"rate: {rate} rad/s is no rate", "give one from zero on")
    _within("trials", trials, 1_000_000)
    _within("runs", runs, 100)
    return _asked(Motions, lambda: _native.advise(os.fspath(scene), trials, [list(angle1), list(angle2)], rate, runs, seed))


def poses(
    scene: str | os.PathLike[str] | None = None,
    *,
    shape: str | None = None,
    centre: tuple[float, float] | None = None,
    palms: tuple[float, float] = (0.6, 1.6),
    margin: float = 0.15,
    margins: Iterable[float] = (0.004, 0.05, 0.15, 0.3),
    turn: tuple[float, float] | None = None,
    pad: tuple[float, float] | None = None,
    tolerance: float = 0.0,
    grid: int = 20,
    levels: int = 4,
) -> Poses:
    """The stable poses of a body between two slow palms without friction, how they are connected, and palm motions that turn the body or touch all of it.

    The body of a scene, or `shape`: 'spline:Q1,Q2,Q3', 'centripetal:Q1,Q2,Q3', 'ellipse:A,B', or 'harmonics:MEAN,P2,Q2,...' of the support function, in m, with its centre of mass at `centre`.
    palms: the angles phi1 and phi2, in rad, at which all stable poses are listed. margin: how far palms keep from being parallel to each other or to the ground, in rad: for plans and
    certificates; margins: those at which components are reported. turn: plan from one orientation to another, in rad. pad: both contacts stay in this part of their palms, in m from where the
    palms meet. tolerance: poses of a plan stay stable if either palm is off by this angle, in rad. grid: nodes along a side of the grid of palm angles. levels: how often the certificate halves its
    squares, 0 to 7. Random bodies: `run("poses", bodies=10)`.

    >>> found = palmistry.poses(shape="ellipse:0.02,0.015", margins=[0.3], levels=1)
    >>> len(found.json["components"])
    1
    """
    if not 4 <= grid <= 200:
        raise Error(f"a grid of {grid} nodes along a side is not possible", "between 4 and 200 are")
    if not 0 <= levels <= 7:
        raise Error(f"{levels} levels are not possible", "between 0 and 7 are")
    if not 0.0 <= tolerance < 1.0:
        raise Error(f"tolerance: {tolerance} rad", "give 0 to 1")
    pairs = [None if pair is None else list(pair) for pair in (centre, turn, pad)]
    asked = (None if scene is None else os.fspath(scene), shape, pairs[0], list(palms), margin, list(margins), pairs[1], pairs[2], tolerance, grid, levels)
    return _asked(Poses, lambda: _native.poses(*asked))


def check(path: str | os.PathLike[str]) -> list[dict]:
    """All that is wrong with a proof file, up to a limit: syntax, names, kinds of values, references. Nothing is decided; an empty list says that it can be read.

    Each is an object as `palmistry check --json` prints it: file, line, column, message and help.

    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = pathlib.Path(folder, "decay.proof")
    ...     _ = file.write_text('system "A decay" state x drift f x\\' = -k*x output x')
    ...     [(one["line"], one["message"]) for one in palmistry.check(file)]
    [(1, "unknown name 'k'")]
    """
    problems, _ = _native.examined(os.fspath(path))
    return json.loads(problems)


def _within(name: str, value: int | None, most: int) -> None:
    if value is not None and not 1 <= value <= most:
        raise Error(f"{name}={value} is not possible", f"between 1 and {most} are")
