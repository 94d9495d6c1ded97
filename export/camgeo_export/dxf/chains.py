"""Pieces of a drawing joined end to end into closed chains, among others that close nothing.

Ends at the same place are a node. Where just two pieces meet one follows the other; chains with a
loose end are left, until there is none. Where several meet, shapely's polygonizer finds the faces:
what lies on the border of exactly one bounds the shape; bridges and what divides a face are left.
"""

from __future__ import annotations

import cmath
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Final, NamedTuple

import numpy as np

from camgeo.contour.bezier import at
from camgeo.contour.spline import CubicSpline
from camgeo.numeric.arrays import BoolArray, ComplexArray, IntArray
from camgeo.reading import DRAWING, beyond
from camgeo.wording import counted
from camgeo_export.dxf.curves import Strand

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
