"""Tangential leads: tracks that join a closed path at one of its points without a corner.

They are arcs on the free side of the path, where no material of the part is, before which and after
which a line may run, for a controller that offsets the path while it enters.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.contour.simple import winding_number
from camgeo.errors import GeometryError
from camgeo.toolpath.plane.nearness import least_distance
from camgeo.toolpath.plane.track import Track, chained

SMALLEST_SHARE = 1.0 / 64.0
"""A lead is halved down to this fraction of its room before it is given up."""

SHORTEST = 0.02
"""A piece shorter than this share of the path is no place for leads: it rounds a corner."""

NEAR = 1.0 / 32.0
"""Share of a lead next to the path that its curvature decides on; the rest is measured."""

LEAST_TURN = math.radians(15.0)
"""A lead turns by no less, however narrow its room: it is then made of a smaller arc."""

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
class Beside:
    """What leads keep to beside a path.

    Attributes
    ----------
    free : 1 if the free side is on the left of the path, -1 if on its right.
    usual : radius [mm] of a lead's arc where the room is narrow.
    straight : whether lines precede and follow the arcs, in which a controller takes up its offset
        of the cutter; they take a third of the room.
    aside : that offset [mm], if it is the cutter's radius: the lines are then long enough for it,
        whatever room they take, and begin and end as far beside themselves as the programmed path.
    avoid : tracks, and how near [mm] the leads may come to them.
    """

    free: int
    usual: float
    straight: bool = False
    aside: float = 0.0
    avoid: Sequence[tuple[Track, float]] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Lead:
    """The ways onto a path and off it.

    Attributes
    ----------
    into, off : the first ends and the second begins where the path begins, both along it.
    """

    into: Track
    off: Track


def started(contour: Contour, index: int) -> Contour:
    """The same contour, starting in the middle of its piece `index`, an arc or a line."""
    return _parted(contour.rolled(index), 0.5)


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
    # Arcs of one rest differ by rounding.
    order = sorted(np.flatnonzero(long), key=lambda k: (round(float(bends[k]), 6), -lengths[k]))
    yield from (int(k) for k in order[:MOST_PLACES])


def farthest_along_x(contour: Contour) -> float:
    """Distance [mm] along the contour from its first vertex to its point with the largest x.

    Parallels have these points on one normal.
    """
    arms = contour.vertices - contour.centres
    turned = np.mod(-np.angle(arms) * np.where(contour.sweeps < 0.0, -1.0, 1.0), 2.0 * np.pi)
    round_there = (contour.sweeps != 0.0) & (turned < np.abs(contour.sweeps))
    most = np.where(round_there, contour.centres.real + contour.radii, contour.vertices.real)
    index = int(np.argmax(most))
    before = float(np.sum(contour.lengths[:index]))
    return before + (float(turned[index] * contour.radii[index]) if round_there[index] else 0.0)


def begun(contour: Contour, distance: float) -> Contour:
    """The same contour, starting `distance` [mm] along it from its first vertex."""
    stops = np.cumsum(contour.lengths)
    index = min(int(np.searchsorted(stops, distance, "right")), len(contour) - 1)
    length = float(contour.lengths[index])
    share = 1.0 - (float(stops[index]) - distance) / length
    if share * length < LEAST_PART or (1.0 - share) * length < LEAST_PART:
        return contour.rolled(index + round(share))
    return _parted(contour.rolled(index), share)


def _parted(contour: Contour, share: float) -> Contour:
    """The same contour, starting inside its first piece, at `share` of its length."""
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


def joined(
    path: Contour, room: float, beside: Beside, *, place: float | None = None
) -> tuple[Contour, Lead]:
    """The path, begun at its flattest place where leads fit, and these leads.

    Parameters
    ----------
    room : how far the leads go off the path [mm], above 0.
    place : the only place for leads, as a distance [mm] along the path; None for any.

    Raises
    ------
    GeometryError
        If even small leads would cut into the part, or touch what they have to avoid, wherever
        they join the path; with key "output.gcode.compensation" if that asks for longer ones.
    """
    size = room
    places = [started(path, index) for index in flattest(path)]
    if place is not None:
        places = [begun(path, place)]
    while size >= SMALLEST_SHARE * room:
        for there in places:
            lead = lead_at(there, size, beside)
            if lead is not None:
                return there, lead
        size /= 2.0
    if beside.aside:
        raise GeometryError(
            "there is no room next to the outline for leads with a line of"
            f" {ASIDE * beside.aside:g} mm, in which the controller takes up the cutter's radius;"
            ' "wear" needs less',
            key="output.gcode.compensation",
            value='"control"',
        )
    raise GeometryError(
        "there is no room for a tangential lead-in next to the outline; a smaller cutter may help",
        key="tool",
    )


def lead_at(path: Contour, room: float, beside: Beside) -> Lead | None:
    """Leads where the path begins, as of `joined`; None if they do not fit."""
    track = Track.around(path)
    bend = max(_bend(path, piece, beside.free) for piece in (0, -1))
    lead = _lead(track, room, bend, beside)
    if lead is None or not _keeps_off(lead, beside.avoid):
        return None
    near = [min(NEAR * lead.off.length, 0.5 * float(path.lengths[k])) for k in (0, -1)]
    ways = (lead.off, near[0]), (lead.into.reversed(), near[1])
    fits = all(_is_clear(path, track, way, skip, beside.free) for way, skip in ways)
    return lead if fits else None


def _bend(path: Contour, piece: int, free: int) -> float:
    """Curvature [1/mm] of a piece towards the free side."""
    sweep = float(path.sweeps[piece])
    return math.copysign(1.0, free * sweep) / float(path.radii[piece]) if sweep else 0.0


def _lead(path: Track, room: float, bend: float, beside: Beside) -> Lead | None:
    """Leads at the beginning of the path that go `room` [mm] off it, or a quarter turn; None if
    they need more.

    `bend` is the curvature [1/mm] of the path there, positive towards the free side: then they go
    up to half its radius off it, by as much of a turn as that takes.
    """
    point, along, free = path.start, path.headings[0], beside.free
    if bend > 0.0:
        room = min(room, FARTHEST / bend)
    lift = room - ASIDE * beside.aside if beside.aside else room * (0.5 if beside.straight else 1.0)
    if lift <= 0.0:
        return None
    # An arc of radius r that turns by t is r (1 - cos t) off a straight path: a quarter turn in
    # wide room, a flatter and larger arc in a narrow one.
    radius = max(lift, min(beside.usual, lift / (1.0 - math.cos(LEAST_TURN))))
    if bend > 0.0:
        radius = min(radius, TIGHTEST / bend)
    # A line at the angle of a flat lead's end, which gets the rest of the room off it.
    flat = math.acos(max(1.0 - lift / radius, 0.0))
    line = ASIDE * beside.aside if beside.aside else (room - lift) / math.sin(flat)
    # The end of the line is so far from the middle of the arc, and so much farther round it.
    arm, ahead = math.hypot(radius, line), math.atan2(line, radius)
    cosine, most = (radius - room) / arm, 0.5 * math.pi
    if bend:
        # Off a round path of radius p, negative where it bends away: by the triangle with sides
        # p - r, the arm and p - room.
        side, far = 1.0 / bend - radius, 1.0 / bend - room
        cosine = (far * far - side * side - arm * arm) / (2.0 * side * arm)
        most = math.pi if bend > 0.0 else most
    turn = math.acos(min(max(cosine, -1.0), 1.0)) - ahead
    turn = min(max(turn, 0.1 * LEAST_TURN), most)
    centre = point + free * 1j * along * radius
    off = Track.arc(point, centre, free * turn)
    into = Track.arc(point, centre, -free * turn).reversed()
    if not line:
        return Lead(into, off)
    onto, away, across = into.headings[0], off.headings[1], -free * 1j * beside.aside
    before = Track.line(into.start - (line - across) * onto, into.start)
    behind = Track.line(off.end, off.end + (line + across) * away)
    return Lead(chained((before, into)), chained((off, behind)))


def _is_clear(path: Contour, track: Track, way: Track, near: float, free: int) -> bool:
    """Whether a way off the path, beyond its first part `near` [mm], stays on the free side.

    In the first part the curvatures decide: the lead bends away from the path.
    """
    if least_distance(way.between(near, way.length), track) == 0.0:
        return False
    # Counter-clockwise a path has its inside on the left.
    inside = winding_number(path, way.end) != 0
    return inside == ((path.area > 0.0) == (free > 0))


def _keeps_off(lead: Lead, avoid: Sequence[tuple[Track, float]]) -> bool:
    return all(
        least_distance(each, track) >= apart
        for track, apart in avoid
        for each in (lead.into, lead.off)
    )
