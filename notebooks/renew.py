"""Executes the notebooks, and writes what they show beside them.

    python notebooks/renew.py [--check] [NAME...]

Each `NAME.py` here (percent format) becomes `NAME.ipynb` with all outputs and pictures. What depends on the machine or the day is left out: identities of
cells are their places, there are no times, cells tagged `times` keep no output, and a place in a picture is told to a hundredth of a point. Who renews what has not changed gets the same bytes; with `--check`
nothing is written, and the exit status is 1 where bytes differ or a notebook fails. Needs what `requirements.txt` names and the program.
"""

import argparse
import difflib
import re
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import jupytext
import nbformat
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError, CellTimeoutError

FOLDER = Path(__file__).resolve().parent


def joined(outputs):
    """Pieces of one stream that follow one another as one: where they were cut depends on how fast they came."""
    found = []
    for output in outputs:
        if found and output.output_type == "stream" and found[-1].output_type == "stream" and found[-1].name == output.name:
            found[-1].text += output.text
        else:
            found.append(output)
    return found


def rounded(picture):
    """A picture whose lines do not show what rounding an estimate differently comes to."""
    lines = re.compile(r' d="[^"]*"')
    return lines.sub(lambda line: re.sub(r"\d+\.\d{3,}", lambda number: f"{float(number[0]):.2f}".rstrip("0").rstrip("."), line[0]), picture)


def executed(source):
    """The notebook of a script with its outputs, as text."""
    notebook = jupytext.read(source)
    NotebookClient(notebook, timeout=1500, kernel_name="python3", record_timing=False, resources={"metadata": {"path": str(FOLDER)}}).execute()
    for place, cell in enumerate(notebook.cells, 1):
        cell["id"] = f"cell-{place}"
        if cell.cell_type == "code":
            if "times" in cell.metadata.get("tags", []):
                cell.outputs = []
            cell.outputs = joined(cell.outputs)
            for output in cell.outputs:
                pictures = output.get("data", {})
                pictures.update({kind: rounded(text) for kind, text in pictures.items() if kind == "image/svg+xml"})
                output.pop("metadata", None) if output.output_type == "stream" else output.update(metadata={})
                if output.output_type == "stream" and output.name == "stderr":
                    raise RuntimeError(f"{source.name}, cell {place}, says on standard error: {output.text}")
    notebook.metadata = {"kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"}, "language_info": {"name": "python"}}
    nbformat.validate(notebook)
    text = nbformat.writes(notebook, version=4) + "\n"
    for machine in (str(FOLDER.parent), str(Path.home()) + "/", sys.prefix):
        if machine in text:
            raise RuntimeError(f"{source.name} shows the path {machine}")
    return text


def renew(source, check):
    """What is wrong with a notebook, in words: nothing where it is as it should be."""
    target = source.with_suffix(".ipynb")
    try:
        text = executed(source)
    except (CellExecutionError, CellTimeoutError, RuntimeError) as why:
        return f"{source.name} fails:\n" + re.sub(r"\x1b\[[0-9;]*m", "", str(why))
    if not check:
        target.write_text(text, encoding="utf-8")
        return ""
    kept = target.read_text(encoding="utf-8") if target.exists() else ""
    if kept == text:
        return ""
    lines = difflib.unified_diff(kept.splitlines(), text.splitlines(), "committed", "executed", lineterm="", n=0)
    shown = "\n".join(line[:300] for line in list(lines)[:30])
    return f"{target.name} is not what its script shows; `python notebooks/renew.py` writes it anew:\n{shown}"


def main():
    options = argparse.ArgumentParser(description="Executes the notebooks, and writes what they show beside them.")
    options.add_argument("names", nargs="*", help="those to be executed, as 1_is_my_system_observable; all unless given")
    options.add_argument("--check", action="store_true", help="write nothing; fail where bytes differ")
    options = options.parse_args()
    sources = sorted(FOLDER.glob("[0-9]_*.py"))
    unknown = set(options.names) - {source.stem for source in sources}
    if unknown:
        sys.exit(f"there is no notebook {', '.join(sorted(unknown))}")
    chosen = [source for source in sources if not options.names or source.stem in options.names]
    with ThreadPoolExecutor(2) as pool:
        found = list(pool.map(lambda source: renew(source, options.check), chosen))
    for why in filter(None, found):
        print(why, file=sys.stderr)
    passed = found.count("")
    print(f"notebooks: {passed} passed, {len(found) - passed} failed")
    sys.exit(passed < len(found))


if __name__ == "__main__":
    main()
