"""Whether every link, anchor and picture of a site leads somewhere within it, and nothing is loaded from elsewhere.

    python3 release/book_links.py FOLDER

Addresses of other sites are not asked for, only counted.
"""

import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit


class Page(HTMLParser):
    """What a page names, and what it can be asked for."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.anchors, self.twice, self.links, self.loads, self.formulas = set(), set(), [], [], 0
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = dict(attrs)
        self.formulas += tag == "math"
        name = values.get("id")
        if name:
            (self.twice if name in self.anchors else self.anchors).add(name)
        if tag == "a" and values.get("href"):
            self.links.append((values["href"], self.getpos()[0]))
        for key in ("src", "data", "poster") + (("href",) if tag == "link" else ()):
            if values.get(key):
                self.loads.append((values[key], self.getpos()[0]))


def main(folder: str) -> None:
    """Reads all pages, and ends with status 1 where something leads nowhere."""
    root = Path(folder).resolve()
    pages = {path: Page(path) for path in sorted(root.rglob("*.html"))}
    wrong, links, outside, loads = [], 0, 0, 0

    def is_right(page: Path, to: str) -> bool:
        parts = urlsplit(to)
        target = (page.parent / unquote(parts.path)).resolve() if parts.path else page
        target = target / "index.html" if target.is_dir() else target
        if root not in target.parents or not target.is_file():
            return False
        return not parts.fragment or target not in pages or unquote(parts.fragment) in pages[target].anchors

    for path, page in pages.items():
        name = path.relative_to(root)
        # the page for what is not there is shown under any address, and so names the site's own
        if name.name == "404.html":
            continue
        wrong += [f"{name}: two places are called '{anchor}'" for anchor in sorted(page.twice)]
        for to, line in page.links:
            links += 1
            if urlsplit(to).scheme:
                outside += 1
            elif not is_right(path, to):
                wrong.append(f"{name}:{line}: {to} leads nowhere")
        for to, line in page.loads:
            loads += 1
            if urlsplit(to).scheme not in ("", "data") or to.startswith("//"):
                wrong.append(f"{name}:{line}: {to} is loaded from elsewhere")
            elif not to.startswith("data:") and not is_right(path, to):
                wrong.append(f"{name}:{line}: {to} is not there")
    for line in wrong:
        print(line)
    formulas = sum(page.formulas for path, page in pages.items() if path.name not in ("index.html", "print.html"))
    loaded = f"{loads} pictures, styles and scripts"
    print(f"{len(pages)} pages, {formulas} formulas, {links} links ({outside} to other sites, not asked for), {loaded}: {len(wrong)} wrong")
    sys.exit(bool(wrong))


if __name__ == "__main__":
    main(*sys.argv[1:])
