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

    def __repr__(self) -> str:
        return f"<table of {self.rows} rows: {', '.join(self._columns)}>"

    def _repr_html_(self) -> str:
        from html import escape

        first = range(min(self.rows, 10))
        heads = "".join(f"<th>{escape(name)}</th>" for name in self._columns)
        body = "".join("<tr>" + "".join(f"<td>{escape(str(column[i]))}</td>" for column in self._columns.values()) + "</tr>" for i in first)
        more = f"<p>{self.rows} rows</p>" if self.rows > len(first) else ""
        return f"<table><thead><tr>{heads}</tr></thead><tbody>{body}</tbody></table>{more}"
