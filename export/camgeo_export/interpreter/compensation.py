"""Radius compensation that the control computes: what controls refuse, and what would gouge.

The rules are LinuxCNC's (docs/src/gcode/tool-compensation.adoc); other controls have the same ones,
or run what breaks them with a gouge.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final

from camgeo.numeric.arrays import phase
from camgeo.units import TURN
from camgeo_export.gcode.moves import CutterMove
from camgeo_export.interpreter.iso import Findings

TANGENT: Final = 1e-3
"""Change of direction [rad] up to which two moves go on in one another: printed arcs kink so."""

RIGHT: Final = 0.5 * math.pi

SLACK: Final = 1e-9
"""Of a share of a move."""


def kept(side: str, radius: float) -> tuple[str, float]:
    """Side of the path and distance from it [mm], for a negative offset on the other side."""
    if radius < 0.0:
        return {"left": "right", "right": "left"}[side], -radius
    return side, radius


class Compensator:
    """Follows the moves under compensation."""

    def __init__(self, findings: Findings) -> None:
        self._findings = findings
        self._entering = False
        self._before: Parallel | None = None
        self._begun = 0.0

    def enter(self) -> None:
        """Compensation was switched on."""
        self._entering, self._before, self._begun = True, None, 0.0

    def take(self, move: CutterMove, side: str, radius: float) -> None:
        """Judge a move under compensation.

        `radius` is that of the cutter [mm], negative for the other side, NaN if it is not known.
        """
        if move.start == move.end and move.kind != "arc":
            return  # along Z
        side, radius = kept(side, radius)
        if self._entering:
            self._entering = False
            if move.kind == "arc":
                self._add(move, "compensation", "compensation begins with an arc")
            else:
                self._check_length(move, "enters", radius)
                self._before = Parallel(move, 1.0 if side == "left" else -1.0, radius)
            return
        parallel = Parallel(move, 1.0 if side == "left" else -1.0, radius)
        if move.kind == "arc" and parallel.room <= 0.0:
            size = abs(move.start - move.centre)
            what = "an inner arc that is not larger than the cutter"
            self._add(move, "gouge", what, f"radius {size:g} mm", f"above {radius:g} mm")
            self._before, self._begun = None, 0.0
            return
        if math.isfinite(radius):
            self._corner(parallel)
        self._before = parallel

    def leave(self, move: CutterMove, radius: float) -> None:
        """Judge the first move after compensation, with the `radius` [mm] as in `take`."""
        radius = abs(radius)
        if move.kind == "arc":
            what = "an arc right after the end of compensation"
            self._add(move, "compensation", what, "", "a straight move")
        elif move.start != move.end:
            self._check_length(move, "leaves", radius)
        self._before, self._begun = None, 0.0

    def _check_length(self, move: CutterMove, does: str, radius: float) -> None:
        length = abs(move.end - move.start)
        if length <= radius:
            what = f"the move that {does} compensation is not longer than the cutter's radius"
            self._add(move, "compensation", what, f"{length:g} mm", f"above {radius:g} mm")

    def _corner(self, after: Parallel) -> None:
        """Judge the corner between the move before and this one, if it is an inner one."""
        before, begun = self._before, self._begun
        self._begun = 0.0
        if before is None or before.move.end != after.move.start:
            return
        corner = after.move.start
        turn = phase(after.heading(corner) / before.heading(corner)) * after.side
        rounding = before.move.mismatch + after.move.mismatch
        # A corner that is cut off by no more than numbers are rounded is none.
        if turn <= TANGENT or after.radius * turn * turn / 8.0 <= rounding:
            return
        point = meeting(before, after)
        if point is not None:
            left, self._begun = before.share(point), after.share(point)
            # Parallels that meet at a small angle do so elsewhere where they are rounded.
            off = 2.0 * rounding / math.sin(min(turn, RIGHT))
            one, other = (SLACK + off / each.length for each in (before, after))
            if begun - one <= left <= 1.0 + one and -other <= self._begun <= 1.0 + other:
                return
        self._begun = 0.0
        what = "an inner corner that the cutter cannot reach without gouging"
        shorter = min(before.length, after.length)
        value = f"a move of {shorter:g} mm at a turn of {math.degrees(turn):.0f} deg"
        self._add(after.move, "gouge", what, value, f"for a cutter of radius {after.radius:g} mm")

    def _add(
        self, move: CutterMove, rule: str, what: str, value: str = "", allowed: str = ""
    ) -> None:
        self._findings.add(move.line, rule, what, value, allowed)


# -- centre ---------------------------------------------------------------------------------------
# The path of the cutter's centre where the control compensates for its radius.
#
# As LinuxCNC runs it (src/emc/rs274ngc/interp_convert.cc), and other controls but for what they do
# around outer corners: the straight move that enters ends beside its end, inner corners are cut
# where the parallels meet, outer ones are rounded, and the move after the compensation leads to
# where it is programmed.


FAR: Final = 4.0
"""Parallels of neighbours that meet farther from their corner than this many radii do not."""

Radius = Callable[[CutterMove], float]
"""Offset of a compensated move [mm]; negative for the other side, NaN if it is not known."""


def centres(moves: Sequence[CutterMove], radius: Radius) -> tuple[CutterMove, ...]:
    """The same moves along the cutter's centre; where the offset is 0 they are unchanged."""
    found: list[CutterMove] = []
    for run, after in _runs(moves):
        size = radius(run[0]) if run else 0.0
        if size == 0.0:
            found += run
        elif run:
            found += _displaced(run, size)
        if after is not None:
            found.append(replace(after, start=found[-1].end) if run and size else after)
    return tuple(found)


def judge(moves: Sequence[CutterMove], radius: Radius, findings: Findings) -> None:
    """Find what controls refuse in compensated moves, and what would gouge, with these offsets."""
    for run, after in _runs(moves):
        if not run:
            continue
        compensator = Compensator(findings)
        compensator.enter()
        for move in run:
            compensator.take(move, move.compensation, radius(move))
        if after is not None:
            compensator.leave(after, radius(run[0]))


def _runs(
    moves: Iterable[CutterMove],
) -> Iterator[tuple[list[CutterMove], CutterMove | None]]:
    """Stretches of compensated moves, each with the move after it; single other moves likewise."""
    run: list[CutterMove] = []
    for move in moves:
        if move.compensation:
            run.append(move)
        else:
            yield run, move
            run = []
    if run:
        yield run, None


def _displaced(run: Sequence[CutterMove], radius: float) -> Iterator[CutterMove]:
    side, size = kept(run[0].compensation, radius)
    sign = 1.0 if side == "left" else -1.0
    flat = [move for move in run if move.start != move.end or move.kind == "arc"]
    parallels = iter([Parallel(move, sign, size) for move in flat])
    after = next(parallels, None)
    before: Parallel | None = None
    at = run[0].start
    for move in run:
        if move.start == move.end and move.kind != "arc":
            yield replace(move, start=at, end=at)  # along Z
            continue
        assert after is not None
        own, after = after, next(parallels, None)
        if before is not None and (turn := _turn(before, own)) < -TANGENT:
            point = own.beside(move.start)
            yield replace(
                move, kind="arc", start=at, end=point, z_end=move.z_start, centre=move.start,
                sweep=turn * sign,
            )  # fmt: skip
            at = point
        end = own.beside(move.end) if after is None else _joint(own, after)
        centre, sweep, mismatch = move.centre, 0.0, 0.0
        if move.kind == "arc":
            arms = at - centre, end - centre
            turned = phase(arms[1] / arms[0]) if arms[0] else 0.0
            sweep = turned + 2.0 * math.pi * round((move.sweep - turned) / (2.0 * math.pi))
            mismatch = max(move.mismatch, abs(abs(arms[1]) - abs(arms[0])))
        yield replace(move, start=at, end=end, sweep=sweep, mismatch=mismatch)
        at, before = end, own


def _turn(before: Parallel, after: Parallel) -> float:
    """Change of direction at a corner [rad], positive towards the cutter: an inner one."""
    corner = after.move.start
    return phase(after.heading(corner) / before.heading(corner)) * after.side


def _joint(before: Parallel, after: Parallel) -> complex:
    """Where the parallel of a move ends, before another one."""
    corner, turn = after.move.start, _turn(before, after)
    end = before.beside(corner)
    if turn < -TANGENT:
        return end
    if turn > TANGENT:
        point = meeting(before, after)
        if point is not None and abs(point - corner) <= FAR * before.radius:
            return point
    return end


# -- offsets --------------------------------------------------------------------------------------
# Parallels of single moves, and where those of two neighbours meet.


@dataclass(frozen=True, slots=True)
class Parallel:
    """The path of a cutter's centre beside a straight or circular move.

    Attributes
    ----------
    move : programmed.
    side : +1 for the cutter on the left, -1 on the right.
    radius : of the cutter [mm].
    """

    move: CutterMove
    side: float
    radius: float

    @property
    def length(self) -> float:
        """Of the programmed move."""
        move = self.move
        if move.kind == "arc":
            return abs(move.sweep) * abs(move.start - move.centre)
        return abs(move.end - move.start)

    @property
    def room(self) -> float:
        """Radius of an arc's parallel; not above 0 where the cutter does not fit into it."""
        move = self.move
        inner = self.side if move.sweep > 0.0 else -self.side
        return abs(move.start - move.centre) - inner * self.radius

    def heading(self, point: complex) -> complex:
        """Direction at a point of the programmed move, of length 1."""
        move = self.move
        if move.kind == "arc":
            arm = (point - move.centre) * (1j if move.sweep > 0.0 else -1j)
        else:
            arm = move.end - move.start
        return arm / abs(arm) if arm else 1.0 + 0j

    def beside(self, point: complex) -> complex:
        """The centre of the cutter beside a point of the programmed move."""
        return point + self.side * 1j * self.heading(point) * self.radius

    def share(self, centre: complex) -> float:
        """How far along the move a point of its parallel is, as a share of it."""
        move = self.move
        if move.kind != "arc":
            way = move.end - move.start
            return ((centre - move.start) / way).real
        turned = phase((centre - move.centre) / (move.start - move.centre))
        sign = 1.0 if move.sweep > 0.0 else -1.0
        along = (sign * turned) % TURN
        # Just before the start counts as that, not as a turn less.
        along = along - TURN if along > 0.5 * (abs(move.sweep) + TURN) else along
        return along / abs(move.sweep)


def meeting(before: Parallel, after: Parallel) -> complex | None:
    """Where the parallels of two neighbours meet, next to their corner; None if they do not."""
    corner = after.move.start
    first, second = before.move.kind == "arc", after.move.kind == "arc"
    if first and second:
        found = _circles(before.move.centre, before.room, after.move.centre, after.room)
    elif first or second:
        line, arc = (after, before) if first else (before, after)
        point = line.beside(line.move.start)
        found = _line_and_circle(point, line.heading(point), arc.move.centre, arc.room)
    else:
        found = _lines(before, after)
    return min(found, key=lambda point: abs(point - corner), default=None)


def _lines(before: Parallel, after: Parallel) -> list[complex]:
    way, other = before.heading(0j), after.heading(0j)
    across = (way.conjugate() * other).imag
    if abs(across) < 1e-12:  # straight on, or straight back
        return []
    gap = after.beside(after.move.start) - before.beside(before.move.start)
    return [before.beside(before.move.start) + way * (gap.conjugate() * other).imag / across]


def _line_and_circle(point: complex, way: complex, centre: complex, radius: float) -> list[complex]:
    rest = (point - centre) / way
    square = radius * radius - rest.imag * rest.imag
    if square < 0.0:
        return []
    foot, half = centre + way * complex(0.0, rest.imag), math.sqrt(square)
    return [foot + way * half, foot - way * half]


def _circles(centre: complex, radius: float, other: complex, size: float) -> list[complex]:
    gap = other - centre
    apart = abs(gap)
    if apart == 0.0:
        return []
    along = (radius * radius - size * size + apart * apart) / (2.0 * apart)
    square = radius * radius - along * along
    if square < 0.0:
        return []
    way = cmath.rect(1.0, phase(gap))
    return [centre + way * complex(along, sign * math.sqrt(square)) for sign in (1.0, -1.0)]
