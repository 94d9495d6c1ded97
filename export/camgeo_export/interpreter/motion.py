"""Moves of a block: where they end, and what they are."""

from __future__ import annotations

import cmath
import math
from collections.abc import Set
from dataclasses import dataclass, replace
from typing import Final

from camgeo.design.linting import WorkData
from camgeo.numeric.arrays import phase
from camgeo.reading import PROGRAM, beyond
from camgeo.units import TURN
from camgeo_export.interpreter.controller import (
    AXES,
    CYCLE,
    CYCLES,
    UNKNOWN,
    Block,
    BlockReader,
    Controller,
    State,
)
from camgeo_export.interpreter.moves import Compensator, CutterMove, Findings, Kind

ARCS: Final = ("clockwise arc", "counter-clockwise arc")

STRAIGHT: Final = frozenset({*AXES, "PR", "PA", "RND"})

ARMS: Final = "IJK"
"""Words of an arc's centre, by their axes."""

RETRACTED: Final = math.inf
"""Height of the spindle at its reference, above everything."""

ROUND: Final = STRAIGHT | frozenset({*ARMS, "R"})
"""Words that moves take."""

NEEDED: Final = (
    "unit", "plane", "distance", "feed mode", "compensation", "cycle", "work offset", "centres",
)  # fmt: skip
"""Groups of which a program must state one word, if the controller has any: what was left active by
the program before is not known."""

MOST_HOLES: Final = 1_000
"""Most holes of one block of a cycle."""

PROGRAM_MOVES: Final = 500_000
"""Most moves of a program: cycles, and arcs in other planes than XY, make many in a block."""

Step = tuple[Kind, complex, float]
"""What a move is, and where it ends [mm]."""


class Mover(BlockReader):
    """Makes moves of blocks, and checks them.

    Attributes
    ----------
    moves : so far.
    """

    def __init__(
        self, controller: Controller, state: State, bench: WorkData, findings: Findings
    ) -> None:
        super().__init__(controller, state, findings)
        self.moves: list[CutterMove] = []
        self._radii = dict(bench.radii)
        self._hazards = Hazards(controller, bench, findings)
        self._compensator = Compensator(findings)
        self._arcs = ArcReader(controller, state, findings)
        self._framed = False
        self._fine = False
        self._printed: set[tuple[int, float]] = set()

    def enter(self, block: Block) -> None:
        """Begin compensation, which the block has switched on."""
        if block.codes.get("motion") in ARCS:
            self._report(
                block, "compensation", "compensation begins with an arc", allowed="a straight move"
            )
        self._compensator = Compensator(self._findings)

    def skip(self, block: Block) -> None:
        """Go on after a block that is not run, from where it ends."""
        if block.codes.get("motion") == CYCLE:  # each block with coordinates runs it again
            self._state.modes["motion"] = CYCLE
            self._state.place, _ = self._target(block)
        else:
            self._state.lose()

    def end_cycle(self, block: Block) -> None:
        """End a cycle: blocks with coordinates run it no longer, and with "motion off" nothing."""
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
        cancelled = state.mode("cycle") == "motion off" and not state.mode("motion")
        if axes and cancelled and not self._reading.cancelled_axes:
            self._report(block, "no-motion", "coordinates behind G80")
        if "home" in block.actions:
            return self._home(block)
        if block.words.get("length") in self._reading.takes_axes:
            return STRAIGHT  # Z is the length itself
        motion = "rapid" if block.arc == "rapid" else state.mode("motion")
        if motion == CYCLE:
            state.place, _ = self._target(block)
            return block.values.keys()
        # Whether I, J or R make a circle without end and without a motion word in the block.
        circles = self._reading.circle == "modal" or "motion" in block.codes
        arms = any(arm in block.values for arm in (*ARMS, "R")) and circles
        if block.arc in ("polar", "pole", "tangent"):
            axes = axes or ["pole"]
        if not axes and not (arms and motion in ARCS):
            self._check_bare(block)
            return frozenset()
        if not motion:
            self._report(block, "no-motion", "coordinates before any motion word")
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
            end_and_arc = self._arcs.read(block, end, z_end, ccw=motion == ARCS[1])
            if end_and_arc is None:  # it is not known: the path goes on from its end
                state.place, state.z = end, z_end
                return
            end, arc = end_and_arc
            kind = "line" if arc is None else "arc"
        if state.rounding:
            self._round_corner(block, kind, end, z_end)
        if arc is not None and state.mode("plane") not in ("", "plane XY"):
            self._make_chords(block, end, z_end, arc)
            return
        self._make(block, kind, end, z_end, arc)
        state.rounding = block.value("RND") * self._state.unit

    def _round_corner(self, block: Block, kind: Kind, end: complex, z_end: float) -> None:
        """Round the corner between the last move and one to `end`."""
        state, previous = self._state, self.moves[-1]
        radius, state.rounding = state.rounding, 0.0
        flat = previous.z_start == previous.z_end == z_end and previous.end == state.place
        fillet = None
        if previous.kind == kind == "line" and flat:
            fillet = fillet_arc(previous.start, previous.end, end, radius)
        if fillet is None:
            what = "a rounded corner that is not between two lines in the plane, or too large"
            self._report(block, "unsupported", what)
            return
        first, last, arc = fillet
        self.moves[-1] = replace(previous, end=first)
        state.place = first
        self._make(block, "arc", last, z_end, arc)

    def _make_chords(self, block: Block, end: complex, z_end: float, arc: Arc) -> None:
        """Make an arc in another plane than XY, of lines."""
        plane = PLANES[self._state.mode("plane")]
        start, height = plane.drop(self._state.place, self._state.z)
        finish, last = plane.drop(end, z_end)
        places = chord_ends(start, finish, arc)
        for k, place in enumerate(places, start=1):
            point = plane.lift(place, height + (last - height) * k / len(places))
            self._make(block, "line", *point, None)

    def _make_holes(self, block: Block) -> None:
        """Make the holes of a block of a cycle."""
        state = self._state
        if state.mode("plane") not in ("", "plane XY"):
            what = f"holes in the {state.mode('plane')}: only those along Z are supported"
            self._report(block, "unsupported", what)
            state.lose()
            return
        if state.side and "cycle of holes" in self._reading.compensated:
            what = f"{block.words.get('motion', state.cycle)} under compensation"
            self._report(block, "compensation", what)
        steps = self._holes(block, self._target(block)[0])
        if steps is None:
            state.lose()
            return
        for kind, place, height in steps:
            if (place, height) != (state.place, state.z):
                self._make(block, kind, place, height, None)

    def _holes(self, block: Block, end: complex) -> list[Step] | None:
        """The moves of a block of a cycle that ends over `end`; None if they are not known.

        They are LinuxCNC's (interp_cycles.cc, convert_cycle_xy).

        In a cycle that goes on, R and Z need not be repeated; the height before the first one is
        kept, and G98 returns to it.
        """
        state = self._state
        word = block.words.get("motion", state.cycle)
        if word != state.cycle:
            state.cycle, state.hole = word, {}
        if math.isnan(state.above):
            state.above = state.z
        for letter in block.values.keys() & {"R", "Z"}:
            state.hole[letter] = self._coordinate(block, letter)
        for letter in ("R", "Z"):
            if letter not in state.hole:
                self._report(block, "missing-word", f"{word} without {letter}")
        count = int(block.value(self._reading.repeats, 1.0))
        if not 1 <= count <= MOST_HOLES:
            self._report(block, "number", f"{word} makes {count} holes", "", f"1 to {MOST_HOLES}")
        elif len(state.hole) == 2:
            return self._moves_of_holes(block, end, count)
        return None

    def _moves_of_holes(self, block: Block, end: complex, count: int) -> list[Step] | None:
        state = self._state
        incremental = state.mode("distance") == "incremental"
        above = state.above
        r = state.hole["R"] + (above if incremental else 0.0)
        bottom = state.hole["Z"] + (r if incremental else 0.0)
        if r < bottom:
            what = f"{state.cycle} retracts to R at Z {r:g} mm, below the bottom of the hole"
            self._report(block, "conflict", what, allowed=f"Z {bottom:g} mm or more")
            return None
        step = end - state.place if incremental else 0j
        steps: list[Step] = []
        height = state.z
        if above < r:
            steps.append(("rapid", state.place, r))
            above = height = r
        clear = r if state.mode("return") == "return to R" else above
        for k in range(count):
            place = end + k * step
            # The first hole is approached at the present height if that is above R.
            height = height if k == 0 and height > r else clear
            steps += [("rapid", place, height), ("rapid", place, r), ("line", place, bottom)]
            if state.mode("motion") == "bores":
                steps.append(("line", place, r))
            steps.append(("rapid", place, clear))
        return steps

    def _target(self, block: Block) -> tuple[complex, float]:
        """End of the move [mm]; where it stays along an axis, the present position."""
        state = self._state
        polar = block.arc == "polar" or not block.values.keys().isdisjoint(("PR", "PA"))
        place = self._polar(block) if polar else state.place
        coordinates = {"X": place.real, "Y": place.imag, "Z": state.z}
        scale = state.unit
        incremental = state.mode("distance") == "incremental"
        for axis in AXES:
            if axis not in block.values:
                continue
            value = self._coordinate(block, axis)
            # Each number of decimals is looked at once: programs may have millions of coordinates.
            printed = (block.values[axis].decimals, scale)
            if printed not in self._printed:
                self._printed.add(printed)
                state.step = min(state.step, 10.0 ** -printed[0] * scale)
                self._check_decimals(block, axis, printed[0])
            coordinates[axis] = value + (
                coordinates[axis] if block.relative.get(axis, incremental) else 0.0
            )
        return complex(coordinates["X"], coordinates["Y"]), coordinates["Z"]

    def _polar(self, block: Block) -> complex:
        state = self._state
        arm = state.place - state.pole
        radius = block.value("PR") * self._state.unit if "PR" in block.values else abs(arm)
        angle = math.degrees(phase(arm)) if not cmath.isnan(arm) else math.nan
        if "PA" in block.values:
            relative = block.relative.get("PA", False)
            angle = block.value("PA") + (angle if relative else 0.0)
        return state.pole + cmath.rect(radius, math.radians(angle))

    def _home(self, block: Block) -> Set[str]:
        """Move to the reference, by way of the position that the block states."""
        state = self._state
        axes = [axis for axis in AXES if axis in block.values]
        if state.side:
            self._report(block, "compensation", "a traverse home under compensation")
        if any(self._leads_away(block, axis) for axis in axes):
            self._check_unit(block)
            self._make(block, "rapid", *self._target(block), None)
        # Without axes all of them move.
        gone = axes or list(AXES)
        z = RETRACTED if "Z" in gone else state.z
        self._make(block, "rapid", UNKNOWN if {"X", "Y"} & set(gone) else state.place, z, None)
        return STRAIGHT

    def _leads_away(self, block: Block, axis: str) -> bool:
        """Whether the position on the way home is another one than the present."""
        incremental = self._state.mode("distance") == "incremental"
        if block.relative.get(axis, incremental):
            return block.value(axis) != 0.0
        coordinate = {"X": self._state.place.real, "Y": self._state.place.imag, "Z": self._state.z}[
            axis
        ]
        return block.value(axis) * self._state.unit != coordinate

    def _machine_position(self, block: Block, motion: str) -> Set[str]:
        """Move to a position in the machine's own coordinates, where Z is at its top."""
        state, word = self._state, block.words["machine position"]
        add = self._findings.add
        if motion != "rapid" and not (motion == "line" and "cut" in self._reading.machine_position):
            add(block.line, "conflict", f"{word} with a cut: machine positions are for traverses")
            motion = "rapid"
        if state.side:
            add(block.line, "compensation", f"{word} under compensation")
        relative = state.mode("distance") == "incremental" and not block.relative
        if relative and "incremental" not in self._reading.machine_position:
            add(block.line, "conflict", f"{word} while distances are incremental")
        place = UNKNOWN if {"X", "Y"} & block.values.keys() else state.place
        z = RETRACTED if "Z" in block.values else state.z
        self._make(block, "rapid" if motion == "rapid" else "line", place, z, None)
        return STRAIGHT

    def _make(self, block: Block, kind: Kind, end: complex, z_end: float, arc: Arc | None) -> None:
        """Make a move, check it, and go on from its end; FileError if there are too many moves."""
        state = self._state
        if len(self.moves) >= PROGRAM_MOVES:
            raise beyond(
                "the program", f"more than {PROGRAM_MOVES:,} moves", PROGRAM_MOVES, PROGRAM
            )
        turning = -1.0 if state.mode("spindle") == "spindle counter-clockwise" else 1.0
        move = CutterMove(
            kind=kind,
            start=state.place,
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
        self._hazards.check(move, state)
        if kind != "rapid":
            self._check_frame(block)
            if math.isnan(state.cut_scale):
                state.cut_scale = state.scale
            state.cut_blending = max(state.cut_blending, state.blending)
            state.cut_naive_cam = max(state.cut_naive_cam, state.naive_cam)
        self._compensate(move)
        self.moves.append(move)
        if end != state.place:
            way = move.course.heading(end)
            state.heading = way / abs(way) if way else UNKNOWN
        state.place, state.z = end, z_end

    # -- checks ---------------------------------------------------------------------------------

    def _check_unit(self, block: Block) -> None:
        state = self._state
        if math.isnan(state.scale) and any(block.value(axis) for axis in (*AXES, *ARMS, "R")):
            what = "coordinates before a unit is stated: mm is assumed"
            words = self._controller.machine.unit
            self._report(block, "unit", what, allowed=f"{words.mm} or {words.inch}")
            state.scale = 1.0

    def _check_decimals(self, block: Block, axis: str, decimals: int) -> None:
        """Report more decimals than the controller reads, once in a program."""
        most = self._controller.machine.numbers.most_decimals
        allowed = most.inch if self._state.mode("unit") == "inch" else most.mm
        if decimals > allowed and not self._fine:
            self._fine = True
            text = f"{axis}{block.values[axis].text}"
            what = "more decimals than the controller reads"
            self._report(block, "decimals", what, text, f"at most {allowed}")

    def _check_bare(self, block: Block) -> None:
        """Report a block without coordinates that asks for a motion that needs them."""
        motion = block.codes.get("motion", "")
        if motion == "line" and not self._state.feed > 0.0:
            word = block.words["motion"]
            self._report(block, "no-feed", f"{word} without a feed F")
        if motion in ARCS:
            self._report(block, "missing-word", "an arc without its end point and its centre")
        elif motion in CYCLES:
            self._report(block, "missing-word", f"{block.words['motion']} without coordinates")
        elif block.words.get("machine position") == "G53" and not (
            motion or ("G53" in self._reading.bare and self._state.mode("motion") not in ARCS)
        ):
            self._report(block, "missing-word", "G53 without coordinates")

    def _check_frame(self, block: Block) -> None:
        """Report, once, what was not stated before the first cut."""
        if self._framed:
            return
        self._framed = True
        missing = [word for group in NEEDED if (word := self._missing(group))]
        if missing:
            self._report(block, "frame", f"cut without {', '.join(missing)}")

    def _missing(self, group: str) -> str:
        """The word of a group that the profile's own programs state, if one is missing."""
        controller, state = self._controller, self._state
        if state.mode(group) or group not in controller.groups:
            return ""
        if group == "unit" and not math.isnan(state.scale):
            return ""  # found at the first coordinate
        words = controller.group_words(group)
        if group == "centres" and len(words) < 2:
            return ""  # there is no choice
        program = controller.machine.program
        stated = " ".join((*program.safe_start, *controller.machine.work_offsets.values())).split()
        usual = [word for word in stated if word in words]
        return usual[0] if usual else min(words, key=lambda word: (len(word), word))

    def _compensate(self, move: CutterMove) -> None:
        state = self._state
        if state.side:
            radius = state.stated_radius
            if math.isnan(radius):
                radius = self._radii.get(state.radius_offset, math.nan) + state.oversize
            if move.kind != "rapid" or move.start != move.end:
                self._compensator.take(move, state.side, radius)
        elif state.left_compensation:
            self._compensator.leave(move, self._radii.get(move.tool, math.nan) + state.oversize)
            state.left_compensation = 0


# -- hazards --------------------------------------------------------------------------------------
# Dangers of single moves, judged by the move and the state in which it is made.


SLACK: Final = 1e-9
"""Rounding by the conversion of units [mm]: heights are compared as they are printed."""


class Hazards:
    """Checks moves for dangers, one after another."""

    def __init__(self, controller: Controller, bench: WorkData, findings: Findings) -> None:
        self._controller = controller
        self._bench = bench
        self._findings = findings
        self._reported: set[str] = set()

    def check(self, move: CutterMove, state: State) -> None:
        """Report what is dangerous in a move."""
        if move.kind == "rapid":
            self._rapid(move)
            if move.z_end != move.z_start and math.isfinite(move.z_end) and state.tool:
                what = "a traverse along Z before a tool length offset is active"
                self._length(move, state.has_length, what)
        else:
            self._cut(move, state)

    def _rapid(self, move: CutterMove) -> None:
        bench, add = self._bench, self._findings.add
        low = min(move.z_start, move.z_end)
        if math.isnan(move.z_start) or math.isnan(move.z_end):
            low = math.nan
        # NaN differs from itself: an unknown place that stays unknown at the reference is no
        # motion.
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
            self._length(move, in_force, "a cut without an active tool length offset")
        if move.coolant == "off" and min(move.z_start, move.z_end) < self._bench.stock_top:
            state.dry = state.dry or move.line

    def _length(self, move: CutterMove, holds: bool, what: str) -> None:
        """Report that no tool length offset is active, if the controller needs one."""
        needed = self._controller.changes_tools and self._controller.length_letter
        self._once(move, "tool-length", holds or not needed, what)

    def _once(self, move: CutterMove, rule: str, holds: bool, what: str) -> None:
        """Report what does not hold, the first time of several in a row: each further cut breaks
        the rule too, until it is kept again.
        """
        if holds:
            self._reported.discard(rule)
        elif rule not in self._reported:
            self._reported.add(rule)
            self._findings.add(move.line, rule, what)


# -- arcs -----------------------------------------------------------------------------------------
# Arcs as controllers take them: centre and sweep from what a block states.


NO_ARC: Final = 5e-7
"""Sweep [rad] up to which Grbl makes a full circle of an arc (ARC_ANGULAR_TRAVEL_EPSILON in its
config.h): its printed ends are the same point, nearly."""

NEARLY_FULL: Final = math.radians(1.0)
"""An arc that is short of a full circle by less is probably meant as a short one the other way."""

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

    def drop(self, place: complex, z: float) -> tuple[complex, float]:
        """A point in the coordinates of the plane, and its height over it."""
        point = (place.real, place.imag, z)
        return complex(point[self.first], point[self.second]), point[self.across]

    def lift(self, place: complex, height: float) -> tuple[complex, float]:
        """The point at a place of the plane: X and Y, and Z."""
        point = [0.0, 0.0, 0.0]
        point[self.first], point[self.second] = place.real, place.imag
        point[self.across] = height
        return complex(point[0], point[1]), point[2]


PLANES: Final = {"plane XY": Plane(0, 1, 2), "plane ZX": Plane(2, 0, 1), "plane YZ": Plane(1, 2, 0)}
"""Planes by what G17, G18 and G19 mean; in each G3 turns from the first axis to the second."""


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


def arc_by_centre(
    start: complex, end: complex, centre: complex, *, ccw: bool, turns: int = 0
) -> Arc:
    """The arc about a centre; where its ends coincide it is a full circle."""
    first, last = start - centre, end - centre
    # Towards growing angles, from 0 to a revolution.
    turn = phase(last / first) % TURN if first and last else 0.0
    if start == end or not (first and last):
        turn = TURN
    elif not ccw:
        turn = turn - TURN if turn else -TURN
    sweep = abs(turn) + turns * TURN
    return Arc(centre, sweep if ccw else -sweep, abs(abs(first) - abs(last)))


def arc_by_radius(start: complex, end: complex, radius: float, *, ccw: bool, turns: int = 0) -> Arc:
    """The arc of a radius; the larger one if the radius is negative, half a circle if it is too
    small, in which case the mismatch states by how much.
    """
    chord = end - start
    half, size = 0.5 * abs(chord), abs(radius)
    height = math.sqrt(max(size * size - half * half, 0.0))
    # The centre of an arc of less than half a revolution is on the side to which it turns.
    left = ccw if radius > 0.0 else not ccw
    side = 1j if left else -1j
    centre = 0.5 * (start + end) + side * chord / abs(chord) * height
    return Arc(
        centre, arc_by_centre(start, end, centre, ccw=ccw, turns=turns).sweep, max(half - size, 0.0)
    )


def tangent_arc(start: complex, end: complex, heading: complex) -> Arc | None:
    """The arc that begins in a heading; None if that leads straight to the end, or back."""
    chord = end - start
    # The chord makes half the angle of the arc with the tangent at its start.
    turn = 2.0 * phase(chord / heading) if chord and heading else 0.0
    if abs(math.sin(0.5 * turn)) < 1e-9:
        return None
    radius = 0.5 * abs(chord) / math.sin(0.5 * turn)  # positive to the left
    return Arc(start + 1j * heading / abs(heading) * radius, turn, 0.0)


def fillet_arc(
    start: complex, corner: complex, end: complex, radius: float
) -> tuple[complex, complex, Arc] | None:
    """Ends of the arc that rounds a corner of two lines, and the arc; None if it does not fit."""
    way, onward = corner - start, end - corner
    if cmath.isnan(way) or cmath.isnan(onward) or not (way and onward):
        return None
    turn = phase(onward / way)
    # Distance of the tangent points from the corner.
    cut = radius * math.tan(0.5 * abs(turn))
    if not 0.0 < cut <= min(abs(way), abs(onward)):
        return None
    first = corner - way / abs(way) * cut
    last = corner + onward / abs(onward) * cut
    centre = first + way / abs(way) * radius * (1j if turn > 0.0 else -1j)
    return first, last, Arc(centre, turn, 0.0)


def chord_ends(start: complex, end: complex, arc: Arc) -> list[complex]:
    """Ends of chords along an arc, from its radius at the start to that at its end."""
    first, last = start - arc.centre, end - arc.centre
    size = max(abs(first), abs(last), CHORDS)
    # A chord over the angle a has the sagitta r (1 - cos(a / 2)).
    count = math.ceil(abs(arc.sweep) / max(2.0 * math.acos(1.0 - CHORDS / size), SHORTEST))
    # A difference of the radii is spread evenly over the chords.
    grown = (abs(last) / abs(first) - 1.0) / max(count, 1)
    points = [
        arc.centre + first * (1.0 + k * grown) * cmath.exp(1j * arc.sweep * k / count)
        for k in range(1, count)
    ]
    return [*points, end]


# -- arc words ------------------------------------------------------------------------------------
# What the words of a block say of an arc, and whether the controller takes such an arc.


ARC_SLACK = 1e-9
"""Rounding of lengths compared with a limit [mm]."""

MOST_TURNS = 1_000

MUCH = 100.0
"""Multiple of the smallest limit on the difference of an arc's radii, above which it is refused
whatever its size."""

HALF = 0.5 * TURN
"""Sweep up to which a profile divides arcs where the controller takes larger ones [rad]."""


class ArcReader(BlockReader):
    """Reads arcs."""

    def __init__(self, controller: Controller, state: State, findings: Findings) -> None:
        super().__init__(controller, state, findings)
        self._plane = PLANES["plane XY"]
        self._start = state.place

    def read(
        self, block: Block, end: complex, z_end: float, *, ccw: bool
    ) -> tuple[complex, Arc | None] | None:
        """End and arc of a block; no arc where it is a straight line, and None if it is neither."""
        state = self._state
        self._plane = PLANES[state.mode("plane") or "plane XY"]
        self._start, height = self._plane.drop(state.place, state.z)
        finish, last = self._plane.drop(end, z_end)
        if cmath.isnan(self._start) or cmath.isnan(finish):
            if not state.lost:
                self._report(block, "unknown-position", "an arc from an unknown position")
            state.lost = True
            return None
        if block.arc == "tangent":
            return end, self._tangent(block, end)
        if block.arc == "polar":
            finish, arc = self._polar(block, finish, ccw=ccw)
            end = finish
        else:
            stated_arc = self._arc_from_words(block, finish, ccw=ccw)
            if stated_arc is None:
                return None
            arc = stated_arc
        self._check(block, finish, arc)
        helix = self._reading.helix
        rises = abs(last - height) > 0.0  # not where one of them is unknown
        if rises and helix != "any" and (helix, block.arc) != ("polar", "polar"):
            allowed = "with CP" if helix == "polar" else "arcs at constant Z"
            self._report(block, "helix", "an arc that changes Z", allowed=allowed)
        return end, arc

    def _arc_from_words(self, block: Block, end: complex, *, ccw: bool) -> Arc | None:
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
            self._report(
                block,
                "no-arc",
                f"an arc without {' or '.join(plane.axes)}",
                allowed="the end of the arc",
            )
            return None
        if block.arc == "pole":
            if cmath.isnan(self._state.pole):
                self._report(block, "no-arc", "an arc before its centre is stated", allowed="CC")
                return None
            return arc_by_centre(start, end, self._state.pole, ccw=ccw)
        if arms and "R" not in block.values:  # with both, R counts (Fanuc 15i, B-63324EN, 4.4)
            centre = self._centre(block)
            least = self._reading.smallest_radius
            if centre is None:
                return None
            if centre in (start, end) or min(abs(start - centre), abs(end - centre)) < least:
                self._report(block, "no-arc", "an arc whose centre is at its start or its end")
                return None
            return arc_by_centre(start, end, centre, ccw=ccw, turns=self._turns(block))
        if "R" not in block.values:
            self._report(
                block,
                "no-arc",
                "an arc without centre or radius",
                allowed=f"{' and '.join(plane.arms)}, or R",
            )
            return None
        radius = self._coordinate(block, "R")
        if start == end:
            what = "an arc stated by its radius alone that ends where it begins"
            self._report(block, "no-arc", what, allowed="its centre")
            return None
        arc = arc_by_radius(start, end, radius, ccw=ccw, turns=self._turns(block))
        if arc.mismatch > self._difference(self._reading.short_radius) + ARC_SLACK:
            self._report(
                block, "arc-radius", f"the radius of the arc is too short by {arc.mismatch:.6g} mm"
            )
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
        for arm, base in zip(self._plane.arms, (self._start.real, self._start.imag), strict=True):
            # A block may override the mode for single words, as Sinumerik does by AC and IC.
            is_absolute = not block.relative[arm] if arm in block.relative else absolute
            if arm not in block.values:
                if is_absolute and arm not in block.relative and absolute:
                    what, allowed = f"an absolute centre without {arm}", "both arms"
                    if not self._form(block, what, allowed, "half an absolute centre"):
                        return None
                parts.append(base)
                continue
            parts.append(self._coordinate(block, arm) + (0.0 if is_absolute else base))
        return complex(*parts)

    def _turns(self, block: Block) -> int:
        """Full turns beyond the arc itself."""
        if "TURN" in block.values:
            return int(max(block.value("TURN"), 0.0))
        count = block.values.get("P") if self._reading.turns == "P" else None
        if count is None:
            return 0
        if count.value < 1.0 or count.value % 1.0 or count.value > MOST_TURNS:
            what = "P of an arc, its number of revolutions, must be a whole number"
            self._report(block, "number", what, count.text, f"1 to {MOST_TURNS}")
            return 0
        return int(count.value) - 1

    def _polar(self, block: Block, end: complex, *, ccw: bool) -> tuple[complex, Arc]:
        """An arc about the pole by an angle; an incremental one may be of many turns."""
        state = self._state
        if "PA" in block.values and block.relative.get("PA"):
            sweep = math.radians(abs(block.value("PA"))) * (1.0 if ccw else -1.0)
            if (block.value("PA") > 0.0) != ccw:
                self._form(block, "the sign of the angle contradicts the direction of rotation", "")
            end = state.pole + (state.place - state.pole) * cmath.exp(1j * sweep)
            return end, Arc(state.pole, sweep, 0.0)
        return end, arc_by_centre(state.place, end, state.pole, ccw=ccw)

    def _tangent(self, block: Block, end: complex) -> Arc | None:
        heading = self._state.heading
        if cmath.isnan(heading):
            self._report(block, "no-arc", "a tangential arc that no move precedes")
            return None
        return tangent_arc(self._state.place, end, heading)

    def _difference(self, stated: float | None) -> float:
        """A limit of what is read [mm]; if none is known, that of what is written."""
        return self._controller.machine.arcs.radius_tolerance if stated is None else stated

    def _check(self, block: Block, end: complex, arc: Arc) -> None:
        """Report an arc that the controller does not accept."""
        limit = self._reading.radius_difference
        inch = self._state.mode("unit") == "inch"
        stated = None if limit is None else limit.inch if inch else limit.mm
        least = self._difference(stated)
        larger = max(abs(self._start - arc.centre), abs(end - arc.centre))
        most = max(least, min(limit.relative * larger, MUCH * least)) if limit else least
        if "R" not in block.values and arc.mismatch > most + ARC_SLACK:
            what = f"the radii of the arc differ by {arc.mismatch:.6g} mm"
            self._report(block, "arc-radius", what, allowed=f"at most {most:g} mm")
        self._check_sweep(block, end, abs(arc.sweep))

    def _check_sweep(self, block: Block, end: complex, turn: float) -> None:
        limits, add = self._controller.machine.arcs, self._findings.add
        step, chord = self._state.step, abs(end - self._start)
        # What rounding of the printed points may add to the sweep [rad].
        slack = 3.0 * step / chord if chord and math.isfinite(step) else 0.0
        if self._start == end and block.arc != "polar":
            if not limits.full_circle:
                what = "an arc that ends where it begins"
                add(block.line, "full-circle", what, allowed="two arcs of half a turn")
            return
        if turn <= NO_ARC or (TURN - NEARLY_FULL < turn < TURN and block.arc != "polar"):
            what = f"an arc of {math.degrees(turn):.6g} degrees between ends that nearly coincide"
            add(block.line, "full-circle", what, allowed="a line")
        elif limits.largest_turn < HALF and turn > limits.largest_turn + slack:
            what = f"an arc of {math.degrees(turn):.6g} degrees"
            add(block.line, "arc-sweep", what, allowed=f"at most {limits.largest_sweep:g} degrees")

    def _form(self, block: Block, what: str, allowed: str, form: str = "") -> bool:
        """Report the form of an arc; return whether the controller accepts it nevertheless."""
        refused = form in self._reading.arc_forms
        self._report(block, "no-arc" if refused else "arc-form", what, allowed=allowed)
        return not refused
