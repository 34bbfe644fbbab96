"""The published models of tests/models and proofs/benchmarks: models.py [BINARY]

Holds `expected.toml` to the plain test at two primes, at true states where there are functions that are not rational, and
to the functions that were published as identifiable: each of them is seen, and there are as many as there can be. With a
BINARY, its answers too. Exit status 1 where anything differs.
"""

import json
import subprocess
import sys
import tomllib

from differential import FUNCTION, is_seen, theirs
from generic_rank import Reals, decide
from model_files import TABLE, model_paths
from proof_file import ProofFile


def told(text, functions, alone=False, known_constants=False):
    """The rank with more outputs, or with these alone and nothing in motion, or with all constants known."""
    model = ProofFile(text + "".join(f"\noutput {function}" for function in functions))
    if alone:
        model.outputs, model.fields = model.outputs[len(model.outputs) - len(functions) :], []
    if known_constants:
        moving = {name for _, rates in model.fields for name in rates}
        model.unknown = [name in moving for name in model.states]
    return decide(model)["rank"]


def mistakes(text, expected):
    """What in an entry of the table is not so."""
    found = []
    answers = [decide(text)] + ([decide(text, numbers=Reals, tries=1)] if FUNCTION.search(text) else [])
    for answer in answers:
        if any(answer[key] != expected[key] for key in ("rank", "dimension")) or set(answer["not_seen"]) != set(
            expected["not_seen"]
        ):
            found.append(f"rank {answer['rank']} of {answer['dimension']}, not seen {answer['not_seen']}")
    functions, of_constants = expected.get("functions", []), expected.get("functions_of_constants", [])
    if told(text, functions + of_constants) != expected["rank"]:
        found.append("a published function is not seen")
    if functions and told(text, functions, alone=True) != expected["rank"]:
        found.append("the published functions are not as many as there can be")
    if of_constants and told(text, of_constants, alone=True) != expected["rank"] - told(text, [], known_constants=True):
        found.append("the published functions of constants are not as many as there can be")
    return found


def binary_mistakes(binary, path, expected, limit=60):
    try:
        run = subprocess.run(
            [binary, "rank", str(path), "--json", "--samples", "0"], capture_output=True, text=True, timeout=limit
        )
        rank, final, words = theirs(json.loads(run.stdout))
    except (subprocess.TimeoutExpired, json.JSONDecodeError) as error:
        return [f"{binary}: {type(error).__name__}"]
    found = [] if final and rank == expected["rank"] else [f"{binary}: rank {rank}{'' if final else ', not final'}"]
    if final and words:
        found += [
            f"{binary}: {name} {word}" for name, word in words.items() if is_seen(word) != (name not in expected["not_seen"])
        ]
    return found


def main(binary=None):
    table, wrong = tomllib.loads(TABLE.read_text()), 0
    paths = model_paths(table)
    names = set(paths)
    for name in sorted(names ^ table.keys()):
        print(f"{name}: a file without an entry, or an entry without a file")
        wrong += 1
    for name in sorted(names & table.keys()):
        text = paths[name].read_text()
        found = mistakes(text, table[name]) + (
            binary_mistakes(binary, paths[name], table[name]) if binary else []
        )
        wrong += bool(found)
        for line in found:
            print(f"{name}: {line}; the table says {table[name]['rank']} of {table[name]['dimension']}")
    print(f"{len(names)} models, {wrong} differ")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
