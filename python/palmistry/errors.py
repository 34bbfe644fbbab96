"""What can be wrong with what was asked, with its place where it has one."""

from __future__ import annotations


class Error(ValueError):
    """Input that cannot be used.

    message: what is wrong. help: what to do about it, or None.
    """

    def __init__(self, message: str, help: str | None = None) -> None:
        super().__init__(message)
        self.message = message
        self.help = help

    def __str__(self) -> str:
        return self.message if self.help is None else f"{self.message}\nhelp: {self.help}"

    def __reduce__(self):
        # exceptions cross processes, as those of a cluster
        return (_again, (type(self), dict(self.__dict__)))


class ReadError(Error):
    """A text that cannot be read: a proof file, an expression, a scene.

    file: its name. line, column: the place, in characters, both counted from one. text: that line. marked: what is marked in it.
    label: what stands there, in words. code: as E201; `palmistry explain E201` has an example.
    """

    def __init__(
        self,
        message: str,
        help: str | None = None,
        file: str = "",
        line: int = 1,
        column: int = 1,
        text: str = "",
        marked: str = "",
        label: str = "",
        code: str = "",
    ) -> None:
        super().__init__(message, help)
        self.file = file
        self.line = line
        self.column = column
        self.text = text
        self.marked = marked
        self.label = label
        self.code = code

    def __str__(self) -> str:
        lines = [f"{self.file}:{self.line}:{self.column}: {self.message}"]
        if self.text:
            number = str(self.line)
            # a tab stays a tab, so that the mark stands below what it marks
            before = "".join("\t" if c == "\t" else " " for c in self.text[: self.column - 1])
            width = max(1, len(self.marked.split("\n")[0]))
            lines.append(f" {number} | {self.text}")
            lines.append(f" {' ' * len(number)} | {before}{'^' * width} {self.label}".rstrip())
        if self.help is not None:
            lines.append(f"help: {self.help}")
        return "\n".join(lines)


class EvaluationError(Error):
    """An expression that has no value at a point: the point is a singularity, outside of a domain, or lacks a value."""


def _again(kind, fields):
    """The same exception in another process."""
    error = kind.__new__(kind)
    ValueError.__init__(error, fields["message"])
    error.__dict__.update(fields)
    return error
