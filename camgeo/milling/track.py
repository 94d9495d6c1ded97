"""An open chain of lines and arcs in the plane: the way of a cutter's centre, seen from above."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import (
    Contour,
    PieceChain,
    Pieces,
    distances,
    least_distance,
    winding_number,
)
from camgeo.geometry.contour.spline import Arc
from camgeo.numeric.arrays import ComplexArray, FloatArray, taken

FLAT = 1e-9
"""An arc of a smaller sagitta [mm] is a line: far below what any program can state."""


class Track(PieceChain):
    """Lines and arcs, each beginning where the one before it ends.

    Attributes
    ----------
    vertices : (n + 1,) complex [mm], the ends of the n pieces.
    sweeps : (n,) [rad], angle turned along the piece, positive counter-clockwise; 0 is a line.
    centres : (n,) complex [mm], centre of each arc; 0 where the piece is a line.
    """

    __slots__ = ()

    @property
    def starts(self) -> ComplexArray:
        """(n,) complex [mm], start of each piece."""
        return self.vertices[:-1]

    @property
    def ends(self) -> ComplexArray:
        """(n,) complex [mm], end of each piece."""
        return self.vertices[1:]

    @property
    def start(self) -> complex:
        """Where the track begins [mm]."""
        return complex(self.vertices[0])

    @property
    def end(self) -> complex:
        """Where the track ends [mm]."""
        return complex(self.vertices[-1])

    @property
    def pieces(self) -> Pieces:
        """Lines and arcs of the track."""
        return Pieces.from_run(self)

    @property
    def lengths(self) -> FloatArray:
        """(n,) [mm] length of each piece."""
        return self.pieces.lengths

    @property
    def length(self) -> float:
        """Length of all pieces [mm]."""
        return float(np.sum(self.lengths))

    @property
    def headings(self) -> tuple[complex, complex]:
        """Unit tangents at its start and at its end, in its direction."""
        pieces = taken(self.pieces, [0, -1])
        first, last = pieces.tangents(np.array([self.start, self.end])).tolist()
        return first, last

    @classmethod
    def around(cls, contour: Contour) -> Self:
        """Once round a closed contour, from its first vertex."""
        vertices = np.append(contour.vertices, contour.vertices[0])
        return cls(vertices, contour.sweeps, contour.centres)

    @classmethod
    def line(cls, start: complex, end: complex) -> Self:
        """One line."""
        return cls(np.array([start, end]), np.zeros(1), np.zeros(1, dtype=np.complex128))

    @classmethod
    def arc(cls, start: complex, centre: complex, sweep: float) -> Self:
        """One arc from `start` about `centre` [mm] by `sweep` [rad]."""
        end = centre + (start - centre) * np.exp(1j * sweep)
        return cls(np.array([start, end]), np.array([sweep]), np.array([centre]))

    def reversed(self) -> Self:
        """The same track in the opposite direction."""
        return type(self)(self.vertices[::-1], -self.sweeps[::-1], self.centres[::-1])

    def halved(self) -> Self:
        """The same track with each arc in equal parts of at most half a turn."""
        pieces = self.pieces
        index, first, last = pieces.halves()
        parts = taken(pieces, index).subpieces(first, last)
        return type(self)(np.append(parts.starts, self.vertices[-1]), parts.sweeps, parts.centres)

    def points_and_tangents(self, distances: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """(m,) points [mm] and unit tangents at `distances` (m,) [mm] from its start along it."""
        stops = np.concatenate(([0.0], np.cumsum(self.lengths)))
        index = np.clip(np.searchsorted(stops, distances, "right") - 1, 0, len(self) - 1)
        pieces = taken(self.pieces, index)
        lengths = pieces.lengths
        share = (distances - stops[index]) / np.where(lengths > 0.0, lengths, 1.0)
        points = pieces.points_by_share(np.clip(share, 0.0, 1.0))
        return points, pieces.tangents(points)

    def section(self, start: float, end: float) -> Self:
        """The part from `start` to `end` [mm] along it, 0 <= start < end <= length."""
        stops = np.concatenate(([0.0], np.cumsum(self.lengths)))
        slack = FLAT
        # Joints strictly inside; the piece between two cuts is the one at their middle.
        inner = np.flatnonzero((stops > start + slack) & (stops < end - slack))
        cuts = np.concatenate(([start], stops[inner], [end]))
        index = np.clip(
            np.searchsorted(stops, 0.5 * (cuts[:-1] + cuts[1:]), "right") - 1, 0, len(self) - 1
        )
        share = np.diff(cuts) / self.lengths[index]
        ends, _ = self.points_and_tangents(np.array([start, end]))
        if start <= slack:
            ends[0] = self.vertices[0]
        if end >= stops[-1] - slack:
            ends[1] = self.vertices[-1]
        vertices = np.concatenate((ends[:1], self.vertices[inner], ends[1:]))
        return type(self)(vertices, self.sweeps[index] * share, self.centres[index])


def track_along(pieces: Sequence[Arc]) -> Track:
    """Along pieces that each begin where the one before it ends."""
    vertices = np.array([pieces[0].start, *(piece.end for piece in pieces)])
    sweeps = np.array([piece.sweep for piece in pieces])
    return Track(vertices, sweeps, np.array([piece.centre for piece in pieces]))


def chain_tracks(tracks: Iterable[Track]) -> Track:
    """One after the other; each begins where the one before it ends, to rounding."""
    parts = list(tracks)
    return Track(
        np.concatenate([parts[0].vertices[:1], *(part.vertices[1:] for part in parts)]),
        np.concatenate([part.sweeps for part in parts]),
        np.concatenate([part.centres for part in parts]),
    )


# -- leads ----------------------------------------------------------------------------------------
# Tangential leads: tracks that join a closed path at one of its points without a corner.
#
# They are arcs on the free side of the path, where no material of the part is, before which and
# after which a line may run, for a controller that offsets the path while it enters.


SMALLEST_SHARE = 1.0 / 64.0
"""Fraction of its room down to which a lead is halved before the place is given up."""

SHORTEST = 0.02
"""A piece shorter than this share of the path is no place for leads: it rounds a corner."""

NEAR = 1.0 / 32.0
"""Share of a lead next to the path that is known to be clear by its curvature; for the rest the
distance is measured."""

LEAST_TURN = math.radians(15.0)
"""Least turn of a lead off a straight path [rad]; in narrow room its arc is made smaller
instead."""

SMALLEST_TURN = 0.1 * LEAST_TURN
"""Least turn of a lead off any path [rad]."""

CLOSE = 1e-6
"""Tolerance [mm] of the distance between the end of a lead and the path."""

STEPS = 32
"""Parts into which an interval of turns is divided in the search for that of a lead."""

LEAST_STEP = 1e-10
"""Turns [rad] that differ by less are equal: by far less than `CLOSE` at the end of any lead."""

ASIDE = 2.5
"""Length of a line in which a controller takes up all of a cutter's radius, in radii."""

LEAST_PART = 1e-6
"""A contour is not cut nearer than this [mm] to a joint of its pieces, but at the joint."""

TIGHTEST = 0.6
"""Largest radius of a lead's arc as a share of that of the path's, inside which it runs."""

FARTHEST = 0.5
"""How far off a path inside which it runs a lead goes, at most, as a share of the path's radius."""

MOST_PLACES = 24
"""Places that are tried for leads, the flattest first."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LeadSpec:
    """Requirements on the leads of a path.

    Attributes
    ----------
    free : 1 if the free side is on the left of the path, -1 if on its right.
    usual : radius [mm] of a lead's arc where the room is narrow.
    straight : whether lines precede and follow the arcs, in which a controller takes up its offset
        of the cutter; each takes half of the room.
    aside : that offset [mm], if it is the cutter's radius: the lines are then long enough for it,
        whatever room they take, and begin and end as far beside themselves as the programmed path.
    avoid : tracks, and how near [mm] the leads may come to them.
    least : how near [mm] to the path leads may end: where the cutter comes down there it must not
        meet the allowance that is left on the wall.
    """

    free: int
    usual: float
    straight: bool = False
    aside: float = 0.0
    avoid: Sequence[tuple[Track, float]] = ()
    least: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class Lead:
    """The ways onto a path and off it.

    Attributes
    ----------
    entry : ends at the first vertex of the path, in its direction.
    exit : begins there, in the same direction.
    """

    entry: Track
    exit: Track


def begin_in_piece(contour: Contour, index: int) -> Contour:
    """The contour, starting in the middle of its piece `index`, an arc or a line."""
    return _begin_in_first_piece(contour.rolled(index), 0.5)


def flattest(contour: Contour) -> Iterator[int]:
    """The pieces in the middle of which leads may join, the flattest first; of equal ones the
    longest.
    """
    lengths = contour.lengths
    long = lengths >= SHORTEST * contour.length
    if not np.any(long):
        long = lengths == np.max(lengths)
    radii = contour.radii
    bends = np.divide(1.0, radii, out=np.zeros_like(radii), where=radii > 0.0)
    # Curvatures are rounded: the arcs of one dwell differ by rounding and count as equal.
    order = sorted(np.flatnonzero(long), key=lambda k: (round(float(bends[k]), 6), -lengths[k]))
    yield from (int(k) for k in order[:MOST_PLACES])


def begin_at_distance(contour: Contour, distance: float) -> Contour:
    """The contour, starting `distance` [mm] along it from its first vertex."""
    stops = np.cumsum(contour.lengths)
    index = min(int(np.searchsorted(stops, distance, "right")), len(contour) - 1)
    length = float(contour.lengths[index])
    share = 1.0 - (float(stops[index]) - distance) / length
    if share * length < LEAST_PART or (1.0 - share) * length < LEAST_PART:
        return contour.rolled(index + round(share))
    return _begin_in_first_piece(contour.rolled(index), share)


def _begin_in_first_piece(contour: Contour, share: float) -> Contour:
    """The contour, starting inside its first piece, at `share` of that piece's length."""
    sweep, centre = contour.sweeps[0], contour.centres[0]
    start, end = contour.vertices[0], contour.ends[0]
    there = start + share * (end - start)
    if sweep != 0.0:
        there = centre + (start - centre) * np.exp(1j * share * sweep)
    return Contour(
        np.concatenate(([there], contour.vertices[1:], contour.vertices[:1])),
        np.concatenate(([(1.0 - share) * sweep], contour.sweeps[1:], [share * sweep])),
        np.concatenate(([centre], contour.centres[1:], [centre])),
    )


def join_leads(
    path: Contour, room: float, spec: LeadSpec, *, place: float | None = None
) -> tuple[Contour, Lead]:
    """The path, begun at its flattest place where leads fit, and these leads.

    Parameters
    ----------
    room : how far the leads go off the path [mm], above 0; half of it, and so on, where they do not
        fit, but no less than `spec.least`.
    place : the only place for leads, as a distance [mm] along the path; None for any.

    Raises
    ------
    GeometryError
        If even small leads would cut into the part, or touch what they have to avoid, wherever
        they join the path; with key "output.gcode.compensation" if that asks for longer ones.
    """
    size = room
    places = [begin_in_piece(path, index) for index in flattest(path)]
    if place is not None:
        places = [begin_at_distance(path, place)]
    while size >= max(SMALLEST_SHARE * room, spec.least - CLOSE):
        for there in places:
            lead = fit_leads(there, size, spec)
            if lead is not None:
                return there, lead
        size /= 2.0
    if spec.aside:
        raise GeometryError(
            "there is no room next to the outline for leads with a line of"
            f" {ASIDE * spec.aside:g} mm, in which the controller takes up the cutter's radius;"
            ' "wear" needs less',
            key="output.gcode.compensation",
            value='"control"',
        )
    raise GeometryError(
        "there is no room for a tangential lead-in next to the outline; a smaller cutter may help",
        key="tool",
    )


def fit_leads(path: Contour, room: float, spec: LeadSpec) -> Lead | None:
    """The leads that join the path at its first vertex; None if they do not fit.

    Their ends are `room` [mm] off the path, within `CLOSE`; less only where the path itself is too
    tight for that, and never less than `spec.least`.
    """
    track = Track.around(path)
    along = track.headings[0]
    exit_track = _lead_track(track, along, room, _bend(path, 0, spec.free), spec)
    # The entry is found as a way off the path run backwards, on which left and right change places.
    back = replace(spec, free=-spec.free)
    into = _lead_track(track, -along, room, _bend(path, -1, spec.free), back)
    if exit_track is None or into is None:
        return None
    lead = Lead(into.reversed(), exit_track)
    if not _keeps_distance(lead, spec.avoid):
        return None
    ways = [
        (way, min(NEAR * way.length, 0.5 * float(path.lengths[k])))
        for way, k in ((exit_track, 0), (into, -1))
    ]
    fits = all(_is_clear(path, track, way, skip, spec.free) for way, skip in ways)
    return lead if fits else None


def _bend(path: Contour, piece: int, free: int) -> float:
    """Curvature [1/mm] of a piece towards the free side."""
    sweep = float(path.sweeps[piece])
    return math.copysign(1.0, free * sweep) / float(path.radii[piece]) if sweep else 0.0


def _lead_track(
    path: Track, along: complex, room: float, bend: float, spec: LeadSpec
) -> Track | None:
    """The way from the beginning of the closed path, in the direction `along` and with the free
    side of `spec` seen in it, that ends `room` [mm] off the path; None if there is none.

    `bend` is the curvature [1/mm] of the path there, positive towards the free side: then it goes
    up to half its radius off it, by as much of a turn as that takes.
    """
    if bend > 0.0:  # the path encloses the lead, which has room only within its radius
        room = min(room, FARTHEST / bend)
    lift = room - ASIDE * spec.aside if spec.aside else room * (0.5 if spec.straight else 1.0)
    if lift <= 0.0:
        return None
    # An arc of radius r that turns by t is r (1 - cos t) off a straight path: a quarter turn in
    # wide room, a flatter and larger arc in a narrow one.
    radius = max(lift, min(spec.usual, lift / (1.0 - math.cos(LEAST_TURN))))
    if bend > 0.0:
        radius = min(radius, TIGHTEST / bend)
    # A line at the angle of a flat lead's end, which gets the rest of the room off it.
    flat = math.acos(max(1.0 - lift / radius, 0.0))
    line = ASIDE * spec.aside if spec.aside else (room - lift) / math.sin(flat)
    # The end of the line is so far from the middle of the arc, and so much farther round it.
    arm = complex(radius + spec.aside, line)
    centre = path.start + spec.free * 1j * along * radius
    start = _estimated_turn(radius, arm, room, bend)

    def ends(turns: FloatArray) -> ComplexArray:
        # The arm turns with the lead about the arc's centre; on the right it is mirrored.
        spoke = arm if spec.free > 0 else arm.conjugate()
        points: ComplexArray = centre - spec.free * 1j * along * spoke * np.exp(
            1j * spec.free * turns
        )
        return points

    turn = _refined_turn(path, ends, room, start)
    away = float(distances(ends(np.array([turn])), path)[0])
    if away > room + CLOSE or away < spec.least - CLOSE:
        return None
    arc = Track.arc(path.start, centre, spec.free * turn)
    if not line:
        return arc
    # Where compensation is off the centre is on the programmed line, which runs `aside` nearer to
    # the wall: along the line the centre moves across by that.
    across = -spec.free * 1j * spec.aside
    return chain_tracks((arc, Track.line(arc.end, arc.end + (line + across) * arc.headings[1])))


def _estimated_turn(radius: float, arm: complex, room: float, bend: float) -> float:
    """By how much an arc of `radius` [mm] turns [rad] until the end of `arm`, seen from its centre
    along its spoke, is `room` [mm] off a path that keeps the curvature `bend` [1/mm].
    """
    length, ahead = abs(arm), math.atan2(arm.imag, arm.real)
    cosine, most = (radius - room) / length, 0.5 * math.pi
    if bend:
        # Off a round path of radius p, negative where it bends away: by the triangle with sides
        # p - r, the arm and p - room.
        side, far = 1.0 / bend - radius, 1.0 / bend - room
        cosine = (far * far - side * side - length * length) / (2.0 * side * length)
        most = math.pi if bend > 0.0 else most
    return min(max(math.acos(min(max(cosine, -1.0), 1.0)) - ahead, SMALLEST_TURN), most)


def _refined_turn(
    path: Track, ends: Callable[[FloatArray], ComplexArray], room: float, start: float
) -> float:
    """The turn [rad] next to `start` after which the end is `room` [mm] off the path as it is; if
    there is none, `start`.
    """
    if abs(float(distances(ends(np.array([start])), path)[0]) - room) <= CLOSE:
        return start
    low, high = SMALLEST_TURN, math.pi
    # Crossings of the distance `room` are bracketed on a grid; the one nearest to `start` is
    # refined.
    while high - low > LEAST_STEP:
        turns = np.linspace(low, high, STEPS + 1)
        beyond = distances(ends(turns), path) > room
        passed = np.flatnonzero(beyond[1:] != beyond[:-1])
        if not len(passed):
            return start
        k = passed[np.argmin(np.abs(0.5 * (turns[passed] + turns[passed + 1]) - start))]
        low, high = float(turns[k]), float(turns[k + 1])
    return 0.5 * (low + high)


def _is_clear(path: Contour, track: Track, way: Track, near: float, free: int) -> bool:
    """Whether a way off the path, beyond its first part `near` [mm], stays on the free side.

    In the first part the curvatures decide: the lead bends away from the path.
    """
    if least_distance(way.section(near, way.length), track) == 0.0:
        return False
    # Counter-clockwise a path has its inside on the left.
    return (winding_number(path, way.end) != 0) == ((path.area > 0.0) == (free > 0))


def _keeps_distance(lead: Lead, avoid: Sequence[tuple[Track, float]]) -> bool:
    return all(
        least_distance(way, track) >= distance
        for track, distance in avoid
        for way in (lead.entry, lead.exit)
    )
