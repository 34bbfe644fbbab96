"""The chapter of the book on Python: its blocks are run from the first to the last, and print what it says."""

import doctest
import os
import re
import unittest

from common import ROOT

CHAPTER = os.path.join(ROOT, "book", "src", "python.md")


class Book(unittest.TestCase):
    def test_its_blocks_print_what_it_says(self):
        try:
            import pandas  # noqa: F401
            import sympy  # noqa: F401
        except ImportError:
            self.skipTest("pip install 'palmistry[sympy,tables]'")
        with open(CHAPTER, encoding="utf-8") as text:
            chapter = text.read()
        blocks = re.findall(r"^```python[^\n]*\n(.*?)^```$", chapter, flags=re.M | re.S)
        self.assertGreater(len(blocks), 3)
        test = doctest.DocTestParser().get_doctest("\n".join(blocks), {}, "python.md", CHAPTER, 0)
        said = []
        doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE, verbose=False).run(test, out=said.append)
        self.assertEqual("".join(said), "")


if __name__ == "__main__":
    unittest.main()
