"""Moves of a block: where they end, and what they are."""

from __future__ import annotations

import cmath
import math
from collections.abc import Set
from dataclasses import replace
from typing import Final

from camgeo.numeric.arrays import phase
from camgeo.reading import PROGRAM, PROGRAM_MOVES, beyond
from camgeo.verifying.linting import Bench
from camgeo_export.gcode.moves import CutterMove, Kind
from camgeo_export.interpreter.arc_words import ArcReader
from camgeo_export.interpreter.arcs import PLANES, Arc, about_pole, chords, heading_after, rounded
from camgeo_export.interpreter.block import ARMS, AXES, Block
from camgeo_export.interpreter.codes import CYCLE
from camgeo_export.interpreter.compensation import Compensator
from camgeo_export.interpreter.controller import Controller
from camgeo_export.interpreter.frame import Frame
from camgeo_export.interpreter.hazards import Hazards
from camgeo_export.interpreter.holes import CYCLES, HoleReader
from camgeo_export.interpreter.quantities import coordinate
from camgeo_export.interpreter.rules import Findings
from camgeo_export.interpreter.state import RETRACTED, UNKNOWN, State

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
