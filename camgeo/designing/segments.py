"""Changes of a motion's segments: inserted, removed, split, moved, made a dwell or a move.

The sum of the spans always stays exactly what it was.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from decimal import ROUND_FLOOR, Decimal, localcontext
from typing import Any, Final

from camgeo.designing.given import Given, refusal
from camgeo.designing.snapping import is_number, styled
from camgeo.designing.spans import is_fixed, least_span, span_key, span_of
from camgeo.motion.spans import EXACT
from camgeo.scene.keys import spelled
from camgeo.scene.tree import Tree

LAW: Final = "polynomial-345"
"""Of a new move."""

FALLBACK: Final = "auto"
"""Law of moves that meet without a rest between them."""

RISE: Final = Decimal(10)
"""Position of a new move in a motion that has none [mm or degrees]."""

MOST: Final = 10_000
"""Segments of a motion."""

Motion = list[Any]


def changed_segments(given: Given, asked: Any) -> tuple[Tree, str]:
    """The tree with one change of a segment, and its label.

    `asked` has the `action`, one of `ACTIONS`, and `at`, the position of the segment, from 0.
    SceneError if it lacks one of these, or the action cannot be done.
    """
    action = asked.get("action") if isinstance(asked, Mapping) else None
    at = asked.get("at") if isinstance(asked, Mapping) else None
    motion = given.tree.get("motion")
    if not isinstance(action, str) or action not in ACTIONS:
        raise refusal(f"a segment is changed by one of {', '.join(ACTIONS)}", "motion")
    if not isinstance(motion, list) or not motion:
        raise refusal("there are no segments", "motion")
    if not isinstance(at, int) or isinstance(at, bool) or not 0 <= at < len(motion):
        raise refusal(f"segments are counted from 0 to {len(motion) - 1}", "motion")
    if span_of(motion[at]) is None:
        raise refusal("has no valid span", spelled(("motion", at)))
    make, label = ACTIONS[action]
    trees = [{**given.tree, "motion": each} for each in make(motion, at)]
    return _valid(given, trees), label.format(n=at + 1)


def _valid(given: Given, trees: list[Tree]) -> Tree:
    """The first tree that is valid; the first of all if none is, or if there is only one."""
    if len(trees) == 1:
        return trees[0]
    return next((tree for tree in trees if not given.faults(tree)), trees[0])


def _insert(motion: Motion, at: int) -> Iterator[Motion]:
    """A dwell after a segment; that one gives half of its span, or else the next one does."""
    donors = [each for each in (at, at + 1) if each < len(motion) and _can_give(motion[each])]
    if not donors or len(motion) >= MOST:
        raise refusal("has no span to give to a new segment", spelled(("motion", at)))
    kept, given = _halves(motion[donors[0]])
    made = [*motion]
    made[donors[0]] = _with_span(motion[donors[0]], kept)
    made.insert(at + 1, {"dwell": styled(given, 0)})
    yield made


def _remove(motion: Motion, at: int) -> Iterator[Motion]:
    """Its neighbour takes its span, a dwell first."""
    beside = [each for each in (at - 1, at + 1) if 0 <= each < len(motion)]
    takers = [each for each in beside if not is_fixed(motion[each])]
    takers = [each for each in takers if span_of(motion[each]) is not None]
    if not takers:
        raise refusal("no segment beside it can take its span", spelled(("motion", at)))
    taker = next((each for each in takers if "dwell" in motion[each]), takers[0])
    with localcontext(EXACT):
        whole = _span(motion[taker]) + _span(motion[at])
    made = [*motion]
    made[taker] = _with_span(motion[taker], whole)
    del made[at]
    yield from _returning(made)


def _split(motion: Motion, at: int) -> Iterator[Motion]:
    """Two halves; a move is halfway between them."""
    segment = motion[at]
    if "points" in segment or is_fixed(segment) or not _can_give(segment) or len(motion) >= MOST:
        raise refusal("cannot be split", spelled(("motion", at)))
    first, second = _halves(segment)
    halves = [_with_span(segment, first), _with_span(segment, second)]
    if "dwell" not in segment:
        way = {key: item for key, item in halves[0].items() if key in ("law", "span")}
        halves[0] = {**way, "to": _between(_level(motion, at), segment.get("to"))}
    yield [*motion[:at], *halves, *motion[at + 1 :]]
    if "dwell" not in segment:
        halves = [{**each, "law": FALLBACK} for each in halves]
        yield [*motion[:at], *halves, *motion[at + 1 :]]


def _swap(by: int) -> Callable[[Motion, int], Iterator[Motion]]:
    def swap(motion: Motion, at: int) -> Iterator[Motion]:
        if not 0 <= at + by < len(motion):
            raise refusal("is at the end of the motion", spelled(("motion", at)))
        made = [*motion]
        made[at], made[at + by] = motion[at + by], motion[at]
        yield made
        if all(_moves(each) and "to" in each for each in (made[at], made[at + by])):
            for each in (at, at + by):  # the positions stay, and law and span change places
                made[each] = {**made[each], "to": motion[each]["to"]}
            yield made

    return swap


def _to_dwell(motion: Motion, at: int) -> Iterator[Motion]:
    """A rest of the same span."""
    rest = {"dwell": motion[at][span_key(motion[at])]}
    yield from _returning([*motion[:at], rest, *motion[at + 1 :]])


def with_a_point(tree: Tree, at: int) -> Tree:
    """The tree with a point in the middle of a segment that goes through points but has none."""
    motion = tree["motion"]
    segment = motion[at]
    span = span_of(segment)
    if segment.get("law") != "points" or "points" in segment or not span:
        return tree
    point = {"at": styled(span / 2, 0), "to": _between(_level(motion, at), segment.get("to"))}
    return {**tree, "motion": [*motion[:at], {**segment, "points": [point]}, *motion[at + 1 :]]}


def _returning(motion: Motion) -> Iterator[Motion]:
    """The motion, and the same with a last move that returns to 0."""
    yield motion
    last = max((k for k, each in enumerate(motion) if _moves(each)), default=None)
    if last is not None and motion[last].get("to"):
        yield [*motion[:last], {**motion[last], "to": 0}, *motion[last + 1 :]]


def _to_move(motion: Motion, at: int) -> Iterator[Motion]:
    """A move of the same span; a dwell becomes a move halfway to the next position.

    After the last move, which returns to 0, it becomes a rise and a return.
    """
    segment = motion[at]
    before = motion[:at]
    after = motion[at + 1 :]
    span = segment[span_key(segment)]
    if "dwell" not in segment:
        yield [*before, {"law": LAW, "span": span, "to": _number(segment.get("to"))}, *after]
        return
    level = _level(motion, at)
    following = [_number(each.get("to")) for each in after if _moves(each)]
    if following:
        for law in (LAW, FALLBACK):
            end = _between(level, following[0])
            yield [*before, {"law": law, "span": span, "to": end}, *after]
        return
    if not _can_give(segment):
        raise refusal("is too short for a move", spelled(("motion", at)))
    first, second = _halves(segment)
    tops = [abs(Decimal(_number(each.get("to")))) for each in motion if _moves(each)]
    top = max([each for each in tops if each] or [RISE])
    up = {"law": LAW, "span": styled(first, 0), "to": styled(top, 0)}
    yield [*before, up, {"law": LAW, "span": styled(second, 0), "to": 0}, *after]


ACTIONS: Final[Mapping[str, tuple[Callable[[Motion, int], Iterator[Motion]], str]]] = {
    "insert": (_insert, "segment inserted after {n}"),
    "remove": (_remove, "segment {n} removed"),
    "split": (_split, "segment {n} split"),
    "up": (_swap(-1), "segment {n} moved up"),
    "down": (_swap(1), "segment {n} moved down"),
    "to-dwell": (_to_dwell, "segment {n} made a dwell"),
    "to-move": (_to_move, "segment {n} made a move"),
}
"""What can be done with a segment, with a label each: of the motions made, the first valid one is
taken."""


def _moves(segment: Any) -> bool:
    return isinstance(segment, dict) and "dwell" not in segment


def _span(segment: Any) -> Decimal:
    span = span_of(segment)
    assert span is not None  # it was asked
    return span


def _can_give(segment: Any) -> bool:
    """Whether a segment can give half of its span away."""
    span = span_of(segment)
    return (
        span is not None and not is_fixed(segment) and span > 0 and span / 2 > least_span(segment)
    )


def _halves(segment: Any) -> tuple[Decimal, Decimal]:
    """Its span in two, the second in whole degrees if it is long."""
    span = _span(segment)
    with localcontext(EXACT):
        second = span / 2
        if second > 1:
            second = second.quantize(Decimal(1), ROUND_FLOOR)
        return span - second, second


def _with_span(segment: Any, span: Decimal) -> Any:
    key = span_key(segment)
    return {**segment, key: styled(span, segment[key])}


def _level(motion: Motion, at: int) -> Any:
    """The position at the start of a segment, as it is stated."""
    ends = [each.get("to") for each in motion[:at] if _moves(each)]
    return _number(ends[-1]) if ends else 0


def _number(value: Any) -> Any:
    """A position; 0 in place of anything else."""
    return value if is_number(value) else 0


def _between(start: Any, end: Any) -> Any:
    """The position in the middle of two; one unit on if they are the same."""
    first, last = Decimal(_number(start)), Decimal(_number(end))
    middle = (first + last) / 2 if first != last else first + 1
    return styled(middle, end)
