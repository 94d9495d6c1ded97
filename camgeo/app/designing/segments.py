"""Changes of a motion's segments: inserted, removed, split, moved, made a dwell or a move.

The sum of the spans always stays exactly what it was.
"""

from __future__ import annotations

import math
import pathlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from decimal import ROUND_FLOOR, ROUND_HALF_EVEN, Decimal, localcontext
from functools import cached_property
from typing import Any, Final, TypeGuard

from camgeo.design.design import Design
from camgeo.errors import CamgeoError, Fault, GeometryError, SceneError
from camgeo.kinematics.plan import EXACT, FULL_TURN, SHORTEST_SPAN
from camgeo.scene.keys import KeyPath, path_of, spelled
from camgeo.scene.scene import Scene
from camgeo.scene.values import Source, Tree, document_of_tree, without

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


# -- spans ----------------------------------------------------------------------------------------
# Spans of a motion's segments: exact sums, and changes that leave the turn whole.


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


# -- snapping -------------------------------------------------------------------------------------
# Dragged values: rounded to decimal steps, and left alone where they hardly change.


FINEST: Final = 1e-6
"""Step if none is stated [unit of the scene, degrees]."""

STEPS: Final = (1e-9, 1e6)
"""Least and greatest step."""

FEW: Final = 3
"""Significant digits of a value that is made for a scene."""

DIGITS: Final = 60
"""Digits with which a value is rounded: more than the largest number has in the least steps."""

LARGEST: Final = 10**12
"""Magnitude of the numbers of a scene."""


def is_number(value: Any) -> TypeGuard[int | Decimal]:
    """Whether a value of a scene, right or wrong, is a finite number that a scene can have."""
    real = isinstance(value, int | Decimal) and not isinstance(value, bool)
    return real and Decimal(value).is_finite() and -LARGEST <= value <= LARGEST


def step_near(step: float) -> Decimal:
    """The greatest power of ten, or 2 or 5 times one, that does not exceed `step`."""
    step = min(max(step, STEPS[0]), STEPS[1])
    exponent = math.floor(math.log10(step * (1.0 + 1e-12)))
    digits = step / 10.0**exponent * (1.0 + 1e-12)
    return Decimal(max(each for each in (1, 2, 5) if each <= digits)).scaleb(exponent)


def snapped(value: float, step: float, before: Any = None) -> Any:
    """`value` rounded to a step of at most `step`, as a number of a scene.

    It is `before`, the number that was there, if that is within half a step of it. A whole number
    is an integer unless `before` was written as a decimal number.
    """
    by = step_near(step)
    if before is not None and abs(value - float(before)) <= 0.5 * float(by):
        return before
    with localcontext() as context:
        context.prec = DIGITS
        steps = (Decimal(value) / by).quantize(Decimal(1), ROUND_HALF_EVEN)
        return styled(steps * by, before)


def styled(value: Decimal, before: Any) -> Any:
    """An exact number, as it is written to replace `before`."""
    if not value:
        value = Decimal(0)  # and not -0
    if value == value.to_integral_value() and not isinstance(before, Decimal):
        return int(value)
    plain = value.normalize()
    return plain.quantize(Decimal(1)) if plain == plain.to_integral_value() else plain


def rounded(value: Decimal) -> Any:
    """A number with few digits."""
    if not value:
        return 0
    last = Decimal(1).scaleb(value.adjusted() + 1 - FEW)
    return styled(value.quantize(last, ROUND_HALF_EVEN), 0)


# -- given ----------------------------------------------------------------------------------------
# What a change starts from, and the scenes that are tried in making it.


ROUNDS: Final = 6
"""How often keys are taken out: without some, others turn out not to belong."""


@dataclass(frozen=True)
class Given:
    """A text to be changed.

    Attributes
    ----------
    text : TOML.
    tree : its values.
    file, folder : where it comes from.
    known : its design, if there is one already.
    """

    text: str
    tree: Tree
    file: str
    folder: str | pathlib.Path | None
    known: Design | None

    @cached_property
    def source(self) -> Source:
        """Where the files lie that the scene names."""
        return Source.of(self.file, self.folder, self.text)

    @cached_property
    def design(self) -> Design:
        """Its design; SceneError if the scene is not valid."""
        return self.known or Design(self.scene(self.tree))

    def scene(self, tree: Tree) -> Scene:
        """The scene with other values; SceneError if they are not valid."""
        earlier = None if self.known is None else self.known.scene
        return Scene.of(document_of_tree(tree), self.source, earlier)

    def faults(self, tree: Tree) -> tuple[Fault, ...]:
        """What is wrong with other values."""
        try:
            self.scene(tree)
        except SceneError as error:
            return error.faults
        return ()

    @cached_property
    def wrong(self) -> frozenset[str]:
        """The keys at fault in the text as it is."""
        return frozenset(fault.key for fault in self.faults(self.tree))

    def new_faults(self, tree: Tree) -> tuple[Fault, ...]:
        """What is wrong with other values, at keys that are not `wrong` as it is."""
        return tuple(fault for fault in self.faults(tree) if fault.key not in self.wrong)

    def unmet(self, tree: Tree, name: str) -> Fault | None:
        """What the effect `name` lacks in a scene with other values, where only computing it tells.

        None as well if the text as it is has no design: then nothing can be computed.
        """
        if self.known is None:
            return None
        try:
            Design(self.scene(tree)).effect(name)
        except GeometryError as error:
            return Fault(error.key, error.value, error.message) if error.key else None
        except CamgeoError:  # faults of the scene, or no answer for this design, as findings tell
            return None
        return None

    def without_misfits(self, tree: Tree, may: Callable[[KeyPath], bool]) -> Tree:
        """The tree without those of the `new_faults` that may be taken out.

        Some only turn out to be at fault when others are gone.
        """
        for _ in range(ROUNDS):
            paths = {path_of(fault.key) or () for fault in self.new_faults(tree)}
            misfits = [path for path in paths if path and may(path)]
            if not misfits:
                break
            for path in sorted(misfits, key=len, reverse=True):
                tree = without(tree, path)
        return tree


def refusal(message: str, key: str = "") -> SceneError:
    """A change that cannot be made, and why."""
    return SceneError([Fault(key, "", message)])
