"""Tables: columns of equal length under names, and their way to pandas and Arrow."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy


class Table(Mapping[str, "numpy.ndarray"]):
    """Columns under names, each a numpy array of shape (rows,)."""

    def __init__(self, columns: Mapping[str, Any]) -> None:
        self._columns = dict(columns)

    def __getitem__(self, name: str) -> numpy.ndarray:
        return self._columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        """How many columns there are."""
        return len(self._columns)

    @property
    def rows(self) -> int:
        """How many rows there are."""
        return len(next(iter(self._columns.values()), ()))

    def to_pandas(self):
        """The same as a pandas.DataFrame; pandas is needed: pip install 'palmistry[tables]'."""
        import pandas

        return pandas.DataFrame(self._columns)

    def to_arrow(self):
        """The same as a pyarrow.Table; pyarrow is needed: pip install 'palmistry[tables]'."""
        import pyarrow

        return pyarrow.table(self._columns)

    def __str__(self) -> str:
        """The first rows, a line each, columns aligned."""
        most = 40
        cells = [[name, *(_told(value) for value in column[:most])] for name, column in self._columns.items()]
        widths = [max(map(len, column)) for column in cells]
        lines = ["  ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip() for row in zip(*cells)]
        return "\n".join(lines + ([f"... {self.rows} rows"] if self.rows > most else []))

    def __repr__(self) -> str:
        return f"<table of {self.rows} rows: {', '.join(self._columns)}>"

    def _repr_html_(self) -> str:
        from html import escape

        first = range(min(self.rows, 10))
        heads = "".join(f"<th>{escape(name)}</th>" for name in self._columns)
        body = "".join("<tr>" + "".join(f"<td>{escape(str(column[i]))}</td>" for column in self._columns.values()) + "</tr>" for i in first)
        more = f"<p>{self.rows} rows</p>" if self.rows > len(first) else ""
        return f"<table><thead><tr>{heads}</tr></thead><tbody>{body}</tbody></table>{more}"


def _told(value: Any) -> str:
    """A cell as text: a float to six digits."""
    return f"{value:.6g}" if isinstance(value, float) or getattr(getattr(value, "dtype", None), "kind", "") == "f" else str(value)
