"""The motion plan as rows: each segment with its fields, for right scenes and wrong ones."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any, Final

from camgeo.designing.fields import Field, Fields, plain
from camgeo.designing.spans import joints, span_of
from camgeo.motion.laws import ALIASES, FAMILIES
from camgeo.motion.planning.request import AUTO
from camgeo.scene.document import Document
from camgeo.scene.rules import JERK, parameters_of
from camgeo.scene.schema import SHAPES

MOST: Final = 400
"""Segments of a plan that are shown."""

DATA: Final = ("points", "table")
"""Laws by data, which are kinds of segments of their own."""

OPTIMISE: Final = "optimise"
"""Key of what law "auto" minimizes."""


@dataclass(frozen=True, slots=True)
class Row:
    """A segment.

    Attributes
    ----------
    index : its position, from 0.
    kind : "dwell", "move", "points" or "table".
    begin, end : cam angles [degrees]; None after a segment whose span is not valid.
    start, to : positions [unit of the plan] at its start and end; None if a file decides.
    law : None of a dwell.
    fields : its keys.
    """

    index: int
    kind: str
    begin: float | None
    end: float | None
    start: float | None
    to: float | None
    law: str | None
    fields: tuple[Field, ...]

    def to_data(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "index": self.index,
            "kind": self.kind,
            "from": self.begin,
            "to": self.end,
            "start": self.start,
            "end": self.to,
            "law": self.law,
            "fields": [each.to_data() for each in self.fields],
        }


def _fitting(fields: Iterable[Field], law: Any) -> Iterator[Field]:
    """The fields that the law takes, and those that are stated although it does not."""
    known = isinstance(law, str) and (law in FAMILIES or law in ALIASES or law == AUTO)
    taken = parameters_of(law) if known else frozenset(SHAPES)
    for each in fields:
        key = each.key.rpartition(".")[2]
        idle = (key in (*SHAPES, JERK) and key not in taken) or (key == OPTIMISE and law != AUTO)
        if each.stated or not idle:
            yield each


def plan(document: Document) -> tuple[Row, ...]:
    """The segments of a scene; none if its motion is no list."""
    motion = document.at(("motion",))
    if not isinstance(motion, list):
        return ()
    fields = Fields(document)
    node = fields.node(("motion",)).get("items", {})
    spans = []
    for each in motion[:MOST]:
        span = span_of(each)
        if span is None:
            break
        spans.append(span)
    angles = [float(each) for each in joints(spans)]
    rows = []
    position: float | None = 0.0
    for index, segment in enumerate(motion[:MOST]):
        table = segment if isinstance(segment, dict) else {}
        law = table.get("law")
        rests = "dwell" in table
        start = position
        if not rests:
            to = plain(table.get("to"))
            position = to if isinstance(to, int | float) else None
        rows.append(
            Row(
                index,
                "dwell" if rests else law if law in DATA else "move",
                angles[index] if index < len(angles) else None,
                angles[index + 1] if index + 1 < len(angles) else None,
                start,
                position,
                law if isinstance(law, str) and not rests else None,
                tuple(_fitting(fields.of_table(("motion", index), node), law)),
            )
        )
    return tuple(rows)
