"""Whether the faces of a STEP file form one closed, outward shell of level and upright faces and
chamfers between them, or where not.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from camgeo.contour.spline import Arc, CubicSpline
from camgeo.numeric.arrays import FloatArray
from camgeo.verifying.verification import Check, at_most, failed, near
from camgeo.wording import counted
from camgeo_export.dxf.curves import closed
from camgeo_export.errors import FileError
from camgeo_export.matching import AnyContour
from camgeo_export.part21.curves import (
    ALIGNED,
    Cone,
    Cylinder,
    Extrusion,
    Plane,
    Strand,
    apart,
    off_surface,
)
from camgeo_export.part21.solid import Edge, Face, Solid, Use, swept
from camgeo_export.verify.inclined import is_inclined, rows_of, volume_below, volume_within
from camgeo_export.verify.mesh import levels_of

MIDDLE = np.array([0.5])
"""Share of an arc at which it is compared with the surfaces of its faces and their senses."""

SAME_VOLUME = 1e-9
"""By how much the volumes by flat faces and by walls may differ, relative."""


@dataclass(frozen=True, slots=True)
class Bound:
    """A loop of a flat face: its height [mm] and its contour, in its direction from above."""

    z: float
    contour: AnyContour
    area: float


def is_flat(face: Face) -> bool:
    """Whether a face is level."""
    return isinstance(face.surface, Plane) and abs(face.surface.normal.place) <= ALIGNED


def shell_checks(solid: Solid, within: float) -> list[Check]:
    """All checks of the shell; `within` is how near [mm] edges meet vertices and surfaces."""
    checks = [_closed(solid), _oriented(solid)]
    if not all(check.ok for check in checks):
        return checks
    checks.append(_uncertainty(solid, within))
    checks.append(_walls(solid, within))
    if all(check.ok for check in checks):
        checks.append(_outwards(solid))
    return checks


def gap(solid: Solid) -> float:
    """By how much [mm] the curves of a solid may be off those through its vertices, at most.

    An arc through both vertices is the circle's own, turned and stretched: it moves no point by
    more than thrice as far as its ends.
    """
    return 3.0 * max(use.edge.off for use in _uses(solid))


def bounds_of(solid: Solid) -> list[Bound]:
    """The loops of all flat faces, in the order of the file; raises FileError."""
    return [_bound(loop) for face in solid.faces if is_flat(face) for loop in face.loops]


def levels(bounds: Sequence[Bound], within: float) -> tuple[FloatArray, list[list[AnyContour]]]:
    """(k, 2) least and greatest height of each level, from 0, and the contours at each."""
    if not bounds:
        return np.zeros((0, 2)), []
    numbers, ranges = levels_of(np.array([bound.z for bound in bounds]), within)
    found: list[list[AnyContour]] = [[] for _ in ranges]
    for bound, number in zip(bounds, numbers.tolist(), strict=True):
        found[number].append(bound.contour)
    return ranges, found


def volume_of(bounds: Iterable[Bound], faces: Iterable[Face] = ()) -> float:
    """The enclosed volume [mm^3] by flat faces, with the `bounds`, and by the chamfers among the
    `faces`; positive where they look outwards. Raises FileError for one that cannot be read.
    """
    leaning = (volume_below(face) for face in faces if is_inclined(face))
    return math.fsum((*(bound.z * bound.area for bound in bounds), *leaning))


def _uses(solid: Solid) -> Iterator[Use]:
    return (use for face in solid.faces for loop in face.loops for use in loop)


def _closed(solid: Solid) -> Check:
    """Each loop is closed, each edge has two faces, and all faces hang together."""
    for face in solid.faces:
        for loop in face.loops:
            for use, following in zip(loop, (*loop[1:], loop[0]), strict=True):
                if use.ends[1] != following.ends[0]:
                    what = f"edge #{use.edge.number} does not end where #{following.edge.number}"
                    return failed("closed", f"a loop of {face.told} is open: {what} begins")
    users: dict[int, list[int]] = defaultdict(list)
    for number, face in enumerate(solid.faces):
        for loop in face.loops:
            for use in loop:
                users[use.edge.number].append(number)
    single = [edge for edge, faces in users.items() if len(faces) != 2]
    if single:
        times = len(users[single[0]])
        note = f"edge #{single[0]} is used by {counted(times, 'loop')}, not by two"
        return Check("closed", "", float(len(single)), None, 0.0, "open edges", ok=False, note=note)
    parts = _parts(len(solid.faces), users.values())
    if parts != 1:
        return failed("closed", f"its faces form {parts} shells that do not hang together")
    return Check("closed", "", 0.0, None, 0.0, "open edges", ok=True)


def _parts(count: int, pairs: Iterable[Sequence[int]]) -> int:
    """Into how many parts `count` faces fall that `pairs` connect."""
    head = list(range(count))

    def first(number: int) -> int:
        while head[number] != number:
            head[number] = head[head[number]]
            number = head[number]
        return number

    for one, other in pairs:
        head[first(one)] = first(other)
    return sum(first(number) == number for number in range(count))


def _oriented(solid: Solid) -> Check:
    """Both faces of an edge traverse it in opposite directions."""
    turns: dict[int, int] = defaultdict(int)
    for use in _uses(solid):
        turns[use.edge.number] += 1 if use.forward else -1
    twice = [edge for edge, turn in turns.items() if turn]
    note = f"edge #{twice[0]} is used twice in the same direction" if twice else ""
    number = float(len(twice))
    return Check("oriented", "", number, None, 0.0, "edges run twice", not twice, note)


def _uncertainty(solid: Solid, within: float) -> Check:
    """Ends lie on their curves, edges on the surfaces of their faces."""
    worst, place = 0.0, ""
    for face in solid.faces:
        for loop in face.loops:
            for use in loop:
                off = max(use.edge.off, _off(face, use.edge))
                if not off <= worst:
                    worst, place = off, f"edge #{use.edge.number} of {face.told}"
    note = "" if worst <= within else f"{place} does not meet its vertices, or leaves the surface"
    return at_most("uncertainty", worst, within, "mm", note=note)


def _off(face: Face, edge: Edge) -> float:
    """How far [mm] an edge is from the surface of one of its faces."""
    surface = face.surface
    off = [off_surface(surface, point.place, point.z) for point in edge.places]
    if not edge.strands:
        one, other = edge.places
        off.append(off_surface(surface, 0.5 * (one.place + other.place), 0.5 * (one.z + other.z)))
    if edge.bend is not None:
        # By how much a cone misses it is of the fourth degree: it vanishes if five values do.
        along = [edge.bend.at(share) for share in (0.0, 0.25, 0.5, 0.75, 1.0)]
        off = [off_surface(surface, point.place, point.z) for point in along]
    for strand in edge.strands:
        if isinstance(surface, Extrusion):
            off.append(_off_extrusion(surface, strand))
        elif isinstance(strand, Arc):
            off.append(off_surface(surface, _middle(strand), edge.z))
        elif isinstance(surface, Cylinder | Cone):
            off.append(math.inf)  # no spline follows a circle
        else:
            off += [off_surface(surface, each, edge.z) for each in strand.controls.tolist()]
    if isinstance(surface, Extrusion) and not edge.strands:
        ends = (surface.curve.start, surface.curve.end)
        off.append(min(abs(end - edge.places[0].place) for end in ends))
    return max(off)


def _off_extrusion(surface: Extrusion, strand: Strand) -> float:
    if isinstance(strand, Arc):
        return math.inf
    return min(apart(surface.curve, strand), apart(surface.curve, strand.reversed()))


def _is_ahead(curve: CubicSpline, strand: CubicSpline) -> bool:
    """Whether a strand has the direction of the curve that it follows."""
    return apart(curve, strand) <= apart(curve, strand.reversed())


def _middle(arc: Arc) -> complex:
    """The point in its middle."""
    return complex(arc.at(MIDDLE)[0])


def _walls(solid: Solid, within: float) -> Check:
    """Each face is level, or between two heights, with its normal out of the material."""
    for face in solid.faces:
        note = _flat_fault(face) if is_flat(face) else _wall_fault(face, within)
        if note:
            return failed("walls", f"{face.told} {note}")
    return Check("walls", "", "upright", ok=True)


def _flat_fault(face: Face) -> str:
    """What is wrong with a level face: one loop goes round it, the others round its holes."""
    assert isinstance(face.surface, Plane)
    up = (face.surface.normal.z > 0.0) == face.same
    if any(not use.edge.strands for loop in face.loops for use in loop):
        return "has an upright edge"
    areas = sorted((_bound(loop).area for loop in face.loops), key=abs)
    signs = [area > 0.0 for area in areas]
    right = signs[-1] == up and all(sign != up for sign in signs[:-1]) and all(areas)
    return "" if right else "is turned against its edges"


def _wall_fault(face: Face, within: float) -> str:
    """What is wrong with one between two heights: the edges below it have it on their left, and so
    have those above.
    """
    low, high = swept(face)
    if is_inclined(face):
        try:
            rows_of(face)
        except FileError as error:
            return f"cannot be read: {error}"
    for loop in face.loops:
        for use in loop:
            if not use.edge.strands:
                continue
            z = use.edge.z
            below = abs(z - low) <= within
            if not below and abs(z - high) > within:
                return f"has edge #{use.edge.number} between its lower and its upper end"
            for strand in use.strands:
                if (_left_is_up(face, strand)) != below:
                    return "is turned against its edges"
    return ""


def _left_is_up(face: Face, strand: Strand) -> bool:
    """Whether up is on the left of a strand seen from outside the face."""
    surface = face.surface
    if isinstance(surface, Extrusion):
        ahead = isinstance(strand, CubicSpline) and _is_ahead(surface.curve, strand)
        return (surface.up > 0.0) == (face.same == ahead)
    place, heading = strand.start, strand.end - strand.start
    if isinstance(strand, Arc):
        place = _middle(strand)
        heading = strand.heading(place)
    normal = surface.normal.place if isinstance(surface, Plane) else place - surface.centre
    return ((normal.conjugate() * heading).imag > 0.0) == face.same


def _outwards(solid: Solid) -> Check:
    """The volume is positive, and the same by flat faces and by walls."""
    bounds = bounds_of(solid)
    by_levels = volume_of(bounds, solid.faces)
    by_walls = math.fsum(_volume_of_wall(face) for face in solid.faces if not is_flat(face))
    if not by_levels > 0.0:
        return failed("outwards", "the shell is turned inside out")
    return near("outwards", by_walls, by_levels, SAME_VOLUME * by_levels, "mm^3")


def _volume_of_wall(face: Face) -> float:
    """The share of a wall in the volume [mm^3]."""
    if is_inclined(face):
        return volume_within(face)
    low, high = swept(face)
    moments = [
        strand.moment
        for loop in face.loops
        for use in loop
        for strand in use.strands
        if use.edge.z - low < high - use.edge.z
    ]
    return (high - low) * math.fsum(moments)


def _bound(loop: Sequence[Use]) -> Bound:
    strands = [strand for use in loop for strand in use.strands]
    contour = closed(strands)
    return Bound(loop[0].edge.z, contour, contour.area)
