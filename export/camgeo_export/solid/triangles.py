"""Triangles of a flat face between rings, with no vertices but theirs.

The triangulation of manifold3d cuts ears, in a time that can grow with the square of the points,
so a face of many is divided along diagonals first. A diagonal counts only if its sign tests, in
doubles with the bound of their error, prove that it meets no side: where none is found the face
stays whole, and what is lost is time.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations, pairwise

import manifold3d
import numpy as np
import shapely

from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, IntArray

PIECE = 2000
"""Points of a face above which it is divided. Of the face of a disc with a bore, ears of as many
take twice the time per point that those of 250 take, which is about what division adds."""

STARTS, QUARTERS = 8, 4
"""Vertices at which a diagonal is looked for, evenly over a ring, and the parts of the ring in each
of which it may end, at the nearest vertex."""

ROUNDING = 4.0 * 2.0**-53
"""Relative error of a sign test in doubles is below this: (3 + 16 u) u with u = 2^-53, J. R.
Shewchuk, Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates (1997).
"""

TILT, TOWARDS = 0.25, np.exp(1.0j)
"""Tilt of a face that is triangulated, and the direction [rad] in which it recedes: an axis of
symmetry that no drawing has."""


@dataclass(frozen=True, slots=True, eq=False)
class _Face:
    """A face: indices of the points of its outer ring, counter-clockwise, and of its holes."""

    outer: IntArray
    holes: tuple[IntArray, ...]

    @property
    def rings(self) -> tuple[IntArray, ...]:
        return self.outer, *self.holes

    @property
    def count(self) -> int:
        return sum(map(len, self.rings))


def triangulated(rings: list[ComplexArray], most: int = PIECE) -> IntArray:
    """(m, 3) counter-clockwise triangles of the face on the left of disjoint rings.

    They index the points of all rings in one row. Of n points around h holes there are n - 2 + 2 h
    triangles (a further outer ring has two less). `most` points are triangulated at once.
    """
    at, seen = np.concatenate(rings), np.concatenate(_tilted(rings))
    indices = np.split(np.arange(len(at)), np.cumsum([len(ring) for ring in rings])[:-1])
    flat = np.column_stack((seen.real, seen.imag))
    if len(at) <= most:
        whole: IntArray = manifold3d.triangulate([flat[ring] for ring in indices])
        return whole
    outward = [_area(at[ring]) > 0.0 for ring in indices]
    waiting = _faces(
        [ring for ring, outer in zip(indices, outward, strict=True) if outer],
        [ring for ring, outer in zip(indices, outward, strict=True) if not outer],
        at,
    )
    found: list[IntArray] = []
    while waiting:
        face = waiting.pop()
        halves = _divided(face, at, seen) if face.count > most else []
        waiting += halves
        if not halves:
            ears = manifold3d.triangulate([flat[ring] for ring in face.rings])
            found.append(np.concatenate(face.rings)[ears])
    return np.concatenate(found)


def _tilted(rings: list[ComplexArray]) -> list[ComplexArray]:
    """The rings in perspective, where the same triangles are as good.

    Straight lines stay straight and no triangle turns over, but nothing is symmetric. Of the equal
    choices that symmetry offers the last digits would pick one, and they differ by processor.
    """
    size = max(float(np.max(np.abs(ring))) for ring in rings)
    return [ring / (1.0 + TILT / size * (ring * np.conj(TOWARDS)).real) for ring in rings]


def _faces(outers: list[IntArray], holes: list[IntArray], at: ComplexArray) -> list[_Face]:
    """Each hole in the smallest of the outer rings around it."""
    if len(outers) == 1:
        return [_Face(outers[0], tuple(holes))]
    outers = sorted(outers, key=lambda ring: _area(at[ring]))
    around = [shapely.Polygon(np.column_stack((at[ring].real, at[ring].imag))) for ring in outers]
    shapely.prepare(around)
    within: list[list[IntArray]] = [[] for _ in outers]
    for hole in holes:
        start = shapely.Point(at[hole[0]].real, at[hole[0]].imag)
        within[[each.contains(start) for each in around].index(True)].append(hole)
    return [_Face(outer, tuple(each)) for outer, each in zip(outers, within, strict=True)]


def _divided(face: _Face, at: ComplexArray, seen: ComplexArray) -> list[_Face]:
    """Two faces with the same points, or none if no diagonal was found."""
    if not face.holes:
        return _across(face, at, seen)
    return _through_hole(face, at, seen) or _across(face, at, seen)


def _across(face: _Face, at: ComplexArray, seen: ComplexArray) -> list[_Face]:
    """The face divided along the shortest diagonal found, a quarter of the ring on either side."""
    ring, count = face.outer, len(face.outer)
    least = max(2, count // 4)  # a side is no diagonal
    pairs = [
        (start, (start + end) % count)
        for start in _evenly(count)
        for end in _nearest(
            seen[ring[start]], seen[np.roll(ring, -start)], least, count - least + 1
        )
    ]
    for i, j in sorted(pairs, key=lambda pair: _length(seen, ring[pair[0]], ring[pair[1]])):
        parts = [_along(ring, i, j), _along(ring, j, i)]
        # A diagonal outside of the ring would leave one of them clockwise.
        if all(_turns_left(at[part]) for part in parts) and _clear(face, at, ring[i], ring[j]):
            return _faces(parts, list(face.holes), at)
    return []


def _through_hole(face: _Face, at: ComplexArray, seen: ComplexArray) -> list[_Face]:
    """The face divided along two diagonals, from its largest hole to the outer ring."""
    order = sorted(range(len(face.holes)), key=lambda k: len(face.holes[k]))
    hole = face.holes[order[-1]]
    bridges: list[tuple[int, int]] = []
    for start in _evenly(len(hole)):
        ends = _nearest(seen[hole[start]], seen[face.outer], 0, len(face.outer))
        for end in sorted(ends, key=lambda j: float(abs(seen[hole[start]] - seen[face.outer[j]]))):
            if _clear(face, at, face.outer[end], hole[start]):
                bridges.append((end, start))
                break
    best: list[IntArray] = []
    for (i, k), (j, m) in combinations(bridges, 2):
        there, here = at[face.outer[[i, j]]], at[hole[[k, m]]]
        if i == j or not _apart(there[0], here[0], there[1], here[1]):
            continue
        parts = [
            np.concatenate((_along(face.outer, i, j), _along(hole, m, k))),
            np.concatenate((_along(face.outer, j, i), _along(hole, k, m))),
        ]
        if not best or min(map(len, parts)) > min(map(len, best)):
            best = parts
    others = [face.holes[k] for k in sorted(order[:-1])]
    return _faces(best, others, at) if best else []


def _evenly(count: int) -> list[int]:
    """Positions of some vertices of a ring of so many."""
    return sorted({count * k // STARTS for k in range(STARTS)})


def _nearest(to: complex, ring: ComplexArray, first: int, end: int) -> Iterator[int]:
    """Positions of the vertices nearest to a point, one in each part of ring[first:end]."""
    away = ring - to
    squares = away.real**2 + away.imag**2
    limits = [first + (end - first) * k // QUARTERS for k in range(QUARTERS + 1)]
    for low, high in pairwise(limits):
        if low < high:
            yield low + int(np.argmin(squares[low:high]))


def _along(ring: IntArray, i: int, j: int) -> IntArray:
    """The ring from position i on to position j, both included."""
    return ring[i : j + 1] if i < j else np.concatenate((ring[i:], ring[: j + 1]))


def _length(points: ComplexArray, i: int, j: int) -> float:
    return float(abs(points[i] - points[j]))


def _area(ring: ComplexArray) -> float:
    """Of a polygon, positive counter-clockwise."""
    arms = ring - ring[0]
    return 0.5 * float(np.sum((np.conj(arms) * np.roll(arms, -1)).imag))


def _turns_left(ring: ComplexArray) -> bool:
    """Whether a ring is proved counter-clockwise by its area, the rounding of the sum included."""
    reach = float(np.max(np.abs(ring - ring[0])))
    return _area(ring) > len(ring) ** 2 * ROUNDING * reach**2


def _clear(face: _Face, at: ComplexArray, i: int, j: int) -> bool:
    """Whether the segment between two vertices is proved to meet no side that ends at neither."""
    for ring in face.rings:
        after = np.roll(ring, -1)
        ends_there = (ring == i) | (ring == j) | (after == i) | (after == j)
        if not np.all(ends_there | _apart(at[i], at[j], at[ring], at[after])):
            return False
    return True


def _apart(
    p: complex, q: complex, a: ComplexArray | complex, b: ComplexArray | complex
) -> BoolArray:
    """Whether segments pq and ab are proved disjoint: one lies on one side of the other's line."""
    found: BoolArray = (_side(p, q, a) * _side(p, q, b) > 0.0) | (
        _side(a, b, p) * _side(a, b, q) > 0.0
    )
    return found


def _side(
    p: ComplexArray | complex, q: ComplexArray | complex, a: ComplexArray | complex
) -> FloatArray:
    """1 where point a is proved left of the line from p to q, -1 where right, otherwise 0."""
    along, to = np.subtract(q, p), np.subtract(a, p)
    left, right = along.real * to.imag, along.imag * to.real
    product = left - right
    proved = np.abs(product) > ROUNDING * (np.abs(left) + np.abs(right))
    found: FloatArray = np.where(proved, np.sign(product), 0.0)
    return found
