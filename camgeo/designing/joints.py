"""Handles of the motion plan: its joints, and the points that motions by data go through."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal, localcontext
from typing import Any, Final

from camgeo.designing.grips import Moves
from camgeo.designing.snapping import snapped, step_near, styled
from camgeo.designing.spans import Neighbours, joints, least_span, span_key, span_of, spans_of
from camgeo.motion.spans import EXACT
from camgeo.scene.keys import spelled

MOST: Final = 400
"""Handles of a plan; of a longer one only the first ones have any."""

Edits = Mapping[str, Any]


@dataclass(frozen=True, slots=True, eq=False)
class Pull:
    """A point of the motion plan that can be moved.

    Attributes
    ----------
    name, kind : its name, unique in the plan, and "joint" or "point".
    at : cam angle [degrees] and position [unit of the plan].
    moves : how it can be moved.
    keys : keys of the scene that it changes, with their names.
    edits : their values for a new place, from that place and the steps of both coordinates.
    """

    name: str
    kind: str
    at: tuple[float, float]
    moves: Moves
    keys: Mapping[str, str]
    edits: Callable[[tuple[float, float], tuple[float, float]], Edits]


def pulls(motion: list[dict[str, Any]], positions: Sequence[float]) -> Iterator[Pull]:
    """The movable points of a valid motion, from its segments as stated and where each starts.

    The first joint cannot move: the motion starts at 0.
    """
    spans = spans_of(motion)
    assert spans is not None  # it is valid
    at = list(joints(spans))
    last = max((k for k, each in enumerate(motion) if "dwell" not in each), default=-1)
    count = 0
    level: tuple[int, Any] | None = None
    for index, segment in enumerate(motion):
        if index and count < MOST and (spans[index - 1] or index == 1):
            joint = _joint(motion, index, at, level, last, positions[index])
            if joint is not None:
                count += 1
                yield joint
        for number in range(min(len(segment.get("points", ())), MOST - count)):
            count += 1
            yield _point(segment, index, number, at[index])
        if "dwell" not in segment:
            level = index, segment.get("to")


def _joint(
    motion: list[dict[str, Any]],
    index: int,
    at: list[Decimal],
    level: tuple[int, Any] | None,
    last: int,
    position: float,
) -> Pull | None:
    """The joint at which the segment `index` begins; None if it cannot move.

    `level` is the last segment before it that is not a dwell, with the position stated for its end;
    `position` is the value of that.
    """
    both = Neighbours(motion[index - 1], motion[index])
    mover, to = level if level is not None else (-1, 0)
    # A file says where a table ends; the last move has to return to 0.
    rises = to is not None and mover >= 0 and mover != last
    moves: Moves | None = ("y" if rises else None) if both.fixed else ("xy" if rises else "x")
    if moves is None:
        return None
    keys: dict[str, str] = {}
    span_place = spelled(("motion", index - 1, span_key(both.first)))
    other_place = spelled(("motion", index, span_key(both.second)))
    to_place = spelled(("motion", mover, "to"))
    if not both.fixed:
        keys[span_place] = f"span of segment {index}"
    if rises:
        keys[to_place] = "position"

    def edits(place: tuple[float, float], steps: tuple[float, float]) -> Edits:
        found: dict[str, Any] = {}
        if not both.fixed:
            new = _joint_at(place[0], steps[0], both, at[index - 1], at[index], at[index + 1])
            if new != at[index]:
                with localcontext(EXACT):
                    spans = both.with_first(new - at[index - 1])
                first, second = both.first[span_key(both.first)], both.second[span_key(both.second)]
                found[span_place] = styled(spans[0], first)
                found[other_place] = styled(spans[1], second)
        if rises:
            found[to_place] = snapped(place[1], steps[1], to)
        return found

    height = position if to is None else float(to)
    return Pull(f"joint {index + 1}", "joint", (float(at[index]), height), moves, keys, edits)


def _joint_at(
    angle: float, step: float, both: Neighbours, start: Decimal, now: Decimal, end: Decimal
) -> Decimal:
    """The cam angle of a joint that is dropped at `angle`, between `start` and `end` [degrees].

    No nearer to its neighbours than a step, unless it is now.
    """
    with localcontext(EXACT):
        by = step_near(step)
        low = min(start + max(least_span(both.first), by), now)
        high = max(end - max(least_span(both.second), by), now)
        new = Decimal(snapped(angle, step, now))
        return min(max(new, low), high)


def _point(segment: dict[str, Any], index: int, number: int, start: Decimal) -> Pull:
    """A point of a motion through points, between its neighbours."""
    points = segment["points"]
    own = points[number]
    span = span_of(segment)
    low = Decimal(points[number - 1]["at"]) if number else Decimal(0)
    high = Decimal(points[number + 1]["at"]) if number + 1 < len(points) else span
    assert high is not None  # it is valid
    place_of_at = spelled(("motion", index, "points", number, "at"))
    place_of_to = spelled(("motion", index, "points", number, "to"))

    def edits(place: tuple[float, float], steps: tuple[float, float]) -> Edits:
        now = Decimal(own["at"])
        with localcontext(EXACT):
            by = step_near(steps[0])
            new = Decimal(snapped(place[0] - float(start), steps[0], now))
            new = min(max(new, min(low + by, now)), max(high - by, now))
        found: dict[str, Any] = {} if new == now else {place_of_at: styled(new, own["at"])}
        found[place_of_to] = snapped(place[1], steps[1], own["to"])
        return found

    at = float(start + Decimal(own["at"])), float(own["to"])
    keys = {place_of_at: "cam angle in the segment", place_of_to: "position"}
    return Pull(f"point {index + 1}.{number + 1}", "point", at, "xy", keys, edits)
