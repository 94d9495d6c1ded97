"""What the words of a block say of an arc, and whether the controller takes such an arc."""

from __future__ import annotations

import cmath
import math

from camgeo.units import TURN
from camgeo_export.interpreter.arcs import (
    AMBIGUOUS,
    NEARLY_FULL,
    NO_ARC,
    PLANES,
    Arc,
    by_radius,
    swept,
    tangent,
)
from camgeo_export.interpreter.block import ARMS, Block
from camgeo_export.interpreter.controller import Controller
from camgeo_export.interpreter.quantities import coordinate
from camgeo_export.interpreter.rules import Findings
from camgeo_export.interpreter.state import State

SLACK = 1e-9
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
        if arc.mismatch > self._difference(self._reading.short_radius) + SLACK:
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
        if "R" not in block.values and arc.mismatch > most + SLACK:
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
