"""The features of a part compared with the operations that make them, on one side or two."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from camgeo.check.finding import Finding, Severity
from camgeo.milling.bench import BORE, SAME
from camgeo.milling.cut import ContourCut, Cut
from camgeo.milling.judged import Side, faces, finished_by, is_finished
from camgeo.milling.milling import Stock
from camgeo.milling.simulation import ALLOWED
from camgeo.part.boundaries import ExactBoundary
from camgeo.part.part import Bevel, Part, Wall
from camgeo.part.spec import Keyway, text_of

CHAMFERS = "chamfers"
LEFT_OUT = "left-out"
KEYWAY = "keyway"
UNLIKE_THE_PART = "unlike-the-part"
"""Names of findings on features that no operation makes, and on those that one makes otherwise."""

UNMADE = "no operation makes it"

EDGE = " edge of the "
"""In the name of an edge, before that of its wall."""


@dataclass(frozen=True, slots=True)
class Feature:
    """A feature of the part, and what makes it.

    Attributes
    ----------
    name : "outline", "bolt hole 1", "upper edge of the outline".
    finding : name of the finding where it is not made as the part states.
    operations : that make it, or touch it if none finishes it.
    severity : "ok" if it is made, or there is nothing to be done; "broken" if more is taken off
        than the part states.
    difference : between part and operations, or who else makes it; empty if they make it.
    stated, made : width of a chamfer, or what is to be left and is left [mm]; None elsewhere.
    """

    name: str
    finding: str
    operations: tuple[str, ...] = ()
    severity: Severity = "ok"
    difference: str = ""
    stated: float | None = None
    made: float | None = None

    @property
    def edge_of(self) -> str:
        """Name of the wall of which it is an edge; empty of anything else."""
        return self.name.partition(EDGE)[2]

    @property
    def sentence(self) -> str:
        """In words, with the operations."""
        by = ", ".join(self.operations)
        return f"{self.name}: {'; '.join(each for each in (by, self.difference) if each)}"


def features_of(part: Part, keyway: Keyway | None, sides: Sequence[Side]) -> tuple[Feature, ...]:
    """Every wall, edge and face of a part, as the sides of its job make them.

    Parameters
    ----------
    part : with its chamfers.
    keyway : of its bore; None without one.
    sides : the first one, from above, and perhaps a second.
    """
    found: dict[str, Feature] = {}
    for wall in sides[0].part.walls:
        feature = _wall(wall, sides)
        if feature.name not in found or found[feature.name].severity == "ok":
            found[feature.name] = feature
    return (
        *_faces(sides),
        *found.values(),
        *(_keyway(keyway) if keyway is not None and BORE in found else ()),
        *_edges(part, sides),
    )


def findings_of(features: Iterable[Feature]) -> Iterator[Finding]:
    """What is told of features that are not made as the part states; those that no operation makes
    in one sentence.
    """
    features = tuple(features)
    unmade = [each for each in features if each.difference == UNMADE and each.severity != "ok"]
    walls = [each.name for each in unmade if each.finding == LEFT_OUT]
    if walls:
        yield Finding(LEFT_OUT, "warning", f"no operation makes {', '.join(walls)}")
    if any(each.edge_of for each in unmade):
        others = {each.edge_of for each in features if each.edge_of and each not in unmade}
        named = (each.name if each.edge_of in others else each.edge_of for each in unmade)
        listed = ", ".join(dict.fromkeys(name for name in named if name))
        yield Finding(CHAMFERS, "warning", f"no operation makes the chamfers of {listed}")
    for each in features:
        if each.severity != "ok" and each not in unmade:
            yield Finding(
                each.finding, each.severity, each.sentence, each.made, each.stated,
                "" if each.made is None else "mm",
            )  # fmt: skip


def _faces(sides: Sequence[Side]) -> Iterator[Feature]:
    """The face that lies up, and the one below."""
    stock = sides[0].milling.stock
    for name, more, own in (
        ("upper face", stock.top, sides[:1]),
        ("lower face", stock.bottom, sides[1:]),
    ):
        cuts = [cut.name for side in own for cut in side.cuts if faces(cut)]
        if not more:
            yield Feature(name, LEFT_OUT, difference="that of the blank")
        elif cuts:
            yield Feature(name, LEFT_OUT, tuple(cuts))
        else:
            text = f"no operation takes off {more:g} mm of the blank"
            yield Feature(name, UNLIKE_THE_PART, (), "warning", text, 0.0, more)


def _wall(wall: Wall, sides: Sequence[Side]) -> Feature:
    name = wall.boundary.name
    cuts = [cut for side in sides for cut in side.cuts if name in cut.produced]
    made = tuple(cut.name for cut in cuts if name in finished_by(cut))
    called = text_of(name) or name
    stated = any(side.milling.operations for side in sides)
    severity: Severity = "warning" if stated else "ok"
    if is_finished(wall, sides):
        return Feature(called, LEFT_OUT, made)
    if made:
        return Feature(called, UNLIKE_THE_PART, made, severity, "not all of its height is finished")
    if cuts:
        left = min(cut.allowance for cut in cuts)
        by = tuple(cut.name for cut in cuts)
        return Feature(
            called, UNLIKE_THE_PART, by, severity, f"{left:g} mm are left on it", 0.0, left
        )
    if _is_in_the_blank(wall, sides[0].part, sides[0].milling.stock):
        return Feature(called, LEFT_OUT, difference="the blank has it")
    return Feature(called, LEFT_OUT, (), severity, UNMADE)


def _is_in_the_blank(wall: Wall, part: Part, stock: Stock) -> bool:
    """Whether a bore or a rim is that of the blank; a rim is, unless the blank is another."""
    boundary = wall.boundary
    if not isinstance(boundary, ExactBoundary) or not boundary.is_round:
        return False
    diameter = 2.0 * boundary.round_radius
    there = stock.bore if boundary.name == BORE else stock.diameter
    if there is not None and not (boundary.name != BORE and stock.centre):
        return abs(there - diameter) <= SAME * diameter
    return boundary == part.outermost and stock.outline is None


def _keyway(keyway: Keyway) -> Iterator[Feature]:
    """A round cutter leaves it."""
    angle = math.degrees(keyway.angle)
    text = f"{keyway.width:g} mm wide at {angle:g} deg: no operation makes it, it is to be broached"
    yield Feature(KEYWAY, KEYWAY, (), "warning", text)


def _edges(part: Part, sides: Sequence[Side]) -> Iterator[Feature]:
    """The chamfers that the part states, and those that operations make beside them."""
    made: dict[tuple[str, bool], list[ContourCut]] = {}
    for upper, side in zip((True, False), sides, strict=False):
        for cut in side.cuts:
            if isinstance(cut, ContourCut) and cut.edge:
                made.setdefault((cut.edge, upper), []).append(cut)
    for bevel in part.bevels:
        yield _edge(bevel, made.pop((bevel.boundary.name, bevel.upper), []))
    for (name, upper), cuts in made.items():
        width = max(cut.width for cut in cuts)
        text = f"{width:g} mm wide, the part states a sharp edge"
        by = tuple(cut.name for cut in cuts)
        yield Feature(_called(name, upper=upper), CHAMFERS, by, "warning", text, 0.0, width)


def _edge(bevel: Bevel, cuts: Sequence[Cut]) -> Feature:
    """A chamfer of the part, with the cuts along its edge; a cone whose point has another angle
    makes it as wide on the face, and lower or higher on the wall.
    """
    name = _called(bevel.boundary.name, upper=bevel.upper)
    by = tuple(cut.name for cut in cuts)
    if not cuts:
        return Feature(name, CHAMFERS, (), "warning", UNMADE, bevel.width, 0.0)
    width = max(cut.width for cut in cuts if isinstance(cut, ContourCut))
    slope = max(cut.tool.tip_length / cut.tool.radius for cut in cuts)
    off = max(width - bevel.width, width * slope - bevel.height, key=abs)
    if abs(off) > ALLOWED:
        text = (
            f"{width:g} mm wide and {width * slope:.3g} mm high, the part states {bevel.width:g} mm"
            f" and {bevel.height:g} mm"
        )
        severity: Severity = "broken" if off > 0.0 else "warning"
        return Feature(name, CHAMFERS, by, severity, text, bevel.width, width)
    if bevel.boundary.corner_radius is not None:
        return Feature(
            name, CHAMFERS, by, "warning", "it is made along the circle alone", bevel.width, width
        )
    return Feature(name, CHAMFERS, by, stated=bevel.width, made=width)


def _called(name: str, *, upper: bool) -> str:
    return f"{'upper' if upper else 'lower'}{EDGE}{name}"
