"""The program, where a question is asked by the name of its command: what has no function of its own here."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from typing import Any

from .errors import Error


class Printed:
    """What the program has printed: `json`, the object that it prints with `--json`, and its exit `status` (0 all as expected, 1 something is not, 3 cut off)."""

    def __init__(self, found: dict[str, Any], status: int) -> None:
        self.json = found
        self.status = status

    @property
    def ok(self) -> bool:
        """Whether all is as expected."""
        return self.status == 0

    def __str__(self) -> str:
        return json.dumps(self.json, indent=2)

    def __repr__(self) -> str:
        return f"<printed: {', '.join(self.json)}>"


def path() -> str:
    """Where the program is: PALMISTRY where the environment says it, else beside this Python, where `pip install` puts it, else on the PATH."""
    said = os.environ.get("PALMISTRY")
    beside = os.path.join(os.path.dirname(sys.executable), "palmistry")
    found = said or (beside if os.path.exists(beside) else shutil.which("palmistry"))
    if found is None:
        raise Error("the program palmistry is not installed", "pip install puts it beside Python; or set PALMISTRY to its path")
    return found


def _words(options: dict[str, Any]) -> list[str]:
    """Options of Python as those of the command line: `boxes=100` is `--boxes 100`, `no_times=True` is `--no-times`, `from_` is `--from`; a list is given once for each entry."""
    words = []
    for name, value in options.items():
        option = "--" + name.strip("_").replace("_", "-")
        for one in value if isinstance(value, (list, tuple)) else [value]:
            if one is None or one is False:
                continue
            words += [option] if one is True else [f"{option}={os.fspath(one) if isinstance(one, os.PathLike) else one}"]
    return words


def run(command: str, *arguments: Any, **options: Any) -> Printed:
    """Runs a command of the program, in a process of its own, and returns what it prints.

    command: as 'new' or 'demo', or one that has a function here, for what options it alone has. arguments, options: those of the command line, where `boxes=100` is
    `--boxes 100`, `no_times=True` is `--no-times` and `from_="sbml"` is `--from sbml`; a list is given once for each entry. Raises Error with the program's own words where the input cannot
    be used. Ctrl-C ends the program as well.

    >>> import palmistry, pathlib, tempfile
    >>> file = pathlib.Path(tempfile.mkdtemp(), "decay.proof")
    >>> _ = file.write_text('system "A decay" state x drift f x\\' = -x output x')
    >>> palmistry.run("check", file).json["errors"]
    []
    """
    words = [path(), command, *map(_text, arguments), *_words(options)]
    done = subprocess.run([*words, "--json"], capture_output=True, text=True, check=False)
    try:
        found = json.loads(done.stdout)
    except ValueError:
        raise Error(done.stderr.strip() or f"{command} printed nothing") from None
    if done.returncode == 2 and "error" in found:
        raise Error(found["error"].get("message", ""), found["error"].get("help"))
    return Printed(found, done.returncode)


def _text(value: Any) -> str:
    return os.fspath(value) if isinstance(value, os.PathLike) else str(value)
