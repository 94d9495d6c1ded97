"""Moves of one operation, as a strategy adds them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Final, TypeVar

import numpy as np

from camgeo.errors import GeometryError, UndercutError
from camgeo.geometry.contour.contour import Contour, least_distance
from camgeo.milling.cut import AreaCut, Cut, roughing_slack
from camgeo.milling.milling import Heights, ToolError
from camgeo.milling.moves import ArcFeed, Feed, Move, Rapid, too_long
from camgeo.milling.track import Track
from camgeo.part.part import Boundary
from camgeo.reading import PROGRAM_LINES

SHORTEST = 0.05
"""Least length of a piece that is made by dividing another [mm]."""

SAME = 1e-9
"""Places and heights [mm] that differ by less are one."""


CutKind = TypeVar("CutKind", bound=Cut)


def cut_of_kind(cut: Cut, kind: type[CutKind], does: str) -> CutKind:
    """The cut, if it is one of the `kind` that its strategy `does`; else TypeError."""
    if not isinstance(cut, kind):
        raise TypeError(f"{cut.name}: the strategy {cut.strategy} {does}")
    return cut


class ToolpathBuilder:
    """Builds the moves of one operation, and knows where the cutter is.

    Attributes
    ----------
    cut : the operation.
    heights : of its traverses.
    moves : in order.
    place, z : of the cutter's tip [mm].
    """

    def __init__(self, cut: Cut, heights: Heights) -> None:
        self.cut = cut
        self.heights = heights
        self.moves: list[Move] = []
        self.place = 0j
        self.z = heights.clearance
        self._blocked = [
            (obstacle, Track.around(obstacle.outline.arcs(0.01, "fast").contour))
            for obstacle in cut.obstacles
        ]

    @property
    def free(self) -> int:
        """The side of a path along a wall that is free of the wall: 1 left, -1 right."""
        return 1 if self.cut.climb else -1

    def avoid(self, bottom: float) -> tuple[tuple[Track, float], ...]:
        """Outlines of what a cutter at `bottom` must clear, and by how much [mm]."""
        return tuple(
            (track, self.cut.tool.radius)
            for obstacle, track in self._blocked
            if bottom < obstacle.top
        )

    def traverse(self, place: complex) -> None:
        """Rise to the clearance height, unless the cutter is there, and traverse to `place`."""
        if self.moves and self.z < self.heights.clearance:
            self._rapid(Rapid, self.place, self.heights.clearance)
        self._rapid(Rapid, place, self.heights.clearance)

    def link(self, place: complex, around: Track | None = None) -> None:
        """Move to `place` [mm] for the next depth: straight through what this depth has cleared; by
        a traverse at the beginning, and where the way would cross the path `around` the part.
        """
        link = Track.line(self.place, place)
        if self.moves and (around is None or least_distance(link, around) > 0.0):
            self.follow(link)
        else:
            self.traverse(place)

    def lower(self, z: float, feed: float | None = None) -> None:
        """Move straight down to `z` [mm], through air or where the tool may plunge; rapidly only
        down to the retract height.
        """
        if self.z > self.heights.retract > z:
            self._rapid(Rapid, self.place, self.heights.retract)
        if z < self.z - SAME:
            self._require_clear(Track.line(self.place, self.place), z)
            self.moves.append(Feed(_point(self.place, z), feed or self.cut.tool.plunge_feed))
            self.z = z

    def retract(self) -> None:
        """Rise straight to the retract height."""
        self._rapid(Rapid, self.place, self.heights.retract)

    def lift(self) -> None:
        """Rise straight to the clearance height."""
        self._rapid(Rapid, self.place, self.heights.clearance)

    def follow(
        self,
        track: Track,
        z: float | None = None,
        *,
        both: bool = False,
        air: bool = False,
        feed: float | None = None,
        switch: str = "",
    ) -> None:
        """Feed along `track`, descending or rising evenly to `z` [mm] if that is given.

        With a `switch` the track is one line, which switches the controller's compensation so.

        The feed is that at the contact with a wall on the side of the material, or on both sides:
        the centre is slowed on arcs around whose outside the wall lies. The plunge feed limits
        that along Z. In `air` there is no contact, and the centre runs at the tool's feed.

        Raises
        ------
        GeometryError
            With key "holding", if the cutter would touch a clamp or a screw.
        FileError
            If there are more moves than lines are allowed in a program that is read.
        """
        if len(self.moves) + len(track) > PROGRAM_LINES:
            raise too_long()
        start = self.z
        end = start if z is None else z
        self._require_clear(track, min(start, end))
        whole = track.length
        if whole <= 0.0:
            return
        travelled = 0.0
        base = self.cut.tool.feed if feed is None else feed
        track = track.halved()  # an `ArcFeed` is at most half a turn
        for point, sweep, centre, length in zip(
            track.ends.tolist(),
            track.sweeps.tolist(),
            track.centres.tolist(),
            track.lengths.tolist(),
            strict=True,
        ):
            travelled += length
            # At the end exactly, as the sum of lengths is off by rounding.
            height = end if travelled >= whole - SAME else start + (end - start) * travelled / whole
            rate = base
            if sweep and not air:
                # The wall lies on the side of the material: where the path turns to the free side,
                # the wall encloses the arc, and the contact is faster than the centre.
                inside = both or (sweep > 0.0) == (self.free > 0)
                rate = centre_feed(
                    base, length / abs(sweep), self.cut.contact_radius, inside=inside
                )
            drop = self.z - height
            if drop > SAME:
                # The feed along Z is the share drop / length in space of the feed along the path.
                rate = min(rate, self.cut.tool.plunge_feed * math.hypot(length, drop) / drop)
            if sweep:
                middle = (centre.real, centre.imag)
                self.moves.append(ArcFeed(_point(point, height), middle, sweep > 0.0, rate))
            else:
                self.moves.append(Feed(_point(point, height), rate, switch))
            self.place, self.z = point, height

    def follow_heights(
        self, track: Track, stops: Sequence[tuple[float, float]], *, both: bool = False
    ) -> None:
        """Feed along `track` at the heights that `stops` state: pairs (distance along it, z) [mm],
        ascending from 0 to its length, with straight lines between them.

        Where a height changes within `SHORTEST` of a joint of the track, it does so at the joint.
        """
        joints = np.concatenate(([0.0], np.cumsum(track.lengths)))
        # Distances from every stop to every joint: (stops, joints).
        places = np.array([place for place, _ in stops])
        nearest = joints[np.argmin(np.abs(places[:, None] - joints), axis=1)]
        places = np.where(np.abs(nearest - places) < SHORTEST, nearest, places)
        for (start, end), (_, z) in zip(pairwise(places.tolist()), stops[1:], strict=True):
            if end > start:
                self.follow(track.section(start, end), z, both=both)

    def _require_clear(self, track: Track, bottom: float) -> None:
        for obstacle, outline in self._blocked:
            if (
                bottom < obstacle.top
                and least_distance(track, outline) < self.cut.tool.radius - SAME
            ):
                raise GeometryError(
                    f"the cutter of {self.cut.name} would touch the {obstacle.name}", key="holding"
                )

    def _rapid(self, kind: type[Rapid], place: complex, z: float) -> None:
        if not self.moves or abs(place - self.place) > SAME or abs(z - self.z) > SAME:
            self.moves.append(kind(_point(place, z)))
        self.place, self.z = place, z


def _point(place: complex, z: float) -> tuple[float, float, float]:
    return float(place.real), float(place.imag), z


# -- area -----------------------------------------------------------------------------------------
# What the strategies that clear areas share: coarse paths along walls, proved to keep off them.


SPENT: Final = 3.0
"""Tolerances by which a roughing path is moved off the wall: its last round deviates by one, the
spiral before it by another, and the wall in the proof by the third."""


STEEPER: Final = 3.0
"""How much faster than on a straight wall the engagement may grow with the depth of cut, where the
curvature of the wall jumps."""

EQUAL: Final = 1e-9
"""Rounding of a distance [mm]."""


def coarse(cut: AreaCut, tolerance: float) -> float:
    """Tolerance of roughing paths [mm], at least that of the program."""
    return max(tolerance, roughing_slack(cut.allowance))


def engagement_limit(cut: AreaCut, tolerance: float) -> float:
    """Largest engagement to plan for [rad], so that it holds for arcs within `tolerance` [mm].

    Where the tool states none it is that on a straight wall at the stepover.
    """
    radius, step = cut.tool.radius, cut.stepover
    limit = cut.tool.engagement or math.acos(max(-1.0, 1.0 - step / radius))
    # On a straight wall cos(limit) = 1 - depth / radius, so the angle grows by depth / (radius
    # sin(limit)); this turn of the path and the one before may each be a tolerance off.
    steep = radius * math.sin(min(limit, 0.5 * math.pi))
    return max(0.5 * limit, limit - STEEPER * 2.0 * tolerance / steep)


def centre_feed(feed: float, radius: float, tool_radius: float, *, inside: bool) -> float:
    """Feed of the centre [mm/min] for at most `feed` at the contact.

    Along a wall around the arc's centre at `radius` + `tool_radius` (`inside`), the contact runs
    faster than the centre in this ratio, so the centre is slowed. Along a wall that it runs around
    the outside of, the contact is the slower of the two, and the feed stays.

    Parameters
    ----------
    radius : of the centre's arc [mm], above 0.
    """
    return feed * radius / (radius + tool_radius) if inside else feed


def along(wall: Boundary, cut: AreaCut, tolerance: float, farther: float = 0.0) -> Contour:
    """The path of the cutter's centre along a wall, off it by the allowance and `farther` [mm],
    counter-clockwise and within the coarse `tolerance` [mm].

    Raises
    ------
    GeometryError
        With key "tool", if the cutter does not reach the whole wall.
    """
    distance = cut.tool.radius + cut.allowance + farther + SPENT * tolerance
    try:
        return wall.offset(distance).arcs(tolerance, "fast").contour
    except UndercutError as error:
        raise GeometryError(
            f"the cutter is too large for the {wall.name}, along which its centre has to run at a"
            f" distance of {distance:g} mm ({error.message})",
            key="tool",
        ) from None


def require_clear(track: Track, wall: Boundary, cut: AreaCut, tolerance: float) -> None:
    """Prove that a cutter on `track` keeps off the wall by the allowance.

    Raises
    ------
    GeometryError
        With key "toolpath", if it does not.
    """
    fit = wall.arcs(tolerance, "fast")
    distance = least_distance(track, Track.around(fit.contour)) - fit.deviation
    if distance < cut.tool.radius + cut.allowance - EQUAL:
        short = cut.tool.radius + cut.allowance - distance
        raise GeometryError(f"{cut.name} comes {short:.3g} mm too near to the wall", "toolpath")


# -- descent ---------------------------------------------------------------------------------------
# Down along a closed track, no steeper than the tool may run.


MOST_ROUNDS = 1000
"""Most rounds of one descent along a path; if more are needed, the ramp is far too flat."""

RAMP = math.radians(3.0)
"""Angle [rad] of the descent into material if the tool states none."""


def ramp_angle(cut: Cut) -> float:
    """Steepest descent of the cut's tool into material [rad]."""
    return RAMP if cut.tool.ramp_angle is None else cut.tool.ramp_angle


def descent(cut: Cut, top: float, bottom: float, length: float) -> list[float]:
    """Z [mm] at the end of each round of `length` [mm] from `top` to `bottom`, evenly.

    No round is steeper than the tool may run.

    Raises
    ------
    GeometryError
        If these are more than `MOST_ROUNDS`.
    """
    rounds = math.ceil((top - bottom - SAME) / (length * math.tan(ramp_angle(cut))))
    if rounds > MOST_ROUNDS:
        least = math.degrees(math.atan((top - bottom) / (MOST_ROUNDS * length)))
        raise ToolError(
            f"the descent of {cut.name} takes more than {MOST_ROUNDS} rounds of {length:.3g} mm:"
            f" the ramp of {math.degrees(ramp_angle(cut)):g} degrees is too flat for it; at least"
            f" {least:.3g} are needed",
            cut.tool,
            "ramp_angle",
        )
    # The last height is `bottom` exactly; without rounds, where top is bottom, the list is empty.
    step = (bottom - top) / max(rounds, 1)
    return [*(top + step * k for k in range(1, rounds)), bottom][:rounds]


def descend(builder: ToolpathBuilder, round_: Track, top: float, bottom: float) -> None:
    """Descend along a closed track from `top` to `bottom` [mm]; the first descent of an operation
    begins with a traverse to above it.
    """
    if not builder.moves:
        builder.traverse(round_.start)
        builder.lower(top)
    for z in descent(builder.cut, top, bottom, round_.length):
        builder.follow(round_, z)
