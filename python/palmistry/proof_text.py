"""A system in parts as the text of a proof file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from .terms import Term


@dataclass
class Model:
    """What a proof file declares; all names are names of the language."""

    title: str
    states: list[str]
    #: Constants with their values, None where they have none.
    parameters: dict[str, Term | None] = field(default_factory=dict)
    unknown: set[str] = field(default_factory=set)
    #: Signals that are known.
    signals: list[str] = field(default_factory=list)
    angles: list[str] = field(default_factory=list)
    #: Abbreviations, each above its use.
    definitions: list[tuple[str, Term]] = field(default_factory=list)
    #: The role, the name, and the rates of the states in their order.
    fields: list[tuple[str, str, list[Term]]] = field(default_factory=list)
    outputs: list[Term] = field(default_factory=list)
    sample: dict[str, tuple[Term, Term]] = field(default_factory=dict)
    claims: Mapping[str, str] = field(default_factory=dict)

    def text(self) -> str:
        """The file."""
        title = " ".join(self.title.replace('"', "'").split())
        lines = [f'system "{title}"', "", f"state {', '.join(self.states)}"]
        for name, value in self.parameters.items():
            given = "" if value is None else f" = {value.text}"
            lines.append(f"param {name}{given}{' unknown' if name in self.unknown else ''}")
        lines += [f"known {name}(t)" for name in self.signals]
        if self.angles:
            lines.append(f"angle {', '.join(self.angles)}")
        if self.definitions:
            lines.append("")
        lines += [f"let {name} = {term.text}" for name, term in self.definitions]
        for role, name, rates in self.fields:
            lines += ["", f"{role} {name}"]
            width = max(len(state) for state in self.states) + 1
            lines += [f"  {state + chr(39):<{width}} = {rate.text}" for state, rate in zip(self.states, rates)]
        lines += ["", *(f"output {term.text}" for term in self.outputs)]
        if self.sample:
            lines += ["", "sample", *(f"  {name} in [{low.text}, {high.text}]" for name, (low, high) in self.sample.items())]
        if self.claims:
            lines += ["", *(f"claim {id}: {statement}" for id, statement in self.claims.items())]
        return "\n".join(lines) + "\n"
