"""One block run by the controller, in the order in which controllers take its words.

The order is that of LinuxCNC (docs/src/gcode/overview.adoc, "G-code Order of Execution"), which is
that of RS274/NGC; where other controllers differ, the block is ambiguous, and a finding says so.
"""

from __future__ import annotations

import math
from typing import Final

from camgeo.units import MM_PER
from camgeo_export.gcode.moves import Event
from camgeo_export.interpreter.controller import UNKNOWN, Controller, State
from camgeo_export.interpreter.decode import unused
from camgeo_export.interpreter.holes import dwell_of, feed
from camgeo_export.interpreter.iso import AXES, Block, Findings
from camgeo_export.interpreter.motion import Mover

EVENTS: Final = {
    "tool change": "tool",
    "spindle off": "spindle",
    "stop": "flow",
    "end": "flow",
    "dwell": "dwell",
}
"""Groups of the words that cause events."""

ALWAYS: Final = frozenset("FNOS")
"""Words that any block may have."""

MOTION: Final = frozenset({"motion"})

TOOLS: Final = frozenset({"D", "H", "T", "OFFN"})
"""Words that do something without a G or M word."""

SIMPLE: Final = ("plane", "distance", "centres", "cycle", "return")
"""Groups of which a word changes nothing but the mode."""


class Executor:
    """Runs blocks on one state.

    Attributes
    ----------
    state : of the controller.
    events : stops, tool changes and dwells so far.
    """

    def __init__(
        self, controller: Controller, mover: Mover, state: State, findings: Findings
    ) -> None:
        self.state = state
        self.events: list[Event] = []
        self._controller = controller
        self._reading = controller.machine.reading
        self._mover = mover
        self._findings = findings
        self._used: set[str] = set()

    def run(self, block: Block) -> None:
        """Run one block."""
        if block.broken:
            self._mover.skip(block)
            return
        self._used = set(ALWAYS)
        # Most blocks only move, and some set a feed.
        moving = block.codes.keys() <= MOTION and not block.actions
        late = "unit" in block.codes and self._reading.feed_unit == "before"
        if late:
            self._feed_and_speed(block)
        if not moving:
            self._check_order(block)
            self._unit(block)
        if not late:
            self._feed_and_speed(block)
        if not moving or not block.values.keys().isdisjoint(TOOLS):
            self._modes(block)
        self._used |= self._mover.move(block)
        if not moving:
            if self._ends_late:
                self._spindle(block, off=True)
                self._coolant(block, off=True)
            self._flow(block)
        unused(block, self._used, self._findings)

    @property
    def _ends_late(self) -> bool:
        """Whether words that switch spindle and coolant off take effect behind the motion."""
        return self._controller.machine.dialect == "klartext"

    def _modes(self, block: Block) -> None:
        """What a block switches before it moves."""
        self._tool(block)
        self._spindle(block, off=False)
        self._coolant(block, off=False)
        if not self._ends_late:
            self._spindle(block, off=True)
            self._coolant(block, off=True)
        self._dwell(block)
        if block.codes.get("plane", "plane XY") != (self.state.mode("plane") or "plane XY"):
            self._check_compensated(block, ("plane",))
        for group in SIMPLE:
            if group in block.codes:
                self.state.modes[group] = block.codes[group]
        if "cycle" in block.codes:
            self._mover.end_cycle(block)
        self._compensation(block)
        self._check_compensated(block, ("length", "work offset", "path mode"))
        self._length(block)
        self._work_offset(block)
        self._path_mode(block)

    def _report(self, block: Block, rule: str, what: str, value: str = "", ok: str = "") -> None:
        self._findings.add(block.line, rule, what, value, ok)

    def _check_compensated(self, block: Block, groups: tuple[str, ...]) -> None:
        """Find what the controller does not change under compensation."""
        for group in groups:
            if self.state.side and group in block.codes and group in self._reading.compensated:
                self._report(block, "compensation", f"{block.words[group]} under compensation")

    def _check_order(self, block: Block) -> None:
        """Blocks that controllers run in different orders."""
        off = [
            block.words[group]
            for group in ("spindle", "coolant")
            if block.codes.get(group) in ("spindle off", "coolant off")
        ]
        cutting = block.codes.get("motion", self.state.mode("motion")) not in ("", "rapid")
        moving = any(axis in block.values for axis in AXES)
        if off and moving and cutting and self._controller.machine.dialect != "klartext":
            what = f"{off[0]} in a block that cuts: controllers differ in what comes first"
            self._report(block, "order", what, ok="a block of its own")
        unit = block.codes.get("unit", self.state.mode("unit"))
        changes = "F" in block.values and unit != (self.state.mode("unit") or unit)
        if changes and self._reading.feed_unit == "before":
            what = f"F with {block.words['unit']}: it counts in the unit before, not in the new one"
            self._report(block, "order", what, ok="F in the next block")

    # -- words, in the order of execution ---------------------------------------------------------

    def _unit(self, block: Block) -> None:
        if "unit" not in block.codes:
            return
        unit = block.codes["unit"]
        scale = MM_PER["inch"] if unit == "inch" else MM_PER["mm"]
        if self.state.scale not in (scale, math.inf) and not math.isnan(self.state.scale):
            self._report(block, "unit-change", "the unit changes within the program")
        self.state.scale = scale
        self.state.modes["unit"] = unit

    @property
    def _scale(self) -> float:
        """mm in a unit; before one is stated a millimetre."""
        return 1.0 if math.isnan(self.state.scale) else self.state.scale

    def _feed_and_speed(self, block: Block) -> None:
        state = self.state
        mode = block.codes.get("feed mode")
        again = self._reading.feed_mode == "resets"
        if mode is not None and (again or mode != state.mode("feed mode")):
            if again or state.mode("feed mode"):
                state.feed = 0.0  # in another unit from here on
            state.modes["feed mode"] = mode
            if mode == "inverse time":
                self._report(block, "unsupported", f"{block.words['feed mode']} is not read")
        timed = self._controller.dwell_letters if "dwell" in block.actions else ""
        if "S" in block.values and "S" not in timed:
            state.speed = block.value("S")
        if "F" in block.values and "F" not in timed:
            per_turn = state.mode("feed mode") == "feed per revolution"
            numbers = self._controller.machine.numbers
            unit = state.mode("unit")
            part = numbers.inch_feed if unit == "inch" else 1.0
            value = feed(block, self._controller, unit)
            if value != block.value("F"):
                text = f"F{block.values['F'].text}"
                what = f"{text} without a decimal point counts in increments: {value:g} a minute"
                self._report(block, "decimal-point", what, ok=f"{text}.")
            state.feed = value * self._scale * part * (state.speed if per_turn else 1.0)
            self._check_feed(block)

    def _check_feed(self, block: Block) -> None:
        dynamics = self._controller.machine.dynamics
        if dynamics is not None and self.state.feed > dynamics.rapid_feed:
            what = "the feed is faster than the traverses of the machine"
            self._report(
                block, "feed", what, f"{self.state.feed:g} mm/min",
                f"at most {dynamics.rapid_feed:g} mm/min",
            )  # fmt: skip

    def _tool(self, block: Block) -> None:
        state = self.state
        if "T" in block.values:
            state.chosen = int(max(block.value("T"), 0.0))
        self._used |= set("T")
        changes = block.codes.get("tool") == "tool change"
        if not (changes or ("T" in block.values and not self._controller.changes_tools)):
            return
        if changes and not state.chosen:
            self._report(block, "missing-word", "a change of the tool without its number T")
        if changes and state.side:
            self._report(block, "compensation", "a change of the tool under compensation")
        self._leave_tool()
        state.tool, state.measured = state.chosen, 0
        lasting = self._controller.length_letter == "D" and state.offset > 0
        if lasting or self._controller.machine.dialect == "klartext":
            self._put_length(state.tool)  # its length comes into force with it, or its edge D
        if changes:
            state.modes["spindle"] = "spindle off"  # controllers stop it
            self._event(block, "tool change")

    def put_in(self, number: int) -> None:
        """Say which tool is in the spindle from the start, its length set."""
        self.state.chosen = self.state.tool = self.state.offset = number

    def _leave_tool(self) -> None:
        """Judge the coolant of the tool that leaves the spindle."""
        state = self.state
        if state.dry and state.used_coolant:
            what = "a cut without the coolant that the tool has elsewhere"
            self._findings.add(state.dry, "coolant", what)
        state.dry, state.used_coolant = 0, False

    def _spindle(self, block: Block, *, off: bool) -> None:
        """Switch the spindle, if the block switches it `off`, or on."""
        spindle = block.codes.get("spindle")
        if spindle is None or (spindle == "spindle off") != off:
            return
        if spindle == "spindle off":
            self._event(block, "spindle off")
        elif not self.state.speed > 0.0:
            self._report(block, "no-spindle", f"{block.words['spindle']} without a speed S")
        if spindle == "spindle counter-clockwise":
            what = "the spindle turns counter-clockwise: cutters cut clockwise"
            self._report(block, "spindle-sense", what)
        self.state.modes["spindle"] = spindle

    def _coolant(self, block: Block, *, off: bool) -> None:
        """Switch the coolant, if the block switches it `off`, or on."""
        coolant = block.codes.get("coolant")
        if coolant is not None and (coolant == "coolant off") == off:
            self.state.modes["coolant"] = block.codes["coolant"]
            self.state.used_coolant |= self.state.coolant != "off"

    def _dwell(self, block: Block) -> None:
        if "dwell" not in block.actions:
            return
        seconds = dwell_of(block, self._controller, self.state.speed, self._findings)
        if seconds is not None:
            self._event(block, "dwell", seconds)

    def _compensation(self, block: Block) -> None:
        state = self.state
        if "OFFN" in block.values:
            self._used.add("OFFN")
            state.oversize = block.value("OFFN") * self._scale
        found = block.codes.get("compensation")
        if found is None:
            return
        if found == "compensation off":
            if state.side:
                state.left_compensation = block.line
            state.modes["compensation"] = found
            state.radius_offset, state.stated_radius = 0, math.nan
            return
        if state.side:
            self._report(block, "compensation", "compensation is already on")
        self._used |= set("D")
        word = block.words["compensation"]
        state.stated_radius = math.nan
        if word.endswith(".1"):  # D is the diameter itself
            state.stated_radius = 0.5 * block.value("D") * self._scale
        elif "D" in block.values:
            if block.value("D") % 1.0:
                text = block.values["D"].text
                self._report(block, "number", f"D{text} is no number of an offset")
            state.radius_offset = int(max(block.value("D"), 0.0))
        elif not state.radius_offset:
            state.radius_offset = state.tool
        state.modes["compensation"] = found
        self._mover.enter(block)

    def _length(self, block: Block) -> None:
        state = self.state
        if self._controller.length_letter == "D" and "D" in block.values:
            self._used |= set("D")
            self._put_length(state.tool if block.value("D") > 0.0 else 0)
        found = block.codes.get("length")
        if found == "length offset off":
            self._put_length(0)
        elif found == "length offset":
            self._used |= set("HZ")
            number = int(max(block.value("H", state.tool), 0.0))
            if state.tool and number != state.tool:
                what = f"the length of tool {number} is put into force with tool {state.tool}"
                self._report(block, "tool-length", what, ok=f"H{state.tool}")
            self._put_length(number)

    def _put_length(self, number: int) -> None:
        """Put a tool's length into force: where the spindle was, Z is another number now."""
        state = self.state
        if not self._controller.changes_tools:
            number = state.tool  # Z was set with it
        state.measured = state.tool if number else state.measured
        if number != state.offset and math.isfinite(state.z):
            state.z_before, state.z = state.z, math.nan
        state.offset = number

    def _work_offset(self, block: Block) -> None:
        state = self.state
        if "work offset" not in block.codes:
            return
        word = block.words["work offset"]
        if state.work_offset not in ("", word):
            state.at = UNKNOWN
            state.z = state.z if math.isinf(state.z) else math.nan
        state.work_offset = word
        state.modes["work offset"] = "work offset"

    def _path_mode(self, block: Block) -> None:
        state = self.state
        mode = block.codes.get("path mode")
        if mode is not None:
            state.modes["path mode"] = mode
            state.blending = state.naive_cam = 0.0
            if mode == "continuous path":
                self._used |= set("PQ")
                # Without P the controller keeps its speed at any deviation; without Q, Q is P.
                smooth = self._controller.smoothing_letter(block.words["path mode"])
                p = block.value("P", math.inf) if smooth else math.inf
                state.blending = p * self._scale
                q = block.value("Q", p) if self._controller.groups & {"centres"} else 0.0
                state.naive_cam = q * self._scale if math.isfinite(q) else state.blending
        if "smoothing" in block.codes:
            self._smoothing(block)

    def _smoothing(self, block: Block) -> None:
        state = self.state
        letter = self._controller.smoothing_letter(block.words["smoothing"])
        self._used |= set(f"PQER{letter}")
        number = block.values.get("tolerance") or (block.values.get(letter) if letter else None)
        state.naive_cam = 0.0
        if block.names.get("smoothing") == "off" or number is None:
            state.blending = 0.0
        else:
            state.blending = number.value * self._scale

    def _flow(self, block: Block) -> None:
        state = self.state
        flow = block.codes.get("flow")
        if flow is None or flow == "optional stop":
            return
        if flow == "stop":
            self._event(block, "stop")
            return
        self._leave_tool()
        for group, what in (("spindle", "the spindle turns"), ("coolant", "the coolant flows")):
            mode = state.mode(group)
            if mode not in ("", f"{group} off"):
                # M2 and M30 switch them off on most controllers, not on all.
                self._report(block, "left-on", f"{what} at the end of the program")
        if state.side:
            self._report(block, "left-on", "compensation is on at the end of the program")
        self._event(block, "end")
        state.ended = True

    def _event(self, block: Block, kind: str, seconds: float = 0.0) -> None:
        state = self.state
        word = block.words.get(EVENTS[kind]) or block.words.get("flow", kind)
        z = state.z_before if math.isnan(state.z) else state.z
        self.events.append(Event(kind, word, state.at, z, state.tool, seconds, block.line))
