"""Every command and option of the program beside its name in Python: the table in the book, and whether all is so. Oracles: the program's own help, and signatures.

    PALMISTRY_BOOK=renew python -m pytest python/tests/test_names.py
"""

import importlib
import inspect
import os
import re
import subprocess
import unittest

from common import PROGRAM, ROOT, built

import palmistry

PAGE = os.path.join(ROOT, "book", "src", "python_names.md")

HEAD = """# Commands and options in Python

Each command and each option of the program beside its name in the package. A word in italics says where the thing is; `run` is `palmistry.run(COMMAND, ..., option=value)`, which runs the program in a
process of its own. This page is made by `python/tests/test_names.py`, which reads the options from the program and holds the names to the package's signatures.

"""

#: What has the same name in Python as on the command line, wherever it is.
EVERYWHERE = {
    "--json": "*`.json` of the answer*",
    "--seed": "seed",
    "--no-times": "times",
}

#: By command: the callables that answer it, and what its options are called. A plain name is an argument of one of them; an attribute (`Class.name`) is one; a text in asterisks says it in
#: words; `run` leaves it to `palmistry.run`.
COMMANDS = {
    "verify": (["verify"], {"--out": "Page.save", "--coq": "run", "--paper": "run"}),
    "prove": (["System.prove"], {
        "--only": "only", "--verdicts": "Claims.evidence", "--latex": "Claim.latex", "--quiet": "*filter `Claims.table` by `ok`*", "--coq": "run", "--junit": "run",
        "--watch": "*of an editor: there is nothing to watch*",
    }),
    "check": (["check"], {}),
    "rank": (["System.rank", "System.global_", "System.accessible", "System.singular_set", "System.reparametrise", "sweep"], {
        "--samples": "samples", "--at": "at", "--where": "where", "--order": "order", "--verdict": "verdict", "--digits": "digits", "--table": "table", "--coordinates": "coordinates",
        "--global": "System.global_", "--functions": "functions", "--work": "work", "--accessible": "System.accessible", "--singular-set": "System.singular_set", "--out": "SingularSet.page",
        "--reparametrise": "System.reparametrise", "--details": "*all of it is in `.json`*", "--verdicts": "run", "--verdict-states": "run",
        "--shard": "shards", "--part": "folder", "--merge": "sweep", "--missing": "cluster.missing",
    }),
    "recheck": (["recheck_file", "Claims.recheck"], {"--proofs": "proofs"}),
    "certify": (["System.certify"], {
        "--box": "box", "--boxes": "boxes", "--budget": "budget", "--map": "map", "--order": "order", "--rows": "rows", "--out": "Certificate.map_svg",
        **dict.fromkeys(["--depth", "--merge", "--merged", "--missing", "--part", "--shard", "--state", "--verdict-boxes", "--verdicts"], "run"),
    }),
    "trade": (["System.trade"], {"--samples": "samples", "--out": "Trade.svg"}),
    "stress": (["System.stress"], {"--rows": "rows", "--states": "states", "--samples": "samples", "--out": "Stress.pictures", "--paper": "run"}),
    "eval": (["System.eval"], {"--at": "at", "--digits": "digits", "--verdict": "verdict", "--latex": "Value.latex"}),
    "observe": (["observe", "stream", "cluster.sweep_command"], {
        "--data": "data", "--studies": "studies", "--out": "Observation.page", "--record": "Observation.measurements", "--motion": "Observation.motion", "--track": "Observation.track",
        "--outline": "Observation.outline", "--shard": "shards", "--part": "folder", "--merge": "cluster.sweep_command", "--missing": "cluster.missing",
        "--accuracy": "run", "--within": "run", "--resume": "run",
    }),
    "advise": (["advise", "System.design"], {f"--{name.replace('_', '-')}": name for name in ("trials", "angle1", "angle2", "rate", "runs", "identify", "globally", "by", "measure", "at_most")}),
    "poses": (["poses"], {
        **{f"--{name}": name for name in ("shape", "centre", "palms", "margin", "margins", "turn", "pad", "tolerance", "grid", "levels")},
        "--out": "Poses.page", **dict.fromkeys(["--bodies", "--family", "--plans", "--seed"], "run"),
    }),
    "import": (["import_model", "import_problem"], {
        "--from": "format", "--model": "model", "--output": "outputs", "--unknown": "unknown", "--input": "inputs", "--unknown-input": "unknown_inputs", "--state": "states",
        "--out": "import_problem",
    }),
    "reduce": (["System.reduce"], {"--fix": "fix", "--known": "known", "--undriven": "undriven", "--drive": "drive", "--signal": "signals", "--tolerance": "tolerance", "--out": "path"}),
    "plan": (["run"], {"--data": "run", "--tolerance": "run", "--out": "run"}),
    "new": (["run"], {}),
    "demo": (["run"], {}),
    "explain": (["run"], {}),
    "fmt": (["System.formatted"], {"--check": "*compare `System.formatted` with `System.source`*"}),
}

#: What a Python program has no use for.
LEFT_OUT = {"lab": "a page in the browser", "lsp": "an editor starts it", "completions": "for shells", "man": "for the command line", "help": "for the command line"}


def found(name):
    """What a dotted name of the package is; `sweep` is the function."""
    value = palmistry
    for part in name.split("."):
        value = importlib.import_module("palmistry.cluster") if part == "cluster" else inspect.getattr_static(value, part) if inspect.isclass(value) else getattr(value, part)
        value = value.__func__ if isinstance(value, staticmethod) else value
    return value


def arguments(name):
    value = found(name)
    return set(inspect.signature(value).parameters) if callable(value) else set()


def options(command):
    text = subprocess.run([PROGRAM, command, "--help"], capture_output=True, text=True, check=True).stdout
    return sorted({*re.findall(r"^ +(?:-\w, )?(--[a-z0-9-]+)", text, flags=re.M)} - {"--help"})


@built
class Names(unittest.TestCase):
    def test_every_command_and_option_has_a_name(self):
        help_text = subprocess.run([PROGRAM, "--help"], capture_output=True, text=True, check=True).stdout
        commands = re.findall(r"^  ([a-z]+) ", help_text.split("Commands:")[1].split("Options:")[0], flags=re.M)
        self.assertEqual(set(commands), {*COMMANDS, *LEFT_OUT})
        lines = [HEAD + "| command | option | in Python |", "|---|---|---|"]
        for command in commands:
            if command in LEFT_OUT:
                lines.append(f"| `{command}` | | *none: {LEFT_OUT[command]}* |")
                continue
            homes, named = COMMANDS[command]
            for home in homes:
                self.assertIsNotNone(found(home), home)
            lines.append(f"| `{command}` | | {', '.join(f'`{home}`' for home in homes)} |")
            there = options(command)
            self.assertEqual(set(named) - set(there), set(), f"{command} has no such option")
            for option in there:
                by_run = homes == ["run"]
                name = named.get(option) or ("run" if by_run and option != "--json" else EVERYWHERE.get(option))
                self.assertIsNotNone(name, f"{command} {option} has no name in Python")
                if name == "run":
                    name = f"`run(\"{command}\", ..., {option[2:].replace('-', '_')}=...)`"
                elif not name.startswith("*"):
                    is_argument = any(name in arguments(home) for home in homes)
                    self.assertTrue(is_argument or found(name) is not None, name)
                    name = f"`{name}`"
                lines.append(f"| | `{option}` | {name} |")
        page = "\n".join(lines) + "\n"
        if os.environ.get("PALMISTRY_BOOK") == "renew":
            with open(PAGE, "w", encoding="utf-8") as file:
                file.write(page)
        with open(PAGE, encoding="utf-8") as file:
            self.assertEqual(file.read(), page, "PALMISTRY_BOOK=renew writes it anew")


if __name__ == "__main__":
    unittest.main()
