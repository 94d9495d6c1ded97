"""Moves of a block: where they end, and what they are."""

from __future__ import annotations

import cmath
import math
from collections.abc import Set
from dataclasses import dataclass, replace
from typing import Final

from camgeo.design.linting import Bench
from camgeo.numeric.arrays import phase
from camgeo.reading import PROGRAM, PROGRAM_MOVES, beyond
from camgeo.units import TURN
from camgeo_export.gcode.moves import CutterMove, Kind
from camgeo_export.interpreter.compensation import Compensator
from camgeo_export.interpreter.controller import RETRACTED, UNKNOWN, Controller, State
from camgeo_export.interpreter.holes import CYCLES, HoleReader, coordinate
from camgeo_export.interpreter.iso import ARMS, AXES, CYCLE, GROUPS, Block, Findings

ARCS: Final = ("clockwise arc", "counter-clockwise arc")

STRAIGHT: Final = frozenset({*AXES, "PR", "PA", "RND"})

ROUND: Final = STRAIGHT | frozenset({*ARMS, "R"})
"""Words that moves take."""


class Mover:
    """Makes moves of blocks, and judges them.

    Attributes
    ----------
    moves : so far.
    """

    def __init__(
        self, controller: Controller, state: State, bench: Bench, findings: Findings
    ) -> None:
        self.moves: list[CutterMove] = []
        self._controller = controller
        self._state = state
        self._findings = findings
        self._radii = dict(bench.radii)
        self._hazards = Hazards(controller, bench, findings)
        self._frame = Frame(controller, findings)
        self._compensator = Compensator(findings)
        self._arcs = ArcReader(controller, state, findings)
        self._holes = HoleReader(controller, state, findings)
        self._reading = controller.machine.reading
        self._fine = False
        self._printed: set[tuple[int, float]] = set()

    def enter(self, block: Block) -> None:
        """Compensation was switched on."""
        if block.codes.get("motion") in ARCS:
            what = "compensation begins with an arc"
            self._findings.add(block.line, "compensation", what, allowed="a straight move")
        self._compensator.enter()

    def skip(self, block: Block) -> None:
        """Go on from the end of a block that is not run."""
        if block.codes.get("motion") == CYCLE:  # each block with coordinates runs it again
            self._state.modes["motion"] = CYCLE
            self._state.at, _ = self._target(block)
        else:
            self._state.lose()

    def end_cycle(self, block: Block) -> None:
        """Blocks with coordinates run a cycle no longer, or nothing at all."""
        ends = block.codes["cycle"] == "motion off" and "motion" not in block.codes
        if ends or self._state.mode("motion") in (CYCLE, *CYCLES):
            self._state.modes["motion"] = ""

    def move(self, block: Block) -> Set[str]:
        """Make the move of a block, if it has one; return the letters that it takes."""
        state = self._state
        if block.codes.get("motion", "") and block.arc != "rapid":
            state.modes["motion"] = block.codes["motion"]
            if block.codes["motion"] not in CYCLES:
                state.cycle, state.hole, state.above = "", {}, math.nan
        axes = [axis for axis in AXES if axis in block.values]
        off = state.mode("cycle") == "motion off" and not state.mode("motion")
        if axes and off and not self._reading.cancelled_axes:
            self._findings.add(block.line, "no-motion", "coordinates behind G80")
        if "home" in block.actions:
            return self._home(block)
        if block.words.get("length") in self._reading.takes_axes:
            return STRAIGHT  # Z is the length itself
        motion = "rapid" if block.arc == "rapid" else state.mode("motion")
        if motion == CYCLE:
            state.at, _ = self._target(block)
            return block.values.keys()
        circles = self._reading.circle == "modal" or "motion" in block.codes
        arms = any(arm in block.values for arm in (*ARMS, "R")) and circles
        if block.arc in ("polar", "pole", "tangent"):
            axes = axes or ["pole"]
        if not axes and not (arms and motion in ARCS):
            self._check_bare(block)
            return frozenset()
        if not motion:
            self._findings.add(block.line, "no-motion", "coordinates before a kind of motion")
            motion = "rapid"
        self._check_unit(block)
        if "machine position" in block.actions:
            return self._machine_position(block, motion)
        if motion in CYCLES:
            self._make_holes(block)
            return STRAIGHT | {"R", self._reading.repeats}
        self._run(block, motion)
        return ROUND | {self._reading.turns} if motion in ARCS else STRAIGHT

    # -- kinds of moves ---------------------------------------------------------------------------

    def _run(self, block: Block, motion: str) -> None:
        state = self._state
        end, z_end = self._target(block)
        arc = None
        kind: Kind = "rapid" if motion == "rapid" else "line"
        if motion in ARCS:
            kind = "arc"
            found = self._arcs.read(block, end, z_end, ccw=motion == ARCS[1])
            if found is None:  # what it is cannot be told: the path goes on from its end
                state.at, state.z = end, z_end
                return
            end, arc = found
            kind = "line" if arc is None else "arc"
        if state.rounding:
            self._round_corner(block, kind, end, z_end)
        if arc is not None and state.mode("plane") not in ("", "plane XY"):
            self._make_chords(block, end, z_end, arc)
            return
        self._make(block, kind, end, z_end, arc)
        state.rounding = block.value("RND") * self._scale

    def _round_corner(self, block: Block, kind: Kind, end: complex, z_end: float) -> None:
        """Round the corner between the last move and one to `end`."""
        state, before = self._state, self.moves[-1]
        radius, state.rounding = state.rounding, 0.0
        flat = before.z_start == before.z_end == z_end and before.end == state.at
        found = None
        if before.kind == kind == "line" and flat:
            found = rounded(before.start, before.end, end, radius)
        if found is None:
            what = "a rounding other than between two lines in the plane that have room for it"
            self._findings.add(block.line, "unsupported", what)
            return
        first, last, arc = found
        self.moves[-1] = replace(before, end=first)
        state.at = first
        self._make(block, "arc", last, z_end, arc)

    def _make_chords(self, block: Block, end: complex, z_end: float, arc: Arc) -> None:
        """Make an arc in another plane than XY, of lines."""
        plane = PLANES[self._state.mode("plane")]
        start, height = plane.drop(self._state.at, self._state.z)
        finish, last = plane.drop(end, z_end)
        places = chords(start, finish, arc)
        for k, place in enumerate(places, start=1):
            point = plane.lift(place, height + (last - height) * k / len(places))
            self._make(block, "line", *point, None)

    def _make_holes(self, block: Block) -> None:
        """Make the holes of a block of a cycle."""
        state = self._state
        if state.mode("plane") not in ("", "plane XY"):
            what = f"holes in the {state.mode('plane')}: only those along Z are read"
            self._findings.add(block.line, "unsupported", what)
            state.lose()
            return
        if state.side and "cycle of holes" in self._reading.compensated:
            what = f"{block.words.get('motion', state.cycle)} under compensation"
            self._findings.add(block.line, "compensation", what)
        found = self._holes.read(block, self._target(block)[0], self._scale)
        if found is None:
            state.lose()
            return
        for kind, place, height in found:
            if (place, height) != (state.at, state.z):
                self._make(block, kind, place, height, None)

    def _target(self, block: Block) -> tuple[complex, float]:
        """End of the move [mm]; where it stays along an axis, the present position."""
        state = self._state
        polar = block.arc == "polar" or not block.values.keys().isdisjoint(("PR", "PA"))
        at = self._polar(block) if polar else state.at
        found = {"X": at.real, "Y": at.imag, "Z": state.z}
        scale, unit = self._scale, state.mode("unit")
        incremental = state.mode("distance") == "incremental"
        for axis in AXES:
            if axis not in block.values:
                continue
            value = coordinate(block, axis, self._controller, unit) * scale
            printed = (block.values[axis].decimals, scale)
            if printed not in self._printed:
                self._printed.add(printed)
                state.step = min(state.step, 10.0 ** -printed[0] * scale)
                self._check_decimals(block, axis, printed[0])
            found[axis] = value + (found[axis] if block.relative.get(axis, incremental) else 0.0)
        return complex(found["X"], found["Y"]), found["Z"]

    def _polar(self, block: Block) -> complex:
        state = self._state
        arm = state.at - state.pole
        radius = block.value("PR") * self._scale if "PR" in block.values else abs(arm)
        angle = math.degrees(phase(arm)) if not cmath.isnan(arm) else math.nan
        if "PA" in block.values:
            relative = block.relative.get("PA", False)
            angle = block.value("PA") + (angle if relative else 0.0)
        return about_pole(state.pole, radius, angle)

    def _home(self, block: Block) -> Set[str]:
        """To the reference, by way of the position that the block states."""
        state = self._state
        axes = [axis for axis in AXES if axis in block.values]
        if state.side:
            self._findings.add(block.line, "compensation", "a traverse home under compensation")
        if any(self._leads_away(block, axis) for axis in axes):
            self._check_unit(block)
            self._make(block, "rapid", *self._target(block), None)
        gone = axes or list(AXES)
        z = RETRACTED if "Z" in gone else state.z
        at = UNKNOWN if {"X", "Y"} & set(gone) else state.at
        self._make(block, "rapid", at, z, None)
        return STRAIGHT

    def _leads_away(self, block: Block, axis: str) -> bool:
        """Whether the position on the way home is another one than the present."""
        incremental = self._state.mode("distance") == "incremental"
        if block.relative.get(axis, incremental):
            return block.value(axis) != 0.0
        at = {"X": self._state.at.real, "Y": self._state.at.imag, "Z": self._state.z}[axis]
        return block.value(axis) * self._scale != at

    def _machine_position(self, block: Block, motion: str) -> Set[str]:
        """To a position in the machine's own coordinates: Z is at its top there."""
        state, word = self._state, block.words["machine position"]
        add = self._findings.add
        if motion != "rapid" and not (motion == "line" and "cut" in self._reading.machine_position):
            what = f"{word} with a cut: machine positions are for traverses"
            add(block.line, "conflict", what)
            motion = "rapid"
        if state.side:
            add(block.line, "compensation", f"{word} under compensation")
        relative = state.mode("distance") == "incremental" and not block.relative
        if relative and "incremental" not in self._reading.machine_position:
            add(block.line, "conflict", f"{word} while distances are incremental")
        at = UNKNOWN if {"X", "Y"} & block.values.keys() else state.at
        z = RETRACTED if "Z" in block.values else state.z
        self._make(block, "rapid" if motion == "rapid" else "line", at, z, None)
        return STRAIGHT

    def _make(self, block: Block, kind: Kind, end: complex, z_end: float, arc: Arc | None) -> None:
        """Make a move, judge it, and go on from its end; FileError for one too many."""
        state = self._state
        if len(self.moves) >= PROGRAM_MOVES:
            raise beyond(
                "the program", f"more than {PROGRAM_MOVES:,} moves", PROGRAM_MOVES, PROGRAM
            )
        turning = -1.0 if state.mode("spindle") == "spindle counter-clockwise" else 1.0
        move = CutterMove(
            kind=kind,
            start=state.at,
            end=end,
            z_start=state.z,
            z_end=z_end,
            centre=0j if arc is None else arc.centre,
            sweep=0.0 if arc is None else arc.sweep,
            mismatch=0.0 if arc is None else arc.mismatch,
            feed=0.0 if kind == "rapid" else state.feed,
            speed=turning * state.speed if state.spinning else 0.0,
            operation=state.operation,
            tool=state.tool,
            offset=state.offset,
            line=block.line,
            compensation=state.side,
            radius_offset=state.radius_offset,
            oversize=state.oversize if state.side else 0.0,
            coolant=state.coolant,
            work_offset=state.work_offset,
        )
        self._hazards.judge(move, state)
        if kind != "rapid":
            self._frame.check(state, block.line)
            if math.isnan(state.cut_scale):
                state.cut_scale = state.scale
            state.cut_blending = max(state.cut_blending, state.blending)
            state.cut_naive_cam = max(state.cut_naive_cam, state.naive_cam)
        self._compensate(move)
        self.moves.append(move)
        if end != state.at:
            state.heading = heading_after(state.at, end, arc)
        state.at, state.z = end, z_end

    # -- checks ---------------------------------------------------------------------------------

    @property
    def _scale(self) -> float:
        """mm in a unit; before one is stated a millimetre."""
        return 1.0 if math.isnan(self._state.scale) else self._state.scale

    def _check_unit(self, block: Block) -> None:
        state = self._state
        if math.isnan(state.scale) and any(block.value(axis) for axis in (*AXES, *ARMS, "R")):
            what = "coordinates before their unit is stated: taken as mm"
            words = self._controller.machine.unit
            self._findings.add(block.line, "unit", what, allowed=f"{words.mm} or {words.inch}")
            state.scale = 1.0

    def _check_decimals(self, block: Block, axis: str, decimals: int) -> None:
        """More decimals than the controller reads are found once."""
        most = self._controller.machine.numbers.most_decimals
        allowed = most.inch if self._state.mode("unit") == "inch" else most.mm
        if decimals > allowed and not self._fine:
            self._fine = True
            text = f"{axis}{block.values[axis].text}"
            what = "more decimals than the controller reads"
            self._findings.add(block.line, "decimals", what, text, f"at most {allowed}")

    def _check_bare(self, block: Block) -> None:
        """A block without coordinates must not ask for a motion that needs them."""
        motion = block.codes.get("motion", "")
        if motion == "line" and not self._state.feed > 0.0:
            word = block.words["motion"]
            self._findings.add(block.line, "no-feed", f"{word} without a feed F")
        if motion in ARCS:
            self._findings.add(block.line, "missing-word", "an arc without its end and its centre")
        elif motion in CYCLES:
            what = f"{block.words['motion']} without coordinates"
            self._findings.add(block.line, "missing-word", what)
        elif block.words.get("machine position") == "G53" and not (
            motion or ("G53" in self._reading.bare and self._state.mode("motion") not in ARCS)
        ):
            self._findings.add(block.line, "missing-word", "G53 without coordinates")

    def _compensate(self, move: CutterMove) -> None:
        state = self._state
        if state.side:
            radius = state.stated_radius
            if math.isnan(radius):
                radius = self._radii.get(state.radius_offset, math.nan) + state.oversize
            if move.kind != "rapid" or move.start != move.end:
                self._compensator.take(move, state.side, radius)
        elif state.left_compensation:
            radius = self._radii.get(move.tool, math.nan) + state.oversize
            self._compensator.leave(move, radius)
            state.left_compensation = 0


# -- frame ----------------------------------------------------------------------------------------
# What a program must have stated before its first cut.


NEEDED: Final = (
    "unit", "plane", "distance", "feed mode", "compensation", "cycle", "work offset", "centres",
)  # fmt: skip
"""Groups of which a program must state one word, if the controller has any: what was left active by
the program before is not known."""


class Frame:
    """Checks the modal frame once, at the first cut."""

    def __init__(self, controller: Controller, findings: Findings) -> None:
        self._controller = controller
        self._findings = findings
        self._done = False

    def check(self, state: State, line: int) -> None:
        """Find what was not stated before the cut in `line`."""
        if self._done:
            return
        self._done = True
        missing = [word for group in NEEDED if (word := self._missing(group, state))]
        if missing:
            self._findings.add(line, "frame", f"cut without {', '.join(missing)}")

    def _missing(self, group: str, state: State) -> str:
        """The word of a group that the profile's own programs state, if one is missing."""
        controller = self._controller
        if state.mode(group) or group not in controller.groups:
            return ""
        if group == "unit" and not math.isnan(state.scale):
            return ""  # found at the first coordinate
        words = [word for word, each in controller.meanings.items() if each in GROUPS[group]]
        if group == "centres" and len(words) < 2:
            return ""  # there is no choice
        program = controller.machine.program
        stated = " ".join((*program.safe_start, *controller.machine.work_offsets.values())).split()
        usual = [word for word in stated if word in words]
        return usual[0] if usual else min(words, key=lambda word: (len(word), word))


# -- hazards --------------------------------------------------------------------------------------
# Dangers of single moves, told from the move and the state in which it is made.


SLACK: Final = 1e-9
"""Heights are compared as printed; what lies between is rounding of the change of units [mm]."""


class Hazards:
    """Judges moves one after another."""

    def __init__(self, controller: Controller, bench: Bench, findings: Findings) -> None:
        self._controller = controller
        self._bench = bench
        self._findings = findings
        self._said: set[str] = set()

    def judge(self, move: CutterMove, state: State) -> None:
        """Find what is dangerous in a move."""
        if move.kind == "rapid":
            self._rapid(move)
            if move.z_end != move.z_start and math.isfinite(move.z_end) and state.tool:
                what = "a traverse along Z before the length of the tool is in force"
                self._length(move, state.has_length, what)
        else:
            self._cut(move, state)

    def _rapid(self, move: CutterMove) -> None:
        bench, add = self._bench, self._findings.add
        low = min(move.z_start, move.z_end)
        if math.isnan(move.z_start) or math.isnan(move.z_end):
            low = math.nan
        across = move.end != move.start and not (
            cmath.isnan(move.end) and cmath.isnan(move.start) and math.isinf(move.z_end)
        )
        vertical = move.z_end != move.z_start and not math.isnan(move.z_start)
        top, free = bench.stock_top - SLACK, bench.free - SLACK
        if across and math.isnan(low):
            if math.isnan(move.z_end):
                add(move.line, "rapid-height", "a traverse in the plane at an unknown height")
            elif move.z_end < free:
                what = "a traverse in the plane and down from an unknown height"
                add(move.line, "rapid-diagonal", what)
            return
        if across and vertical and low < free:
            whence = "above" if math.isinf(move.z_start) else f"Z {move.z_start:g} mm"
            what = f"a traverse in the plane and along Z at once, from {whence} to"
            allowed = f"both at once only above Z {bench.free:g} mm"
            add(move.line, "rapid-diagonal", f"{what} Z {move.z_end:g} mm", allowed=allowed)
        elif across and low < top:
            what = f"a traverse in the plane at Z {low:g} mm, below the top of the stock"
            add(move.line, "rapid-in-stock", what, allowed=f"Z {bench.stock_top:g} mm or more")
        elif across and low < free:
            what = f"a traverse in the plane at Z {low:g} mm, below the safe height"
            add(move.line, "rapid-height", what, allowed=f"Z {bench.free:g} mm or more")
        elif move.z_end < top and not move.z_end > move.z_start:
            what = f"a traverse down to Z {move.z_end:g} mm, into the material"
            add(move.line, "rapid-plunge", what, allowed=f"Z {bench.stock_top:g} mm or more")

    def _cut(self, move: CutterMove, state: State) -> None:
        lost = cmath.isnan(move.start) or math.isnan(move.z_start) or math.isinf(move.z_start)
        if lost and not state.lost:
            self._findings.add(move.line, "unknown-position", "a cut from an unknown position")
        state.lost = lost
        self._once(move, "no-feed", move.feed > 0.0, "a cut without feed")
        self._once(move, "no-spindle", move.speed > 0.0, "a cut with the spindle off")
        controller = self._controller
        if controller.changes_tools:
            self._once(move, "no-tool", move.tool > 0, "a cut before a tool is in the spindle")
            in_force = move.offset > 0 and state.has_length
            self._length(move, in_force, "a cut without the length of the tool in force")
        if move.coolant == "off" and min(move.z_start, move.z_end) < self._bench.stock_top:
            state.dry = state.dry or move.line

    def _length(self, move: CutterMove, holds: bool, what: str) -> None:
        """Find that no length of the tool holds, where the controller needs one."""
        needed = self._controller.changes_tools and self._controller.length_letter
        self._once(move, "tool-length", holds or not needed, what)

    def _once(self, move: CutterMove, rule: str, holds: bool, what: str) -> None:
        """Find what does not hold, the first time of several in a row: each further cut breaks it
        too, until it is mended.
        """
        if holds:
            self._said.discard(rule)
        elif rule not in self._said:
            self._said.add(rule)
            self._findings.add(move.line, rule, what)


# -- arcs -----------------------------------------------------------------------------------------
# Arcs as controllers take them: centre and sweep from what a block states.


NO_ARC: Final = 5e-7
"""Sweep [rad] up to which Grbl makes a full circle of an arc (ARC_ANGULAR_TRAVEL_EPSILON in its
config.h): its printed ends are the same point, nearly."""

NEARLY_FULL: Final = math.radians(1.0)
"""An arc that lacks less to a full circle is a short one the wrong way round, probably."""

CHORDS: Final = 1e-3
"""How far chords of an arc in another plane than XY may be off it [mm]."""

SHORTEST: Final = math.radians(0.1)
"""Sweep of the shortest chord [rad]: beyond a radius of 2.6 m chords are off by more."""

AMBIGUOUS: Final = math.radians(15.0)
"""An arc given by its radius is ill defined so near to half a turn and to a whole one: from 165 to
195 degrees and above 345 (LinuxCNC, docs/src/gcode/g-code.adoc, "Radius Format Arcs")."""


@dataclass(frozen=True, slots=True)
class Plane:
    """A plane of arcs: two axes, by their places in XYZ, and the one across."""

    first: int
    second: int
    across: int

    @property
    def arms(self) -> str:
        """Letters of an arc's centre in it."""
        return ARMS[self.first] + ARMS[self.second]

    @property
    def axes(self) -> str:
        """Letters of its coordinates."""
        return AXES[self.first] + AXES[self.second]

    def drop(self, at: complex, z: float) -> tuple[complex, float]:
        """A point in the coordinates of the plane, and its height over it."""
        point = (at.real, at.imag, z)
        return complex(point[self.first], point[self.second]), point[self.across]

    def lift(self, place: complex, height: float) -> tuple[complex, float]:
        """The point at a place of the plane: X and Y, and Z."""
        point = [0.0, 0.0, 0.0]
        point[self.first], point[self.second] = place.real, place.imag
        point[self.across] = height
        return complex(point[0], point[1]), point[2]


PLANES: Final = {"plane XY": Plane(0, 1, 2), "plane ZX": Plane(2, 0, 1), "plane YZ": Plane(1, 2, 0)}
"""By what G17, G18 and G19 mean; in each G3 turns from the first axis to the second."""


@dataclass(frozen=True, slots=True)
class Arc:
    """An arc in the plane.

    Attributes
    ----------
    centre : [mm].
    sweep : angle turned [rad], positive counter-clockwise; with further turns more than a circle.
    mismatch : difference of the radii at its ends [mm].
    """

    centre: complex
    sweep: float
    mismatch: float


def swept(start: complex, end: complex, centre: complex, *, ccw: bool, turns: int = 0) -> Arc:
    """The arc about a centre; where its ends coincide it is a full circle."""
    first, last = start - centre, end - centre
    turn = phase(last / first) % TURN if first and last else 0.0
    if start == end or not (first and last):
        turn = TURN
    elif not ccw:
        turn = turn - TURN if turn else -TURN
    sweep = abs(turn) + turns * TURN
    return Arc(centre, sweep if ccw else -sweep, abs(abs(first) - abs(last)))


def by_radius(start: complex, end: complex, radius: float, *, ccw: bool, turns: int = 0) -> Arc:
    """The arc of a radius, with a negative one the larger; half a circle where it is too small.

    How much too small is the mismatch.
    """
    chord = end - start
    half, size = 0.5 * abs(chord), abs(radius)
    height = math.sqrt(max(size * size - half * half, 0.0))
    left = ccw if radius > 0.0 else not ccw
    side = 1j if left else -1j
    centre = 0.5 * (start + end) + side * chord / abs(chord) * height
    arc = swept(start, end, centre, ccw=ccw, turns=turns)
    return Arc(centre, arc.sweep, max(half - size, 0.0))


def tangent(start: complex, end: complex, heading: complex) -> Arc | None:
    """The arc that goes on from a heading; None if that leads straight to the end, or back."""
    chord = end - start
    turn = 2.0 * phase(chord / heading) if chord and heading else 0.0
    if abs(math.sin(0.5 * turn)) < 1e-9:
        return None
    radius = 0.5 * abs(chord) / math.sin(0.5 * turn)  # positive to the left
    centre = start + 1j * heading / abs(heading) * radius
    return Arc(centre, turn, 0.0)


def rounded(
    start: complex, corner: complex, end: complex, radius: float
) -> tuple[complex, complex, Arc] | None:
    """Ends of the arc that rounds a corner of two lines, and the arc; None if it does not fit."""
    way, onward = corner - start, end - corner
    if cmath.isnan(way) or cmath.isnan(onward) or not (way and onward):
        return None
    turn = phase(onward / way)
    cut = radius * math.tan(0.5 * abs(turn))
    if not 0.0 < cut <= min(abs(way), abs(onward)):
        return None
    first = corner - way / abs(way) * cut
    last = corner + onward / abs(onward) * cut
    centre = first + way / abs(way) * radius * (1j if turn > 0.0 else -1j)
    return first, last, Arc(centre, turn, 0.0)


def chords(start: complex, end: complex, arc: Arc) -> list[complex]:
    """Ends of chords along an arc, from its radius at the start to that at its end."""
    first, last = start - arc.centre, end - arc.centre
    size = max(abs(first), abs(last), CHORDS)
    count = math.ceil(abs(arc.sweep) / max(2.0 * math.acos(1.0 - CHORDS / size), SHORTEST))
    grown = (abs(last) / abs(first) - 1.0) / max(count, 1)
    found = [
        arc.centre + first * (1.0 + k * grown) * cmath.exp(1j * arc.sweep * k / count)
        for k in range(1, count)
    ]
    return [*found, end]


def heading_after(start: complex, end: complex, arc: Arc | None) -> complex:
    """The direction at the end of a move, of length 1; NaN if it has none in the plane."""
    if arc is not None:
        arm = (end - arc.centre) * (1j if arc.sweep > 0.0 else -1j)
        return arm / abs(arm) if arm else complex(math.nan, math.nan)
    way = end - start
    if cmath.isnan(way) or not way:
        return complex(math.nan, math.nan)
    return way / abs(way)


def about_pole(pole: complex, radius: float, angle: float) -> complex:
    """The point at polar coordinates about a pole; the angle in degrees."""
    return pole + cmath.rect(radius, math.radians(angle))


# -- arc words ------------------------------------------------------------------------------------
# What the words of a block say of an arc, and whether the controller takes such an arc.


ARC_SLACK = 1e-9
"""Rounding of lengths compared with a limit [mm]."""

MOST_TURNS = 1_000

MUCH = 100.0
"""Of a difference of radii, that is refused of an arc of any size."""

HALF = 0.5 * TURN
"""Sweep up to which a profile divides arcs where the controller takes larger ones [rad]."""


class ArcReader:
    """Reads arcs."""

    def __init__(self, controller: Controller, state: State, findings: Findings) -> None:
        self._controller = controller
        self._state = state
        self._findings = findings
        self._reading = controller.machine.reading
        self._plane = PLANES["plane XY"]
        self._start = state.at

    def read(
        self, block: Block, end: complex, z_end: float, *, ccw: bool
    ) -> tuple[complex, Arc | None] | None:
        """End and arc of a block; no arc where it is a straight line, and None if it is neither."""
        state = self._state
        self._plane = PLANES[state.mode("plane") or "plane XY"]
        self._start, height = self._plane.drop(state.at, state.z)
        finish, last = self._plane.drop(end, z_end)
        if cmath.isnan(self._start) or cmath.isnan(finish):
            if not state.lost:
                what = "an arc from an unknown position"
                self._findings.add(block.line, "unknown-position", what)
            state.lost = True
            return None
        if block.arc == "tangent":
            return end, self._tangent(block, end)
        if block.arc == "polar":
            finish, arc = self._polar(block, finish, ccw=ccw)
            end = finish
        else:
            found = self._of_words(block, finish, ccw=ccw)
            if found is None:
                return None
            arc = found
        self._check(block, finish, arc)
        helix = self._controller.machine.reading.helix
        rises = abs(last - height) > 0.0  # not where one of them is unknown
        if rises and helix != "any" and (helix, block.arc) != ("polar", "polar"):
            allowed = "with CP" if helix == "polar" else "arcs at constant Z"
            self._findings.add(block.line, "helix", "an arc that changes Z", allowed=allowed)
        return end, arc

    def _of_words(self, block: Block, end: complex, *, ccw: bool) -> Arc | None:
        start, plane = self._start, self._plane
        arms = [arm for arm in plane.arms if arm in block.values]
        across = ARMS[plane.across]
        if across in block.values:
            what = f"the word {across} with an arc in the plane {plane.axes}"
            allowed = " and ".join(plane.arms)
            if not self._form(block, what, allowed, "arm across the plane"):
                return None
        if "R" in block.values and (arms or across in block.values):
            what = "an arc with its radius and its centre"
            if not self._form(block, what, "one of them", "radius with centre"):
                return None
        if self._reading.circle == "never" and block.values.keys().isdisjoint(plane.axes):
            self._none(block, f"an arc without {' or '.join(plane.axes)}", "the end of the arc")
            return None
        if block.arc == "pole":
            if cmath.isnan(self._state.pole):
                self._none(block, "an arc before its centre is stated", "CC")
                return None
            return swept(start, end, self._state.pole, ccw=ccw)
        if arms and "R" not in block.values:  # with both, R counts (Fanuc 15i, B-63324EN, 4.4)
            centre = self._centre(block)
            least = self._reading.smallest_radius
            if centre is None:
                return None
            if centre in (start, end) or min(abs(start - centre), abs(end - centre)) < least:
                self._none(block, "an arc with its centre at its start or its end", "")
                return None
            return swept(start, end, centre, ccw=ccw, turns=self._turns(block))
        if "R" not in block.values:
            self._none(
                block, "an arc without centre or radius", f"{' and '.join(plane.arms)}, or R"
            )
            return None
        radius = coordinate(block, "R", self._controller, self._state.mode("unit")) * self._scale
        if start == end:
            what = "an arc of which only the radius is stated, that ends where it begins"
            self._none(block, what, "its centre")
            return None
        arc = by_radius(start, end, radius, ccw=ccw, turns=self._turns(block))
        if arc.mismatch > self._difference(self._reading.short_radius) + ARC_SLACK:
            what = f"the radius of the arc is too short by {arc.mismatch:.6g} mm"
            self._findings.add(block.line, "arc-radius", what)
        turn = abs(arc.sweep)
        if abs(turn - math.pi) < AMBIGUOUS or TURN - turn < AMBIGUOUS:
            what = f"an arc of {math.degrees(turn):.1f} degrees stated by its radius is ill defined"
            self._form(block, what, "its centre")
        return arc

    def _centre(self, block: Block) -> complex | None:
        state = self._state
        absolute = state.mode("centres") == "absolute centres" or (
            not state.mode("centres") and self._controller.machine.arcs.centre == "absolute"
        )
        parts = []
        for arm, at in zip(self._plane.arms, (self._start.real, self._start.imag), strict=True):
            own = not block.relative[arm] if arm in block.relative else absolute
            if arm not in block.values:
                if own and arm not in block.relative and absolute:
                    what, allowed = f"an absolute centre without {arm}", "both arms"
                    if not self._form(block, what, allowed, "half an absolute centre"):
                        return None
                parts.append(at)
                continue
            value = coordinate(block, arm, self._controller, state.mode("unit")) * self._scale
            parts.append(value + (0.0 if own else at))
        return complex(*parts)

    def _turns(self, block: Block) -> int:
        """Full turns beyond the arc itself."""
        if "TURN" in block.values:
            return int(max(block.value("TURN"), 0.0))
        count = block.values.get("P") if self._reading.turns == "P" else None
        if count is None:
            return 0
        if count.value < 1.0 or count.value % 1.0 or count.value > MOST_TURNS:
            what = "P of an arc, its number of turns, must be whole"
            allowed = f"1 to {MOST_TURNS}"
            self._findings.add(block.line, "number", what, count.text, allowed)
            return 0
        return int(count.value) - 1

    def _polar(self, block: Block, end: complex, *, ccw: bool) -> tuple[complex, Arc]:
        """An arc about the pole by an angle; an incremental one may be of many turns."""
        state = self._state
        if "PA" in block.values and block.relative.get("PA"):
            sweep = math.radians(abs(block.value("PA"))) * (1.0 if ccw else -1.0)
            if (block.value("PA") > 0.0) != ccw:
                self._form(block, "the sign of the angle is not that of the direction", "")
            end = state.pole + (state.at - state.pole) * cmath.exp(1j * sweep)
            return end, Arc(state.pole, sweep, 0.0)
        return end, swept(state.at, end, state.pole, ccw=ccw)

    def _tangent(self, block: Block, end: complex) -> Arc | None:
        heading = self._state.heading
        if cmath.isnan(heading):
            self._none(block, "a tangential arc without a move before it", "")
            return None
        return tangent(self._state.at, end, heading)

    def _difference(self, stated: float | None) -> float:
        """A limit of what is read, or where none is known that of what is written [mm]."""
        return self._controller.machine.arcs.radius_tolerance if stated is None else stated

    def _check(self, block: Block, end: complex, arc: Arc) -> None:
        """Whether the controller takes the arc."""
        limit = self._reading.radius_difference
        inch = self._state.mode("unit") == "inch"
        stated = None if limit is None else limit.inch if inch else limit.mm
        least = self._difference(stated)
        larger = max(abs(self._start - arc.centre), abs(end - arc.centre))
        most = max(least, min(limit.relative * larger, MUCH * least)) if limit else least
        if "R" not in block.values and arc.mismatch > most + ARC_SLACK:
            what = f"the radii of the arc differ by {arc.mismatch:.6g} mm"
            self._findings.add(block.line, "arc-radius", what, allowed=f"at most {most:g} mm")
        self._check_sweep(block, end, abs(arc.sweep))

    def _check_sweep(self, block: Block, end: complex, turn: float) -> None:
        limits, add = self._controller.machine.arcs, self._findings.add
        if self._start == end and block.arc != "polar":
            if not limits.full_circle:
                what = "an arc that ends where it begins"
                add(block.line, "full-circle", what, allowed="two arcs of half a turn")
            return
        if turn <= NO_ARC or (TURN - NEARLY_FULL < turn < TURN and block.arc != "polar"):
            what = f"an arc of {math.degrees(turn):.6g} degrees between ends that nearly coincide"
            add(block.line, "full-circle", what, allowed="a line")
        elif limits.largest_turn < HALF and turn > limits.largest_turn + self._slack(end):
            what = f"an arc of {math.degrees(turn):.6g} degrees"
            add(block.line, "arc-sweep", what, allowed=f"at most {limits.largest_sweep:g} degrees")

    def _slack(self, end: complex) -> float:
        """What rounding of the printed points may add to a sweep [rad]."""
        step = self._state.step
        chord = abs(end - self._start)
        return 3.0 * step / chord if chord and math.isfinite(step) else 0.0

    @property
    def _scale(self) -> float:
        return 1.0 if math.isnan(self._state.scale) else self._state.scale

    def _none(self, block: Block, what: str, allowed: str) -> None:
        self._findings.add(block.line, "no-arc", what, allowed=allowed)

    def _form(self, block: Block, what: str, allowed: str, form: str = "") -> bool:
        """Find the form of an arc; whether the controller takes it nevertheless."""
        refused = form in self._reading.arc_forms
        self._findings.add(block.line, "no-arc" if refused else "arc-form", what, allowed=allowed)
        return not refused
