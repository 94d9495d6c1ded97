"""Moves of a milling program that was read, the closed paths that they form, and the rules that it
breaks.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, Literal

import numpy as np

from camgeo.design.linting import LineFinding
from camgeo.errors import FileError
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.contour.spline import Arc
from camgeo.milling.milling import MIRRORED_SIDE
from camgeo.milling.moves import Zero
from camgeo.numeric.arrays import IntArray, phase
from camgeo.reading import PROGRAM, beyond
from camgeo.units import TURN, counted

if TYPE_CHECKING:
    from shapely import STRtree

Kind = Literal["rapid", "line", "arc"]

LEAST_LENGTH = 30.0
"""Least length of a run that is closed with a gap, as a multiple of the gap."""

NEAR: Final = 2_000_000
"""Most pairs of moves, the end of one near the start of the other, that may close a path."""


PATHS: Final = 10_000
"""Most closed paths of a program."""


@dataclass(frozen=True, slots=True, eq=False)
class CutterMove:
    """One move; lengths in mm, feed in mm/min.

    Attributes
    ----------
    kind : "rapid", "line" or "arc".
    start, end : (x + iy); nan + nan i until the program has set a position.
    z_start, z_end : heights; infinite at the machine's reference.
    centre : of an arc.
    sweep : angle turned along an arc [rad], positive counter-clockwise.
    mismatch : difference of an arc's radii at its ends.
    feed : 0 for a traverse.
    speed : of the spindle [rev/min], negative counter-clockwise; 0 while it stands still.
    operation : the last one named by a comment.
    tool : number of the current one; 0 before the first change.
    offset : number of the tool whose length is compensated; 0 before the first.
    line : in the file, counted from 1.
    compensation : side of the path on which the control keeps the cutter, "left" or "right", or
        empty: then the path is that of its centre.
    radius_offset : number of the offset with which it does so; 0 without.
    oversize : what the program adds to the radius of that offset [mm].
    coolant : "flood", "mist", "through" or "off".
    work_offset : word of the work offset, e.g. "G54"; empty before one is stated.
    """

    kind: Kind
    start: complex
    end: complex
    z_start: float
    z_end: float
    centre: complex
    sweep: float
    mismatch: float
    feed: float
    speed: float
    operation: str
    tool: int
    offset: int
    line: int
    compensation: str = ""
    radius_offset: int = 0
    oversize: float = 0.0
    coolant: str = "off"
    work_offset: str = ""

    @property
    def course(self) -> Arc:
        """The line or arc of the move in the plane."""
        return Arc(self.start, self.end, self.sweep, self.centre)


@dataclass(frozen=True, slots=True, eq=False)
class Event:
    """What a program does between moves.

    Attributes
    ----------
    kind : "tool change", "spindle off", "stop", "dwell" or "end".
    word : that does it.
    place, z : position [mm]; NaN where unknown, infinite at the reference.
    tool : number of the one in the spindle, after a change of it.
    seconds : of a dwell.
    line : in the file, counted from 1.
    """

    kind: str
    word: str
    place: complex
    z: float
    tool: int
    seconds: float
    line: int


@dataclass(frozen=True, slots=True, eq=False)
class Loop:
    """A closed run of cuts.

    Attributes
    ----------
    operation : its name.
    z : least height [mm].
    level : whether all of it runs at that height.
    contour : path of the tool centre in the direction of cutting; arcs meet their end points.
    mismatch : largest difference of radii [mm]: the controller's path lies within it of `contour`.
    """

    operation: str
    z: float
    level: bool
    contour: Contour
    mismatch: float


def nearly_closed(run: list[CutterMove], gap: float) -> list[Loop]:
    """The part of an open run that comes back to within `gap` [mm] of its beginning, if any."""
    if not gap or not run:
        return []
    import shapely

    starts = np.array([move.start for move in run])
    ends = np.array([move.end for move in run])
    along = np.cumsum([0.0, *(move.course.length for move in run)])
    tree = shapely.STRtree(np.asarray(shapely.points(starts.real, starts.imag)))
    last, first = _near(tree, np.asarray(shapely.points(ends.real, ends.imag)), gap)
    # A run that is hardly longer than the gap always ends near its start.
    long = (last >= first) & (along[last + 1] - along[first] >= LEAST_LENGTH * gap)
    if not np.any(long):
        return []
    first, last = first[long], last[long]
    best = int(np.argmin(np.abs(starts[first] - ends[last])))
    closing_gap = abs(starts[first[best]] - ends[last[best]])
    return [make_loop(run[first[best] : last[best] + 1], float(closing_gap))]


def _near(tree: STRtree, points: np.ndarray[Any, Any], gap: float) -> tuple[IntArray, IntArray]:
    """Pairs of `points` and points of the `tree` within `gap` [mm] of each other, by their numbers.

    Raises FileError if there are too many such pairs: then the moves of the program are far shorter
    than the gap.
    """
    batches: list[IntArray] = []
    left, some = NEAR, max(NEAR // len(points), 1)
    for first in range(0, len(points), some):
        pairs = tree.query(points[first : first + some], predicate="dwithin", distance=gap)
        left -= pairs.shape[1]
        if left < 0:
            raise FileError(
                f"more than {NEAR:,} pairs of moves lie within the tolerance {gap:g} mm of each"
                " other: closed paths cannot be distinguished"
            )
        batches.append(pairs + np.array([[first], [0]]))
    last, earlier = np.concatenate(batches, axis=1)
    return last, earlier


def make_loop(run: list[CutterMove], gap: float) -> Loop:
    """The closed path of a run of moves, with a `gap` [mm] at its end."""
    vertices = np.array([move.start for move in run])
    sweeps = np.array([move.sweep for move in run])
    mismatch = max(move.mismatch for move in run) + gap
    heights = {run[0].z_start, *(move.z_end for move in run)}
    contour = Contour.through(vertices, sweeps)
    return Loop(run[0].operation, min(heights), len(heights) == 1, contour, mismatch)


# -- loops ----------------------------------------------------------------------------------------
# The closed paths that the moves of a program run in the plane, level or not.


def closed_paths(moves: Iterable[CutterMove], gap: float = 0.0) -> list[Loop]:
    """Closed runs of cuts in the plane; leads into and out of them are omitted.

    A run that ends up to `gap` [mm] from where it began is closed, too; its mismatch is larger by
    that. The cutter may come down along a run, or be lifted over tabs; where it moves along Z alone
    or traverses, the run ends.
    """
    loops: list[Loop] = []
    run: list[CutterMove] = []
    # A point already visited closes a loop; the search then starts again, so that a path which
    # overlaps its beginning is found once, and no loop contains another.
    reached: dict[complex, int] = {}
    for move in moves:
        cuts = move.kind != "rapid" and not (move.start == move.end and move.sweep == 0.0)
        cuts = cuts and not (cmath.isnan(move.start) or math.isnan(move.z_start))
        if not cuts or (run and run[-1].operation != move.operation):
            loops += nearly_closed(run, gap)
            run, reached = [], {}
        if not cuts:
            continue
        reached[move.start] = len(run)
        run.append(move)
        if len(loops) > PATHS:
            raise beyond("the program", counted(len(loops), "closed path"), PATHS, PROGRAM)
        if move.end in reached:
            loops.append(make_loop(run[reached[move.end] :], 0.0))
            run, reached = [], {}
    return loops + nearly_closed(run, gap)


# -- compensation ---------------------------------------------------------------------------------
# Radius compensation that the control computes: what controls refuse, and what would gouge.


TANGENT: Final = 1e-3
"""Change of direction [rad] up to which two moves are tangent: printed arcs have such kinks."""

RIGHT: Final = 0.5 * math.pi

SLACK: Final = 1e-9
"""Tolerated error of a place along a move, as a share of its length."""


class Compensator:
    """Follows the moves from where compensation was switched on."""

    def __init__(self, findings: Findings) -> None:
        self._findings = findings
        self._entering = True
        self._previous: Parallel | None = None
        self._begun = 0.0

    def take(self, move: CutterMove, side: str, radius: float) -> None:
        """Check a move under compensation.

        `radius` is that of the cutter [mm], negative for the other side, NaN if it is not known.
        """
        if move.start == move.end and move.kind != "arc":
            return  # along Z
        parallel = move_parallel(move, side, radius)
        radius = parallel.radius
        if self._entering:
            self._entering = False
            if move.kind == "arc":
                self._findings.add(move.line, "compensation", "compensation begins with an arc")
            else:
                self._check_length(move, "enters", radius)
                self._previous = parallel
            return
        if move.kind == "arc" and parallel.room <= 0.0:
            size = abs(move.start - move.centre)
            what = "an inner arc whose radius is not larger than that of the cutter"
            self._findings.add(
                move.line, "gouge", what, f"radius {size:g} mm", f"above {radius:g} mm"
            )
            self._previous, self._begun = None, 0.0
            return
        if math.isfinite(radius):
            self._corner(parallel)
        self._previous = parallel

    def leave(self, move: CutterMove, radius: float) -> None:
        """Check the first move after compensation, with the `radius` [mm] as in `take`."""
        radius = abs(radius)
        if move.kind == "arc":
            what = "an arc right after the end of compensation"
            self._findings.add(move.line, "compensation", what, "", "a straight move")
        elif move.start != move.end:
            self._check_length(move, "leaves", radius)
        self._previous, self._begun = None, 0.0

    def _check_length(self, move: CutterMove, does: str, radius: float) -> None:
        length = abs(move.end - move.start)
        if length <= radius:
            what = f"the move that {does} compensation is not longer than the cutter's radius"
            self._findings.add(
                move.line, "compensation", what, f"{length:g} mm", f"above {radius:g} mm"
            )

    def _corner(self, following: Parallel) -> None:
        """Check the corner between the previous move and this one, if it is an inner one."""
        previous, begun = self._previous, self._begun
        self._begun = 0.0
        if previous is None or previous.move.end != following.move.start:
            return
        turn = _turn(previous, following)
        rounding = previous.move.mismatch + following.move.mismatch
        # A corner that is cut off by no more than numbers are rounded is none.
        if turn <= TANGENT or following.radius * turn * turn / 8.0 <= rounding:
            return
        point = meeting(previous, following)
        if point is not None:
            left, self._begun = previous.share(point), following.share(point)
            # Rounding shifts where parallels meet, by more the smaller their angle is.
            allowance = 2.0 * rounding / math.sin(min(turn, RIGHT))
            one, other = (SLACK + allowance / parallel.length for parallel in (previous, following))
            if begun - one <= left <= 1.0 + one and -other <= self._begun <= 1.0 + other:
                return
        self._begun = 0.0
        what = "an inner corner that the cutter cannot reach without gouging"
        shorter = min(previous.length, following.length)
        value = f"a move of {shorter:g} mm at a change of direction of {math.degrees(turn):.0f} deg"
        self._findings.add(
            following.move.line,
            "gouge",
            what,
            value,
            f"for a cutter of radius {following.radius:g} mm",
        )


# -- centre ---------------------------------------------------------------------------------------
# The path of the cutter's centre where the control compensates for its radius.
#
# As LinuxCNC runs it (src/emc/rs274ngc/interp_convert.cc), and other controls but for what they do
# around outer corners: the straight move that enters ends beside its end, inner corners are cut
# where the parallels meet, outer ones are rounded, and the move after the compensation leads to
# where it is programmed.


FAR: Final = 4.0
"""Radii from a corner beyond which the parallels of its moves are not taken to meet."""

Radius = Callable[[CutterMove], float]
"""Offset of a compensated move [mm]; negative for the other side, NaN if it is not known."""


def centre_path(moves: Sequence[CutterMove], radius: Radius) -> tuple[CutterMove, ...]:
    """The same moves along the cutter's centre; where the offset is 0 they are unchanged."""
    displaced: list[CutterMove] = []
    for run, following in _runs(moves):
        size = radius(run[0]) if run else 0.0
        if size == 0.0:
            displaced += run
        elif run:
            displaced += _displaced(run, size)
        if following is not None:
            displaced.append(
                replace(following, start=displaced[-1].end) if run and size else following
            )
    return tuple(displaced)


def check_compensation(moves: Sequence[CutterMove], radius: Radius, findings: Findings) -> None:
    """Report compensated moves that controllers refuse, or that would gouge, with these offsets."""
    for run, following in _runs(moves):
        if not run:
            continue
        compensator = Compensator(findings)
        for move in run:
            compensator.take(move, move.compensation, radius(move))
        if following is not None:
            compensator.leave(following, radius(run[0]))


def _runs(
    moves: Iterable[CutterMove],
) -> Iterator[tuple[list[CutterMove], CutterMove | None]]:
    """Runs of compensated moves, each with the move after it; other moves with an empty run."""
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
    side = run[0].compensation
    flat = [move for move in run if move.start != move.end or move.kind == "arc"]
    parallels = iter([move_parallel(move, side, radius) for move in flat])
    following = next(parallels, None)
    previous: Parallel | None = None
    place = run[0].start
    for move in run:
        if move.start == move.end and move.kind != "arc":
            yield replace(move, start=place, end=place)  # along Z
            continue
        assert following is not None
        parallel, following = following, next(parallels, None)
        if previous is not None and (turn := _turn(previous, parallel)) < -TANGENT:
            point = parallel.offset_point(move.start)
            yield replace(
                move, kind="arc", start=place, end=point, z_end=move.z_start, centre=move.start,
                sweep=turn * parallel.side,
            )  # fmt: skip
            place = point
        end = parallel.offset_point(move.end) if following is None else _joint(parallel, following)
        centre, sweep, mismatch = move.centre, 0.0, 0.0
        if move.kind == "arc":
            arms = place - centre, end - centre
            turned = phase(arms[1] / arms[0]) if arms[0] else 0.0
            sweep = turned + 2.0 * math.pi * round((move.sweep - turned) / (2.0 * math.pi))
            mismatch = max(move.mismatch, abs(abs(arms[1]) - abs(arms[0])))
        yield replace(move, start=place, end=end, sweep=sweep, mismatch=mismatch)
        place, previous = end, parallel


def _turn(previous: Parallel, following: Parallel) -> float:
    """Change of direction at a corner [rad], positive towards the cutter: an inner one."""
    corner = following.move.start
    return phase(following.heading(corner) / previous.heading(corner)) * following.side


def _joint(previous: Parallel, following: Parallel) -> complex:
    """Where the parallel of a move ends, before another one."""
    corner, turn = following.move.start, _turn(previous, following)
    end = previous.offset_point(corner)
    if turn < -TANGENT:
        return end
    if turn > TANGENT:
        point = meeting(previous, following)
        if point is not None and abs(point - corner) <= FAR * previous.radius:
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
        """The length of the programmed move."""
        return self.move.course.length

    @property
    def room(self) -> float:
        """Radius of an arc's parallel; not above 0 where the cutter does not fit into it."""
        move = self.move
        # The cutter is inside an arc if it is on the side of its centre.
        inner = self.side if move.sweep > 0.0 else -self.side
        return abs(move.start - move.centre) - inner * self.radius

    def heading(self, point: complex) -> complex:
        """Direction at a point of the programmed move, of length 1."""
        way = self.move.course.heading(point)
        return way / abs(way) if way else 1.0 + 0j

    def offset_point(self, point: complex) -> complex:
        """The centre of the cutter beside a point of the programmed move."""
        return point + self.side * 1j * self.heading(point) * self.radius

    def share(self, centre: complex) -> float:
        """How far along the move a point of its parallel is, as a share of it."""
        move = self.move
        if move.kind != "arc":
            return ((centre - move.start) / (move.end - move.start)).real
        turned = phase((centre - move.centre) / (move.start - move.centre))
        sign = 1.0 if move.sweep > 0.0 else -1.0
        along = (sign * turned) % TURN
        # A point just before the start counts as negative, not as almost a revolution ahead.
        along = along - TURN if along > 0.5 * (abs(move.sweep) + TURN) else along
        return along / abs(move.sweep)


def move_parallel(move: CutterMove, side: str, radius: float) -> Parallel:
    """The parallel on a side, "left" or "right", of the path; a negative `radius` [mm] is an offset
    on the other one.
    """
    return Parallel(move, 1.0 if (side == "left") != (radius < 0.0) else -1.0, abs(radius))


def meeting(previous: Parallel, following: Parallel) -> complex | None:
    """Where the parallels of two neighbours meet, next to their corner; None if they do not."""
    corner = following.move.start
    first, second = previous.move.kind == "arc", following.move.kind == "arc"
    if first and second:
        points = _circles(
            previous.move.centre, previous.room, following.move.centre, following.room
        )
    elif first or second:
        line, arc = (following, previous) if first else (previous, following)
        point = line.offset_point(line.move.start)
        points = _line_and_circle(point, line.heading(point), arc.move.centre, arc.room)
    else:
        points = _lines(previous, following)
    return min(points, key=lambda point: abs(point - corner), default=None)


def _lines(previous: Parallel, following: Parallel) -> list[complex]:
    way, other = previous.heading(0j), following.heading(0j)
    # Cramer's rule, with cross products of directions of length 1.
    across = (way.conjugate() * other).imag
    if abs(across) < 1e-12:  # straight on, or straight back
        return []
    gap = following.offset_point(following.move.start) - previous.offset_point(previous.move.start)
    return [
        previous.offset_point(previous.move.start) + way * (gap.conjugate() * other).imag / across
    ]


def _line_and_circle(point: complex, way: complex, centre: complex, radius: float) -> list[complex]:
    rest = (point - centre) / way
    square = radius * radius - rest.imag * rest.imag
    if square < 0.0:
        return []
    foot, half = centre + way * complex(0.0, rest.imag), math.sqrt(square)
    return [foot + way * half, foot - way * half]


def _circles(centre: complex, radius: float, other: complex, size: float) -> list[complex]:
    gap = other - centre
    distance = abs(gap)
    if distance == 0.0:
        return []
    # Along the line of the centres: the distance of the common chord from the first one.
    along = (radius * radius - size * size + distance * distance) / (2.0 * distance)
    square = radius * radius - along * along
    if square < 0.0:
        return []
    way = cmath.rect(1.0, phase(gap))
    return [centre + way * complex(along, sign * math.sqrt(square)) for sign in (1.0, -1.0)]


# -- run ------------------------------------------------------------------------------------------
# What comes of a program that was run: its moves, and what was found in it.


@dataclass(frozen=True, slots=True, eq=False)
class ProgramRun:
    """A program that was run.

    Attributes
    ----------
    mm_per_unit : of the unit of length of its first cut; NaN if it states none.
    step : last printed decimal [mm].
    blending : how far the controller may leave the programmed path in a cut [mm]; 0 for the exact
        path, infinite without a bound.
    naive_cam : how far it may move points before that [mm].
    moves, events : in the order of running.
    comments : those that stand alone in their lines, without brackets; what is said right before
        a stop is for the operator and left out.
    findings : by line.
    complete : whether the program was read to its end, not up to the last finding allowed.
    central : whether all moves are those of the cutter's centre, also compensated ones.
    """

    mm_per_unit: float
    step: float
    blending: float
    naive_cam: float
    moves: tuple[CutterMove, ...]
    comments: tuple[str, ...]
    events: tuple[Event, ...]
    findings: tuple[LineFinding, ...]
    complete: bool
    central: bool = False

    def loops(self, gap: float = 0.0) -> list[Loop]:
        """Closed runs of cuts, see `closed_paths`."""
        return closed_paths(self.moves, gap)

    @property
    def compensated(self) -> CutterMove | None:
        """The first move whose path is not that of the cutter's centre; None if there is none."""
        if self.central:
            return None
        return next((move for move in self.moves if move.compensation), None)

    def in_the_part(self, zero: Zero) -> ProgramRun:
        """The program in the coordinates of the part; `zero` is the program's zero in them."""
        z, to_part, turned = zero.z, zero.to_part, bool(zero.turned)
        if not (zero.place or z or turned):
            return self
        moved = tuple(
            replace(
                move,
                start=to_part(move.start),
                end=to_part(move.end),
                centre=to_part(move.centre) if move.kind == "arc" else move.centre,
                sweep=-move.sweep if turned and move.sweep else move.sweep,
                z_start=move.z_start + z,
                z_end=move.z_end + z,
                compensation=MIRRORED_SIDE[move.compensation] if turned else move.compensation,
            )
            for move in self.moves
        )
        events = tuple(
            replace(event, place=to_part(event.place), z=event.z + z) for event in self.events
        )
        return replace(self, moves=moved, events=events)

    def centred(self, radius: Radius) -> ProgramRun:
        """The program along the cutter's centre; `radius` gives offsets of compensated moves."""
        return replace(self, moves=centre_path(self.moves, radius), central=True)

    def refuse(self, *concerns: str) -> None:
        """Raise FileError with the first finding of these concerns, or of any if none is given."""
        for finding in self.findings:
            if not concerns or finding.concerns in concerns:
                raise FileError(str(finding))


# -- rules ----------------------------------------------------------------------------------------
# What the interpreter finds fault with: the names of its rules, and the list of what was found.


WORDS, PATH, FORM, SAFETY, FRAME, LIMITS = "words", "path", "form", "safety", "frame", "limits"
"""What a finding concerns: a block that cannot be run as it stands; a path that is not known; the
form of a path that is known, mostly of its arcs; a danger while it runs; what a program must say
before it cuts and when it ends; limits of the controller."""

RULES: Final[Mapping[str, str]] = MappingProxyType(
    {
        # A block that the controller cannot run, or that is not supported.
        "unreadable": WORDS,
        "unknown-word": WORDS,
        "unsupported": WORDS,
        "repeated-word": WORDS,
        "conflict": WORDS,
        "missing-word": WORDS,
        "unused-word": WORDS,
        "number": WORDS,
        "comment": WORDS,
        # A path that is not known: its size, its place.
        "unit": PATH,
        "no-motion": PATH,
        "plane": PATH,
        "no-arc": PATH,
        "unknown-position": PATH,
        # The form of the path.
        "unit-change": FORM,
        "order": FORM,
        "decimal-point": FORM,
        "arc-radius": FORM,
        "arc-form": FORM,
        "arc-sweep": FORM,
        "full-circle": FORM,
        "helix": FORM,
        "compensation": FORM,
        "gouge": FORM,
        # Dangers.
        "rapid-in-stock": SAFETY,
        "rapid-plunge": SAFETY,
        "rapid-height": SAFETY,
        "rapid-diagonal": SAFETY,
        "no-feed": SAFETY,
        "feed": SAFETY,
        "no-spindle": SAFETY,
        "spindle-sense": SAFETY,
        "no-tool": SAFETY,
        "tool-length": SAFETY,
        "coolant": SAFETY,
        "dwell": SAFETY,
        "low-stop": SAFETY,
        # What a program must say.
        "frame": FRAME,
        "no-end": FRAME,
        "after-end": FRAME,
        "left-on": FRAME,
        "nothing": FRAME,
        # Limits of the controller.
        "line-length": LIMITS,
        "line-end": LIMITS,
        "line-number": LIMITS,
        "characters": LIMITS,
        "decimals": LIMITS,
    }
)
"""Every rule and what it concerns; docs/lint.md says what each finds."""


class Enough(Exception):
    """As many findings as were asked for: the program is read no further."""


class Findings:
    """What was found in a program, in the order of finding.

    Attributes
    ----------
    reported : the findings so far.
    """

    def __init__(self, most: int, fatal: Collection[str] = ()) -> None:
        self.reported: list[LineFinding] = []
        self._most = most
        self._fatal = fatal

    def add(self, line: int, rule: str, what: str, value: str = "", allowed: str = "") -> None:
        """Add a finding; raises Enough if it is one too many, or of a concern that is fatal."""
        self.reported.append(LineFinding(line, rule, RULES[rule], what, value, allowed))
        if len(self.reported) >= self._most or RULES[rule] in self._fatal:
            raise Enough
