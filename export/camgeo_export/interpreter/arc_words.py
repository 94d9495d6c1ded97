"""What the words of a block say of an arc, and whether the controller takes such an arc."""

from __future__ import annotations

import cmath
import math

from camgeo.units import TURN
from camgeo_export.interpreter.arcs import (
    AMBIGUOUS,
    NEARLY_FULL,
    NO_ARC,
    Arc,
    by_radius,
    swept,
    tangent,
)
from camgeo_export.interpreter.block import AXES, Block
from camgeo_export.interpreter.controller import Controller
from camgeo_export.interpreter.lengths import coordinate
from camgeo_export.interpreter.rules import Findings
from camgeo_export.interpreter.state import State

SLACK = 1e-9
"""Rounding of lengths compared with a limit [mm]."""


class ArcReader:
    """Reads arcs."""

    def __init__(self, controller: Controller, state: State, findings: Findings) -> None:
        self._controller = controller
        self._state = state
        self._findings = findings

    def read(
        self, block: Block, end: complex, z_end: float, *, ccw: bool
    ) -> tuple[complex, Arc | None] | None:
        """End and arc of a block; no arc where it is a straight line, and None if it is neither."""
        state = self._state
        if state.mode("plane") not in ("", "plane XY"):
            what = f"an arc in the {state.mode('plane')}: only arcs in the plane XY are read"
            self._findings.add(block.line, "plane", what)
            return None
        if cmath.isnan(state.at) or cmath.isnan(end):
            self._findings.add(block.line, "unknown-position", "an arc from an unknown position")
            return None
        if block.arc == "tangent":
            return end, self._tangent(block, end)
        if block.arc == "polar":
            end, arc = self._polar(block, end, ccw=ccw)
        else:
            found = self._of_words(block, end, ccw=ccw)
            if found is None:
                return None
            arc = found
        self._check(block, end, z_end, arc)
        return end, arc

    def _of_words(self, block: Block, end: complex, *, ccw: bool) -> Arc | None:
        start = self._state.at
        arms = [arm for arm in "IJ" if arm in block.values]
        if "K" in block.values:
            self._form(block, "the word K with an arc in the plane XY", "I and J")
        if "R" in block.values and arms:
            self._form(block, "an arc with its radius and its centre", "one of them")
        if block.arc == "pole":
            if cmath.isnan(self._state.pole):
                self._none(block, "an arc before its centre is stated", "CC")
                return None
            return swept(start, end, self._state.pole, ccw=ccw)
        if arms and "R" not in block.values:  # with both, R counts (Fanuc 15i, B-63324EN, 4.4)
            centre = self._centre(block)
            if not (centre - start):
                self._none(block, "an arc with its centre at its start", "")
                return None
            return swept(start, end, centre, ccw=ccw, turns=self._turns(block))
        if "R" not in block.values:
            self._none(block, "an arc without centre or radius", "I and J, or R")
            return None
        radius = coordinate(block, "R", self._controller, self._state.mode("unit")) * self._scale
        if start == end:
            what = "an arc of which only the radius is stated, that ends where it begins"
            self._none(block, what, "its centre")
            return None
        arc = by_radius(start, end, radius, ccw=ccw)
        turn = abs(arc.sweep)
        if abs(turn - math.pi) < AMBIGUOUS or TURN - turn < AMBIGUOUS:
            what = f"an arc of {math.degrees(turn):.1f} degrees stated by its radius is ill defined"
            self._form(block, what, "its centre")
        return arc

    def _centre(self, block: Block) -> complex:
        state = self._state
        absolute = state.mode("centres") == "absolute centres" or (
            not state.mode("centres") and self._controller.machine.arcs.centre == "absolute"
        )
        parts = []
        for arm, at in (("I", state.at.real), ("J", state.at.imag)):
            own = not block.relative[arm] if arm in block.relative else absolute
            if arm not in block.values:
                if own and arm not in block.relative and absolute:
                    self._form(block, f"an absolute centre without {arm}", "I and J")
                parts.append(at)
                continue
            value = coordinate(block, arm, self._controller, state.mode("unit")) * self._scale
            parts.append(value + (0.0 if own else at))
        return complex(*parts)

    def _turns(self, block: Block) -> int:
        """Full turns beyond the arc itself."""
        if "TURN" in block.values:
            return int(max(block.value("TURN"), 0.0))
        count = block.values.get("P")
        if count is None:
            return 0
        if count.value < 1.0 or count.value % 1.0:
            self._form(block, "P of an arc, its number of turns, must be whole", "1 or more")
        return int(max(count.value, 1.0)) - 1

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

    def _check(self, block: Block, end: complex, z_end: float, arc: Arc) -> None:
        """Whether the controller takes the arc."""
        limits, add = self._controller.machine.arcs, self._findings.add
        radius, turn = abs(self._state.at - arc.centre), abs(arc.sweep)
        if arc.mismatch > limits.radius_tolerance + SLACK:
            what = "the radii of the arc differ by"
            allowed = f"at most {limits.radius_tolerance:g} mm"
            add(block.line, "arc-radius", f"{what} {arc.mismatch:.6g} mm", allowed=allowed)
        if not limits.smallest_radius - SLACK <= radius <= limits.largest_radius + SLACK:
            allowed = f"{limits.smallest_radius:g} to {limits.largest_radius:g} mm"
            add(block.line, "arc-size", f"an arc of radius {radius:.6g} mm", allowed=allowed)
        if z_end != self._state.z and not limits.helical:
            add(block.line, "helix", "an arc that changes Z", allowed="arcs at constant Z")
        self._check_sweep(block, end, turn)

    def _check_sweep(self, block: Block, end: complex, turn: float) -> None:
        limits, add = self._controller.machine.arcs, self._findings.add
        start = self._state.at
        if start == end and block.arc != "polar":
            stated = any(axis in block.values for axis in AXES[:2])
            if not limits.full_circle:
                what = "an arc that ends where it begins"
                add(block.line, "full-circle", what, allowed="two arcs of half a turn")
            elif stated and limits.largest_turn < TURN:
                what = "an arc that ends where it begins is a full circle: perhaps not meant"
                allowed = f"arcs of at most {limits.largest_sweep:g} degrees"
                add(block.line, "full-circle", what, allowed=allowed)
            return
        if turn <= NO_ARC or (turn > TURN - NEARLY_FULL and block.arc != "polar"):
            what = f"an arc of {math.degrees(turn):.6g} degrees between ends that nearly coincide"
            add(block.line, "full-circle", what, allowed="a line")
        elif turn > limits.largest_turn + self._slack(end):
            what = f"an arc of {math.degrees(turn):.6g} degrees"
            add(block.line, "arc-sweep", what, allowed=f"at most {limits.largest_sweep:g} degrees")

    def _slack(self, end: complex) -> float:
        """What rounding of the printed points may add to a sweep [rad]."""
        step = self._state.step
        chord = abs(end - self._state.at)
        return 3.0 * step / chord if chord and math.isfinite(step) else 0.0

    @property
    def _scale(self) -> float:
        return 1.0 if math.isnan(self._state.scale) else self._state.scale

    def _none(self, block: Block, what: str, allowed: str) -> None:
        self._findings.add(block.line, "no-arc", what, allowed=allowed)

    def _form(self, block: Block, what: str, allowed: str) -> None:
        self._findings.add(block.line, "arc-form", what, allowed=allowed)
