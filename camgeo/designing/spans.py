"""Spans of a motion's segments: exact sums, and changes that leave the turn whole."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal, localcontext
from typing import Any

from camgeo.designing.snapping import is_number
from camgeo.errors import GeometryError
from camgeo.motion.spans import EXACT, FULL_TURN, SHORTEST_SPAN

Segment = Mapping[str, Any]
"""A segment of a scene, as it is stated."""


def span_key(segment: Segment) -> str:
    """The key of its span."""
    return "dwell" if "dwell" in segment else "span"


def span_of(segment: Any) -> Decimal | None:
    """Its span [degrees], exactly as written; None if it has no possible one."""
    found = segment.get(span_key(segment)) if isinstance(segment, dict) else None
    return Decimal(found) if is_number(found) and 0 <= found <= FULL_TURN else None


def spans_of(motion: Any) -> list[Decimal] | None:
    """The spans of all segments; None if one of them has none."""
    if not isinstance(motion, list):
        return None
    found = [span_of(each) for each in motion]
    spans = [each for each in found if each is not None]
    return spans if len(spans) == len(found) else None


def total(spans: Sequence[Decimal]) -> Decimal:
    """Their exact sum."""
    with localcontext(EXACT):
        return sum(spans, Decimal(0))


def joints(spans: Sequence[Decimal]) -> Iterator[Decimal]:
    """The cam angles at which segments begin, and that of the end."""
    with localcontext(EXACT):
        at = [Decimal(0)]
        for span in spans:
            at.append(at[-1] + span)
    yield from at


def least_span(segment: Segment) -> Decimal:
    """The shortest span that the segment may have, judged by its own values."""
    if "dwell" in segment:
        return Decimal(0)
    points = segment.get("points")
    last = points[-1].get("at") if isinstance(points, list) and points else None
    return SHORTEST_SPAN if last is None else Decimal(last) + SHORTEST_SPAN


def is_fixed(segment: Segment) -> bool:
    """Whether a file decides its span."""
    return segment.get("law") == "table"


@dataclass(frozen=True, slots=True)
class Neighbours:
    """Two neighbouring segments, whose spans have a fixed sum.

    Attributes
    ----------
    first, second : the segments.
    """

    first: Segment
    second: Segment

    @property
    def fixed(self) -> bool:
        """Whether the joint between them cannot move."""
        return is_fixed(self.first) or is_fixed(self.second)

    def with_first(self, span: Decimal) -> tuple[Decimal, Decimal]:
        """The spans of both if that of the first is `span`; GeometryError if one has no room."""
        before = span_of(self.first), span_of(self.second)
        assert before[0] is not None  # only valid scenes have handles
        assert before[1] is not None
        with localcontext(EXACT):
            other = before[1] - (span - before[0])
        for segment, new, name in (
            (self.first, span, "this segment"),
            (self.second, other, "the one beside it"),
        ):
            if new < least_span(segment):
                message = f"leaves no room for {name}: {new.normalize():f} degrees"
                raise GeometryError(message, "motion", f"{new.normalize():f}")
        return span, other
