r"""What mdBook is given in the place of the book's pages: a preprocessor, by mdBook's protocol, that release/book makes it run.

Formulas, `$...$` within a line and `$$...$$` by themselves, as GitHub reads them too, become MathML, which browsers set without a script.
Code stays as it is, between backticks and fences and where it is indented; a dollar that begins no formula is written `\$`, and is refused
where it is not. Links that leave the book become words: there is no address at which what they name could be found. What stands behind a
fence, for the tests, would become classes of the style: a name of a file and why nothing is run are written above the block instead.

math-core (MIT, in Rust, without dependencies) makes the MathML since it refuses what it does not know; other converters for Python print it.

>>> def shown(text): return re.sub("&#(\\d+);", lambda found: chr(int(found[1])), Page("a.md", text).text())
>>> shown("So $x^2$ `$x$`, ``a ` $b``, \\$5 and a [link](b.md), and [`c`](../c).")
'So <math><msup><mi>x</mi><mn>2</mn></msup></math> `$x$`, ``a ` $b``, \\$5 and a [link](b.md), and `c`.'
>>> shown("$a[b]$ | $c|$").count("|</mo>"), any(c in Page("a.md", "$a[b]$ and $c|$").text() for c in "[]|")
(1, False)
>>> shown("```console\n$ x $y$\n```\n\n    $z$ $\n\n- one\n\n    $w$\n").replace("\n", "/")
'```console/$ x $y$/```//    $z$ $//- one//    <math><mi>w</mi></math>/'
>>> shown("```sh not run: a <page>\n```\n```text file=a.txt refused\n```").replace("\n", "/")
'<div class="behind-fence">not run: a &lt;page&gt;</div>//```sh/```/<div class="behind-fence">a.txt</div>//```text/```'
>>> shown("$$\nx\n$$")
'<div class="formula"><math display="block"><mi>x</mi></math></div>'
>>> Page("a.md", "one\n\n$x$ and $\\nothing$ for $5").faults()
['a.md:3: $\\nothing$: Unknown command "\\nothing".', 'a.md:3: a dollar that begins no formula; write \\$']
"""

import html
import json
import posixpath
import re
import sys

import math_core

CONVERTER = math_core.LatexToMathML(fancy_error=False)
# the prime of a font is raised as it is; fonts that have no larger one to be raised once more make it too small
PRIMED = re.compile(r"<msup>(<mi[^>]*>[^<]*</mi>)<mo>([′″‴⁗])</mo></msup>")
FENCE = re.compile(r"\s*(`{3,}(?=[^`]*$)|~{3,})\s*(\w*)[\s,]*(.*)")
LIST = re.compile(r" {0,3}([-*+]|\d{1,9}[.)])\s")
PIECE = re.compile(
    r"""(?P<escaped>\\[!-/:-@\[-`{-~])
    | (?P<code>(?P<ticks>`+)(?!`).*?(?<!`)(?P=ticks)(?!`)) | `+
    | (?P<comment><!--.*?-->)
    | (?<!!)\[(?P<words>(?:[^][`]|`[^`]*`)*)\]\((?P<to>[^()\s]+)\)
    | \$\$(?P<alone>[^$]+)\$\$
    | \$(?P<within>(?=\S)[^$\n]+(?<=\S))\$(?![0-9A-Za-z])
    | (?P<stray>\$)""",
    re.X | re.S,
)


def as_text(found: re.Match) -> str:
    """What stands between two tags, with nothing in it that Markdown would read."""
    text = html.unescape(found[0])
    return "".join(c if c.isalnum() or c == " " or not c.isascii() else f"&#{ord(c)};" for c in text)


class Page:
    """A page that is being gone through."""

    def __init__(self, path: str, text: str, below: str = "") -> None:
        self.path, self.source, self.below = path, text, below
        self.wrong: list[tuple[int, str]] = []
        self.line = 1

    def faults(self) -> list[str]:
        """What cannot be set, each with its place."""
        self.text()
        return [f"{self.below}{self.path}:{line}: {why}" for line, why in self.wrong]

    def text(self) -> str:
        """The page with formulas as MathML."""
        done, prose, fence, in_list, before = [], [], "", False, ""
        self.wrong.clear()

        def close() -> None:
            text = "\n".join(prose)
            self.line = number - len(prose)
            if prose:
                done.append(PIECE.sub(lambda found: self.piece(found, text), text))
            prose.clear()

        lines = self.source.split("\n")
        for number, line in enumerate(lines, 1):
            opened = FENCE.match(line)
            is_indented = line.startswith(("    ", "\t")) and not before.strip() and not in_list
            if fence:
                done.append(line)
                if opened and opened[1].startswith(fence) and not line.strip().strip(fence[0]):
                    fence = ""
            elif is_indented or not line.strip():
                close()
                done.append(line)
                if is_indented:
                    continue  # the next line of the block stands behind an empty one too
            elif opened:
                close()
                fence = opened[1]
                told = opened[3] if opened[3].startswith("not run:") else re.sub(r".*\bfile=(\S+).*|.*", r"\1", opened[3], count=1)
                # those of the Python package are run by its own tests
                if told and line.startswith(fence) and "python/tests/" not in told:
                    done += [f'<div class="behind-fence">{html.escape(told)}</div>', ""]
                done.append(line[: opened.end(2)])
            else:
                prose.append(line)
                if not line.startswith(" ") or LIST.match(line):
                    in_list = bool(LIST.match(line))
            before = line
        number = len(lines) + 1
        close()
        return "\n".join(done)

    def piece(self, found: re.Match, text: str) -> str:
        """What stands for a piece of prose; most stand for themselves."""
        line = self.line + text.count("\n", 0, found.start())
        if found["stray"]:
            self.wrong.append((line, "a dollar that begins no formula; write \\$"))
        if found["to"]:
            return self.link(found, text)
        formula = found["alone"] or found["within"]
        if not formula:
            return found[0]
        formula = formula.strip()
        try:
            made = CONVERTER.convert_with_local_state(formula, displaystyle=bool(found["alone"]))
        except math_core.LatexError as why:
            self.wrong.append((line, f"${formula}$: {str(why).split(': ', 1)[-1]}"))
            return found[0]
        made = PRIMED.sub(r'<mrow>\1<mo lspace="0" rspace="0">\2</mo></mrow>', made)
        made = re.sub(r"(?<=>)[^<]+(?=<)", as_text, made)
        return f'<div class="formula">{made}</div>' if found["alone"] else made

    def link(self, found: re.Match, text: str) -> str:
        """A link, or its words where it leaves the book."""
        words = PIECE.sub(lambda inner: self.piece(inner, text), found["words"])
        to = found["to"].split("#")[0]
        path = posixpath.normpath(posixpath.join(posixpath.dirname(self.path), to))
        if "://" in to or to.startswith("mailto:") or not path.startswith(".."):
            return f"[{words}]({found['to']})"
        path = path.replace("../", "")
        return words if path.split("/")[-1] in words else f"{words} (`{path}`)"


def main() -> None:
    """Answers mdBook: whether a renderer is one for these pages, or the book with its pages made."""
    if sys.argv[1:2] == ["supports"]:
        sys.exit(sys.argv[2:] != ["html"])
    context, book = json.load(sys.stdin.buffer)
    below = posixpath.join(posixpath.basename(context["root"]), context["config"]["book"].get("src", "src")) + "/"
    faults, items = [], list(book["items"])
    while items:
        chapter = items.pop(0)
        chapter = chapter.get("Chapter") if isinstance(chapter, dict) else None
        if not chapter:
            continue
        items.extend(chapter["sub_items"])
        page = Page(chapter["source_path"] or "", chapter["content"], below)
        faults += page.faults()
        chapter["content"] = page.text()
    if faults:
        sys.exit("\n".join(faults))
    json.dump(book, sys.stdout)


if __name__ == "__main__":
    main()
