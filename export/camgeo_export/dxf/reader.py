"""Reader of closed contours from any DXF drawing, whichever program wrote it.

It reads what a drawing shows: lines, arcs, circles, ellipses, polylines with bulges and splines, in
blocks too, on layers that are on; open pieces are chained at their end points. What closes nothing
is left, and told.
"""

from __future__ import annotations

import cmath
import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Final, NamedTuple

import numpy as np

from camgeo.errors import FileError
from camgeo.geometry.contour.foreign import Outlines, middle_of
from camgeo.geometry.contour.spline import Arc, CubicSpline, at
from camgeo.numeric.arrays import BoolArray, ComplexArray, IntArray
from camgeo.reading import CONTOURS, DRAWING, PLACED, beyond
from camgeo.units import MM_PER, LengthUnit, counted, place_text
from camgeo_export.dxf.items import (
    CURVES,
    NEAR,
    Curve,
    EntityError,
    Item,
    Items,
    Placement,
    Progress,
    Strand,
    Tag,
    closed,
    read_contents,
    strands_of,
)
from camgeo_export.reading import CUT, finite, of_the_part

MM_PER_INSUNIT: Final = {1: 25.4, 2: 304.8, 4: 1.0, 5: 10.0, 6: 1000.0}
"""Millimetres of the units that $INSUNITS names: inch, foot, mm, cm, m."""

DEFPOINTS: Final = "defpoints"
"""Layer of points that dimensions refer to, in lower case; it is never plotted."""

FROZEN: Final = 1
"""Bit of group 70 that marks a layer as frozen."""

PARTS: Final = ("ATTRIB", "ATTDEF", "ENDBLK", "SEQEND", "VERTEX", "VIEWPORT")
"""Entities that are no curves and of no interest."""

GAPS: Final = (0.0, 1e-9, 1e-7, 1e-5, 1e-3, 1e-1)
"""Gaps [mm] that are joined in turn: pieces may be shorter than the largest that is allowed."""

ALIKE: Final = 1e-6
NEARLY: Final = 1e-3
"""Contours lie on each other if their areas and lengths differ by less than the first fraction and
their middles by less than the second one, of a length and its square."""

DEEPEST: Final = 32
"""Blocks within blocks."""

EVERY: Final = 100_000
"""Entities after which progress is reported again."""

SHOWN: Final = 3
"""Of what is left for one reason, places that are named."""


def gaps_up_to(most: float) -> tuple[float, ...]:
    """The gaps [mm] to be tried, up to `most`."""
    return (*(gap for gap in GAPS if gap < most), most)


@dataclass(frozen=True, slots=True)
class Drawing:
    """A drawing that was read.

    Attributes
    ----------
    name : of the file, for messages.
    header : the header variables, each with its first value.
    items : the entities of the model space, in the order of the file.
    layers : the records of the layers.
    names : of the layers that entities are on, by their lower case, without which they are alike.
    blocks : record, with name and base point, and entities of each, by its name in lower case.
    """

    name: str
    header: Mapping[str, Tag]
    items: Items | tuple[Item, ...]
    layers: Items | tuple[Item, ...]
    names: Mapping[str, str] = field(default_factory=dict)
    blocks: Mapping[str, tuple[Item, Items]] = field(default_factory=dict)

    def value(self, variable: str) -> str:
        """The value of a header variable; empty if there is none."""
        return self.header[variable].value if variable in self.header else ""

    def scale(self, unit: LengthUnit | None = None) -> float:
        """Millimetres per drawing unit; `unit` is needed if the drawing does not state it.

        Raises FileError if it is unknown, or contradicts the drawing.
        """
        name, tag = self.name, self.header.get("$INSUNITS")
        code = 0 if tag is None else int(finite(tag.value, name, tag.line))
        if code == 0:
            if unit is None:
                message = "does not state its unit ($INSUNITS); give mm or inch (--unit)"
                raise FileError(f"{name}: {message}")
            return MM_PER[unit]
        if code not in MM_PER_INSUNIT:
            raise FileError(f"{name}: $INSUNITS is {code}; supported: inch, foot, mm, cm and m")
        if unit is not None and MM_PER[unit] != MM_PER_INSUNIT[code]:
            raise FileError(f"{name}: $INSUNITS is {code}, which is not {unit}")
        return MM_PER_INSUNIT[code]

    def contours(self, layer: str | None, gap: float = 0.0) -> tuple[Curve, ...]:
        """The closed contours [mm] of a drawing in which all must be part of one, as `outlines`.

        Raises FileError as that does, and for the first entity that is part of none.
        """
        return self.outlines(layer, gaps=(gap,), strict=True).contours

    def outlines(
        self,
        layer: str | None,
        unit: LengthUnit | None = None,
        gaps: Sequence[float] = (0.0,),
        *,
        strict: bool = False,
        progress: Progress = lambda _: None,
    ) -> Outlines:
        """The closed contours [mm], counter-clockwise, the largest first, and what is left.

        A contour without splines consists of lines and arcs. Where two ends lie apart, one is moved
        to the other: that of an arc or line to that of a spline.

        Parameters
        ----------
        layer : whose entities are read; None for layer CUT and those of edges that do not go
            through, if CUT exists, else for all.
        unit : of the drawing, needed if the drawing does not state it.
        gaps : end points up to this far apart [mm] are joined, by that of these with which the
            least is left, the smallest of such; 0 for rounding only.
        strict : whether what is left is an error.

        Raises
        ------
        FileError
            With name and line, if the unit is unknown, a number is none, or there is no contour.
        """
        shown = _Shown(self, self._wanted(layer), progress)
        runs = list(shown.runs(Placement(complex(self.scale(unit)))))
        ends = [(run.pieces[-1].end, run.pieces[0].start) for run in runs]
        open_runs = [run for run, (end, start) in zip(runs, ends, strict=True) if end != start]
        loops, left = chained(open_runs, gaps[0])
        for gap in gaps[1:]:
            if all(each.why == DOUBLE for each in left):
                break
            progress(f"{self.name}, pieces joined with gaps up to {gap:g} mm")
            found = chained(open_runs, gap)
            loops, left = found if len(found[1]) < len(left) else (loops, left)
        whole = (run for run, (end, start) in zip(runs, ends, strict=True) if end == start)
        loops = [(list(run.pieces), [run]) for run in whole] + loops
        if len(loops) > CONTOURS:
            raise beyond(self.name, counted(len(loops), "closed contour"), CONTOURS, DRAWING)
        contours, others = _contours(loops, doubles=strict)
        left = sorted([*left, *others], key=lambda each: each.why == DOUBLE)
        reasons = [str(error) for error in shown.faults]
        reasons += [self._fault(each, gaps[-1]) for each in left[:1]]
        notes = tuple(shown.notes(runs, left))
        if reasons and (strict or not contours):
            raise FileError(reasons[0])
        if not contours:
            own = [note.removeprefix(f"{self.name}: ") for note in notes]
            told = "; ".join(own) or f"supported: {', '.join(CURVES)}, INSERT"
            raise FileError(f"{self.name}: no contour found; {told}")
        gap = max(
            abs(before.end - piece.start)
            for pieces, _ in loops
            for before, piece in zip([pieces[-1], *pieces], pieces, strict=False)
        )
        followed = 0.0 if all(run.exact for run in runs) else NEAR
        loose = reasons[-1] if left and left[0].why == LOOSE else ""
        return Outlines(tuple(contours), gap, notes, followed, loose)

    def on(self, layer: str | None) -> Iterator[Item]:
        """The curves that are shown on a layer; see `outlines`."""
        shown = _Shown(self, self._wanted(layer))
        return (item for item, _ in shown.placed(Placement()) if item.kind in CURVES)

    def _wanted(self, layer: str | None) -> set[str]:
        """The layers that are read, in lower case; all if there is none."""
        if layer is not None and layer.lower() not in self.names:
            known = ", ".join(sorted(self.names.values()))
            raise FileError(f"{self.name}: has no layer {layer!r}; there are {known}")
        if layer is not None or CUT.lower() not in self.names:
            return set() if layer is None else {layer.lower()}
        return {name.lower() for name in of_the_part(map(str.upper, self.names))}

    def _fault(self, left: Left, gap: float) -> str:
        """What is wrong with a run that is part of no contour."""
        run, place, why = left
        rest = f"; pieces must form closed contours, with gaps of at most {gap:g} mm"
        where = f"{why} at {place_text(place)}{rest if why in (LOOSE, BRANCH) else ''}"
        return f"{self.name}, line {run.line}: {run.kind} {where}"


@dataclass(slots=True)
class _Shown:
    """What is shown of a drawing on the layers `wanted`, and a count of what is not.

    Attributes
    ----------
    off : layers that are not shown, in lower case.
    hidden, unread : how many entities of which layer, of which kind are not shown, not read.
    faults : of entities that cannot be used.
    count : of entities in blocks.
    """

    drawing: Drawing
    wanted: set[str]
    progress: Progress = lambda _: None
    off: frozenset[str] = field(init=False)
    hidden: Counter[str] = field(default_factory=Counter)
    unread: Counter[str] = field(default_factory=Counter)
    faults: list[EntityError] = field(default_factory=list)
    count: int = 0

    def __post_init__(self) -> None:
        records = filter(_is_off, self.drawing.layers)
        self.off = frozenset(record.text(2).lower() for record in records)

    def runs(self, place: Placement) -> Iterator[Run]:
        """The curves, as far as they have any length, where `place` puts them."""
        for number, (item, inner) in enumerate(self.placed(place)):
            if not number % EVERY:
                self.progress(f"{self.drawing.name}, {number:,} entities taken")
            if item.kind not in CURVES:
                self.unread[item.kind] += item.kind not in PARTS
                continue
            try:
                pieces, exact = strands_of(item, inner)
            except EntityError as error:
                self.faults.append(error)
                continue
            if pieces:
                yield Run(item.kind, item.line, pieces, exact)

    def placed(
        self,
        place: Placement,
        items: Iterable[Item] | None = None,
        layer: str | None = None,
        within: tuple[str, ...] = (),
    ) -> Iterator[tuple[Item, Placement]]:
        """The entities that are shown with their places, those of blocks in place of these.

        `layer` is that of the insertion of the block with the `items`, `within` names all around.
        """
        for item in self.drawing.items if items is None else items:
            own = item.layer.lower()
            own = layer if layer is not None and own == "0" else own
            if own in self.off or own == DEFPOINTS or item.number(60, 0.0) == 1.0:
                self.hidden[self.drawing.names.get(own, own)] += 1
            elif item.kind == "INSERT":
                yield from self._inserted(item, place, own, within)
            elif not self.wanted or own in self.wanted:
                yield item, place

    def _inserted(
        self, item: Item, place: Placement, layer: str, within: tuple[str, ...]
    ) -> Iterator[tuple[Item, Placement]]:
        """The entities of the block that `item` inserts, once or in rows and columns."""
        name = item.text(2).lower()
        record, items = self.drawing.blocks.get(name, (None, ()))
        if record is None or name in within or len(within) == DEEPEST:
            what = "that is not there" if record is None else "into itself, or too deeply"
            self.faults.append(item.fault(f"inserts a block {what}: {item.text(2)[:60]!r}"))
            return
        x, y = item.number(41, 1.0), item.number(42, 1.0)
        turn = cmath.rect(1.0, math.radians(item.number(50, 0.0)))
        base = Placement(shift=-record.point(10, 0.0))
        columns, rows = (max(1, int(item.number(code, 1.0))) for code in (70, 71))
        for row, column in (divmod(number, columns) for number in range(columns * rows)):
            step = complex(column * item.number(44, 0.0), row * item.number(45, 0.0))
            corner = item.point(10) + turn * step
            own = Placement(turn * (0.5 * (x + y)), turn * (0.5 * (x - y)), corner).after(base)
            for each in self.placed(place.seen(item).after(own), items, layer, (*within, name)):
                yield each
                self.count += 1
            self.count += 1
            if self.count > PLACED:
                found = counted(self.count, "entity", "entities")
                raise beyond(self.drawing.name, f"{found} in blocks", PLACED, DRAWING)

    def notes(self, runs: Sequence[Run], left: Sequence[Left]) -> Iterator[str]:
        """What is not shown, not read, cannot be used, is left or not exact."""
        name = self.drawing.name
        if self.hidden:
            count = counted(self.hidden.total(), "entity", "entities")
            layers = ", ".join(sorted(self.hidden))
            yield f"{name}: {count} not read that the drawing does not show, on layer {layers}"
        if kinds := +self.unread:
            yield f"{name}: not read: {_listed(kinds)}"
        yield from (f"{error}; left out" for error in self.faults[:SHOWN])
        for why in (LOOSE, BRANCH, DOUBLE, EMPTY):
            each = [one for one in left if one.why == why]
            places = [
                f"{r.kind} in line {r.line} {why} at {place_text(z)}" for r, z, _ in each[:SHOWN]
            ]
            if each:
                count = f"{counted(len(each), 'piece')} left out"
                yield f"{name}: {count}: {'; '.join(places)}{'; ...' * (len(each) > SHOWN)}"
        if kinds := Counter(run.kind for run in runs if not run.exact):
            yield f"{name}: {_listed(kinds)} followed by cubics within {NEAR:g} mm"


def _is_off(record: Item) -> bool:
    return record.number(62, 7.0) < 0.0 or int(record.number(70, 0.0)) & FROZEN != 0


def _listed(kinds: Counter[str]) -> str:
    return ", ".join(f"{count} {kind}" for kind, count in kinds.most_common())


def _contours(loops: Sequence[Loop], *, doubles: bool) -> tuple[list[Curve], list[Left]]:
    """The contours of closed chains, the largest first, each once unless `doubles` count too, and
    the runs of the others.
    """
    left = []
    found: list[tuple[Curve, Loop]] = []
    for pieces, runs in loops:
        single = len(pieces) < 2 and isinstance(pieces[0], Arc)
        if single or (contour := closed(pieces)).area == 0.0:
            left.append(Left(runs[0], pieces[0].start, EMPTY))
        else:
            found.append((contour.counter_clockwise(), (pieces, runs)))
    kept: list[tuple[Curve, complex]] = []
    for contour, (pieces, runs) in sorted(found, key=lambda each: -each[0].area):
        middle = middle_of(contour)
        if not doubles and any(_same(contour, middle, *each) for each in kept):
            left += [Left(run, pieces[0].start, DOUBLE) for run in runs]
        else:
            kept.append((contour, middle))
    return [contour for contour, _ in kept], left


def _same(one: Curve, middle: complex, other: Curve, place: complex) -> bool:
    """Whether two contours lie on each other, to all appearances."""
    return (
        abs(one.area - other.area) <= ALIKE * one.length**2
        and abs(one.length - other.length) <= ALIKE * one.length
        and abs(middle - place) <= NEARLY * one.length
    )


def drawing_of(
    data: bytes, name: str = "the drawing", progress: Progress = lambda _: None
) -> Drawing:
    """The drawing in the file `name`; FileError if it is not DXF, or truncated."""
    return Drawing(name, *read_contents(data, name, progress))


class DxfReader:
    """Reads closed contours from a DXF drawing."""

    def read(
        self,
        data: bytes,
        name: str,
        *,
        layer: str | None,
        unit: LengthUnit | None,
        gap: float,
        progress: Progress = lambda _: None,
    ) -> Outlines:
        """See `Drawing.outlines`."""
        drawing = drawing_of(data, name, progress)
        return drawing.outlines(layer, unit, gaps_up_to(gap), progress=progress)


READER = DxfReader()


# -- chains ---------------------------------------------------------------------------------------
# Pieces of a drawing joined end to end into closed chains, among others that close nothing.
#
# Ends at the same place are a node. Where just two pieces meet one follows the other; chains with a
# loose end are left, until there is none. Where several meet, shapely's polygonizer finds the
# faces: what lies on the border of exactly one bounds the shape; bridges and what divides a face
# are left.


JOINED: Final = 1e-12
"""Ends closer than this fraction of the drawing's reach are the same, written once as an angle and
once as a point."""

LEAST: Final = 1e-30
"""Gap [mm] of a drawing of no reach."""

BETWEEN: Final = np.arange(1, 8) / 8.0
"""Shares of a curved piece at which faces are told from each other; no geometry comes from them."""

PAIRS: Final = 10_000_000
"""Pairs of ends that are close to each other."""

PATHS: Final = 10_000
"""Chains between places where several pieces meet."""

NONE: Final = -1
"""In place of the end that follows another one."""

LOOSE: Final = "has a loose end"
BRANCH: Final = "meets more than one other piece"
DOUBLE: Final = "is drawn a second time"
EMPTY: Final = "encloses nothing"
"""Why a run is left."""


class Run(NamedTuple):
    """Pieces of an entity end to end.

    Attributes
    ----------
    kind, line : of the entity.
    pieces : one or more [mm].
    exact : whether they are its curve, and do not only follow it.
    """

    kind: str
    line: int
    pieces: Sequence[Strand]
    exact: bool


class Left(NamedTuple):
    """A run that is part of no closed chain, or is drawn already, with the place [mm] and why."""

    run: Run
    place: complex
    why: str


Loop = tuple[list[Strand], Sequence[Run]]
"""The pieces of a closed chain, and the runs that they are from."""

Way = list[int]
"""Runs one after the other, by the ends at which they are entered: 2 k is the start of run k."""


def chained(runs: Sequence[Run], gap: float) -> tuple[list[Loop], list[Left]]:
    """The closed chains of open `runs`, whose ends are joined if they are at most `gap` apart [mm],
    or the same but for rounding; and what is left.
    """
    both = [end for run in runs for end in (run.pieces[0].start, run.pieces[-1].end)]
    if not both:
        return [], []
    ends = np.array(both)
    gap = max(gap, JOINED * float(np.max(np.abs(ends))), LEAST)
    nodes = _nodes(ends, gap)
    used = ~_doubles(runs, nodes, gap)
    left = [Left(runs[k], both[2 * k], DOUBLE) for k in np.flatnonzero(~used).tolist()]
    while True:
        following, degrees = _following(nodes, np.repeat(used, 2))
        ways = list(_ways(following.tolist(), used))
        single = [way for way in ways if 1 in (degrees[way[0]], degrees[way[-1] ^ 1])]
        if not single:
            break
        for way in single:
            end = way[0] if degrees[way[0]] == 1 else way[-1] ^ 1
            used[[each // 2 for each in way]] = False
            order = way if end == way[0] else way[::-1]
            left += [Left(runs[each // 2], both[end], LOOSE) for each in order]
    found = [way for way in ways if following[way[0]] != NONE]
    others = {k: way for k, way in enumerate(ways) if following[way[0]] == NONE}
    spots = np.empty_like(ends)
    spots[nodes] = ends
    rings = _outer_rings({k: _path(runs, way, spots[nodes]) for k, way in others.items()})
    for ring in rings:
        parts = (others[k] if ahead else [e ^ 1 for e in others[k][::-1]] for k, ahead in ring)
        found.append([end for part in parts for end in part])
    for k in others.keys() - {k for ring in rings for k, _ in ring}:
        left += [Left(runs[end // 2], both[end], BRANCH) for end in others[k]]
    return [
        ([piece for end in way for piece in _pieces(runs, end)], [runs[end // 2] for end in way])
        for way in found
    ], left


def _pieces(runs: Sequence[Run], end: int) -> Sequence[Strand]:
    """The pieces of a run from that end on."""
    pieces = runs[end // 2].pieces
    return [piece.reversed() for piece in pieces[::-1]] if end % 2 else pieces


def _nodes(ends: ComplexArray, gap: float) -> IntArray:
    """(n,) the same number for `ends` (n,) that are at most `gap` apart, or by way of others."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    known, numbers = np.unique(ends, return_inverse=True)
    tree = cKDTree(np.column_stack((known.real, known.imag)))
    count = int(tree.count_neighbors(tree, gap))
    if count > PAIRS:
        raise beyond("the drawing", counted(count, "pair") + " of near ends", PAIRS, DRAWING)
    one, other = tree.query_pairs(gap, output_type="ndarray").T
    links = coo_array((np.ones(len(one)), (one, other)), shape=(len(known), len(known)))
    return np.asarray(connected_components(links, directed=False)[1])[numbers]


def _doubles(runs: Sequence[Run], nodes: IntArray, gap: float) -> BoolArray:
    """(n,) which of the `runs` (n,) lie on another one: the same ends, the same middle."""
    marks = np.array([sum(map(_middle, run.pieces)) / len(run.pieces) for run in runs])
    ends = np.sort(nodes.reshape(-1, 2), axis=1)
    order = np.lexsort((marks.imag, marks.real, ends[:, 1], ends[:, 0]))
    same = np.all(ends[order[1:]] == ends[order[:-1]], axis=1)
    found = np.zeros(len(runs), dtype=np.bool_)
    found[order[1:][same & (np.abs(np.diff(marks[order])) <= gap)]] = True
    return found


def _middle(piece: Strand) -> complex:
    if isinstance(piece, CubicSpline):
        return complex(np.mean(piece.controls))
    if not piece.sweep:
        return 0.5 * (piece.start + piece.end)
    return piece.centre + (piece.start - piece.centre) * cmath.exp(0.5j * piece.sweep)


def _following(nodes: IntArray, used: BoolArray) -> tuple[IntArray, IntArray]:
    """(n,) the other end at the node of each `used` one if there are just these two, else NONE; and
    how many there are.
    """
    order = np.flatnonzero(used)
    order = order[np.argsort(nodes[order], kind="stable")]
    firsts = np.flatnonzero(np.diff(nodes[order], prepend=NONE))
    counts = np.diff(np.append(firsts, len(order)))
    two = firsts[counts == 2]
    following, degrees = np.full((2, len(nodes)), NONE)
    following[order[two]], following[order[two + 1]] = order[two + 1], order[two]
    degrees[order] = np.repeat(counts, counts)
    return following, degrees


def _ways(following: list[int], used: BoolArray) -> Iterator[Way]:
    """All `used` runs, each in one way: first those from an end that none follows, then rings."""
    free = used.tolist()
    ends = range(len(following))
    for end in (*(e for e in ends if following[e] == NONE), *ends[::2]):
        way: Way = []
        while end != NONE and free[end // 2]:
            free[end // 2] = False
            way.append(end)
            end = following[end ^ 1]
        if way:
            yield way


def _path(runs: Sequence[Run], way: Way, spots: ComplexArray) -> ComplexArray:
    """Points along a way, each other than the one before; its ends are those of their nodes."""
    parts = [spots[way[:1]]]
    for piece in (piece for end in way for piece in _pieces(runs, end)):
        if isinstance(piece, CubicSpline):
            parts.append(at(piece.beziers, BETWEEN).ravel())
        elif piece.sweep:
            parts.append(piece.at(BETWEEN))
        parts.append(np.array([piece.end]))
    parts[-1] = spots[[way[-1] ^ 1]]
    points: ComplexArray = np.concatenate(parts)
    apart: ComplexArray = points[np.diff(points, prepend=np.nan) != 0.0]
    return apart


Ring = list[tuple[int, bool]]
"""Paths one after the other by their numbers, and whether they are run through forwards."""


def _outer_rings(paths: Mapping[int, ComplexArray]) -> list[Ring]:
    """The borders of the shapes that the `paths` enclose, without what lies between two faces."""
    rings = _rings(paths)
    borders = Counter(k for ring in rings for k, _ in ring)
    outer = {k: paths[k] for k, count in borders.items() if count == 1}
    return rings if len(outer) == len(borders) else _rings(outer)


def _rings(paths: Mapping[int, ComplexArray]) -> list[Ring]:
    """The outer borders of the faces between the `paths`, which meet only at their ends."""
    import shapely

    if len(paths) > PATHS:
        raise beyond("the drawing", f"{len(paths):,} chains between crossings", PATHS, DRAWING)
    long = {k: path for k, path in paths.items() if len(path) > 1}
    heads = {(path[0], path[1]): (k, True) for k, path in long.items()}
    heads |= {(path[-1], path[-2]): (k, False) for k, path in long.items()}
    lines = [shapely.LineString(np.column_stack((z.real, z.imag))) for z in long.values()]
    faces = shapely.get_parts(shapely.polygonize(lines))
    rings = shapely.get_exterior_ring(faces)
    borders = (shapely.get_coordinates(ring) @ (1.0, 1.0j) for ring in rings)
    return [[heads[step] for step in pairwise(z.tolist()) if step in heads] for z in borders]
