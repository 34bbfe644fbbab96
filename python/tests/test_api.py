"""The page of the book with every public name of the package, made from signatures and docstrings; the examples in docstrings, run; the types, checked.

    PALMISTRY_BOOK=renew python -m pytest python/tests/test_api.py
"""

import doctest
import importlib
import inspect
import operator
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import textwrap
import unittest

import numpy
from common import PENDULUM, ROOT

import palmistry

PAGE = os.path.join(ROOT, "book", "src", "python_api.md")

HEAD = """# The Python package, name by name

Made from the package's signatures and docstrings by `python/tests/test_api.py`, which also runs every example. [Commands and options in Python](python_names.md) goes the other way. Examples begin with

```python not run: python/tests/test_api.py runs it
import pathlib, tempfile, numpy, palmistry

rod = palmistry.System.parse('''
SYSTEM''')
```

"""

#: In the order in which a reader needs them.
ORDER = [
    "System", "observe", "stream", "verify", "sweep", "import_model", "import_problem", "check", "advise", "poses", "from_function", "from_sympy", "from_casadi", "recheck_file", "run", "threads", "latex",
    "Claims", "Claim", "Rank", "Solutions", "Designs", "SingularSet", "Accessibility", "Certificate", "Trade", "Stress", "Motions", "Poses", "Map", "Value", "Verdicts", "Observation", "Recheck", "Page", "Printed", "Table",
    "Error", "ReadError", "EvaluationError",
]  # fmt: skip


def signature(value):
    """A signature without the types, which editors show."""
    found = inspect.signature(value)
    plain = [parameter.replace(annotation=inspect.Parameter.empty) for parameter in found.parameters.values() if parameter.name != "self"]
    return str(found.replace(parameters=plain, return_annotation=inspect.Signature.empty))


def words(value):
    """A docstring as Markdown: examples in blocks of their own."""
    text = inspect.getdoc(value) or ""
    parts = re.split(r"\n\n(?=>>>)", text)
    blocks = [textwrap.dedent(part) for part in parts[1:]]
    plain = parts[0].replace("<", "&lt;")
    # a block of an indented example is left as it stands
    return plain + "".join(f"\n\n```python not run: python/tests/test_api.py runs it\n{block.rstrip()}\n```" for block in blocks)


def members(kind):
    for name, value in vars(kind).items():
        if name.startswith("_"):
            continue
        yield name, value


def page():
    lines = [HEAD.replace("SYSTEM", PENDULUM).rstrip()]
    for name in ORDER:
        value = getattr(palmistry, name)
        lines += ["", f"## {name}", ""]
        if not inspect.isclass(value):
            lines += [f"`{name}{signature(value)}`", "", words(value)]
            continue
        lines += [words(value)]
        if issubclass(value, Exception):
            continue
        for member, what in members(value):
            is_property = isinstance(what, property) or type(what).__name__ == "cached_property"
            function = what.__func__ if isinstance(what, staticmethod) else what
            if not is_property and not inspect.isfunction(function):
                continue
            shown = f"`.{member}`" if is_property else f"`.{member}{signature(function)}`"
            text = words(what if is_property else function)
            lines += ["", f"### {shown}"] + (["", text] if text else [])
    return "\n".join(lines) + "\n"


class Api(unittest.TestCase):
    def test_every_public_name_is_on_the_page(self):
        self.assertEqual(sorted(ORDER), sorted(palmistry.__all__))
        text = page()
        if os.environ.get("PALMISTRY_BOOK") == "renew":
            with open(PAGE, "w", encoding="utf-8") as file:
                file.write(text)
        with open(PAGE, encoding="utf-8") as file:
            self.assertEqual(file.read(), text, "PALMISTRY_BOOK=renew writes it anew")

    def test_every_public_name_says_what_it_is(self):
        silent = []
        for name in ORDER:
            value = getattr(palmistry, name)
            silent += [] if inspect.getdoc(value) else [name]
            if inspect.isclass(value):
                silent += [f"{name}.{member}" for member, what in members(value) if inspect.isfunction(what) and not what.__doc__]
        self.assertEqual(silent, [])

    def test_examples_in_docstrings(self):
        names = {"pathlib": pathlib, "tempfile": tempfile, "numpy": numpy, "palmistry": palmistry, "ROOT": ROOT, "problem": os.path.join(ROOT, "examples", "petab", "Perelson_Science1996", "Perelson_Science1996.yaml"), "rod": palmistry.System.parse(PENDULUM)}
        for module in ("answers", "cluster", "observing", "program", "studies", "system", "tables", "traced", "translation"):
            found = doctest.testmod(importlib.import_module(f"palmistry.{module}"), extraglobs=names, optionflags=doctest.ELLIPSIS)
            with self.subTest(module):
                self.assertEqual(found.failed, 0)

    def test_every_function_has_an_example(self):
        """So has every method of a system: what answers have are shown where they come from."""
        asked = [name for name in ORDER if inspect.isfunction(getattr(palmistry, name))]
        asked += [f"System.{name}" for name, what in members(palmistry.System) if inspect.isfunction(getattr(what, "__func__", what))]
        silent = [name for name in asked if ">>>" not in (inspect.getdoc(operator.attrgetter(name)(palmistry)) or "")]
        self.assertEqual(silent, [])

    def test_types(self):
        try:
            import mypy  # noqa: F401
        except ImportError:
            self.skipTest("pip install 'palmistry[test]'")
        folder = os.path.join(ROOT, "python")
        words = [sys.executable, "-m", "mypy", "--cache-dir", os.path.join(ROOT, "target", "mypy"), "--config-file", os.path.join(folder, "pyproject.toml")]
        done = subprocess.run([*words, "palmistry"], cwd=folder, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)


if __name__ == "__main__":
    unittest.main()
