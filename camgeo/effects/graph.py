"""The effects of one design: each is computed once, on demand, together with what it needs.

Where the scene names `speed-fluctuation` or `camshaft-windup`, all effects that depend on the speed
of the cam are computed for the speed that this one finds. What this is found from, the forces on
the follower as functions of speed and acceleration, holds for any speed, and is computed for the
one that the scene gives. An elastic train acts back on it (`camgeo.effects.feedback`).
"""

from __future__ import annotations

import pkgutil
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any, Final, overload

from camgeo.check.finding import Finding, Findings, LazyFindings, folded, stated_in
from camgeo.check.judge import FINDINGS
from camgeo.displayed import clipped
from camgeo.effects.catalogue import Catalogue, Find
from camgeo.effects.effect import Answer, Effect, Key, Result, Subject
from camgeo.effects.inherited import ErrorsWithPremises, InheritedErrors
from camgeo.effects.lost_contact import LostContact
from camgeo.effects.nodes import Nodes, node_name
from camgeo.effects.premises import qualified, trimming
from camgeo.effects.registry import find_effect
from camgeo.effects.results import (
    CONTACT_FORCE,
    FINDERS,
    LIFT_OFF,
    SPEED_FLUCTUATION,
    SPRING,
    Leaving,
    Touching,
)
from camgeo.effects.touching import holds_both_ways
from camgeo.errors import EffectError, GeometryError
from camgeo.lazy import Ledger
from camgeo.motion.time_course import ConstantSpeed, TimeCourse, period
from camgeo.state.state import Speed
from camgeo.units import RPM, TURN, in_unit

AT_FOUND: Final = " at the found speed"
AT_ROUGH: Final = " at the found speed, roughly"
"""What the ledger adds to the names of effects that are computed for this speed."""

OF_RIGID: Final = " of a rigid train"
"""What it adds to what a speed is found from that takes a train as rigid, if no other one does."""

HOLDING: Final = "camgeo.effects.lift_off.holding:holding"
"""Imported only where a follower leaves its flank."""

FED_BACK: Final = "camgeo.effects.feedback:FedBack"
"""Imported only where an elastic train acts back on the speed."""


class Effects:
    """The effects of `subject`, by name.

    Parameters
    ----------
    subject : the design.
    tables : the table of each effect that the scene names, in internal units.
    ledger : records what was computed.
    find : returns the effect with a given name.
    speed : of the cam, for which effects that depend on it are computed; None for the found one if
        the scene names what finds it.
    """

    def __init__(
        self,
        subject: Subject,
        tables: Mapping[str, Mapping[str, Any]],
        ledger: Ledger,
        find: Find = find_effect,
        speed: Speed | None = None,
    ) -> None:
        self.subject = subject
        self.tables = tables
        self.ledger = ledger
        self.catalogue = Catalogue(tables, find, subject.output)
        self._finder = None if speed == "stated" else self.catalogue.finder
        self._stated: Nodes | None = None
        self._found: Nodes | None = None
        self._rigid: Nodes | None = None
        self._whole: dict[str, Any] = {}
        self._judged: dict[str, Any] = {}

    def __repr__(self) -> str:
        return clipped(f"Effects({', '.join(map(repr, self.names))})")

    @property
    def names(self) -> tuple[str, ...]:
        """The effects that the scene names, in its order."""
        return tuple(self.tables)

    def effect(self, name: str) -> Effect:
        """The declaration of the effect `name`; UnknownNameError if there is none."""
        return self.catalogue.effect(name)

    def inputs(self, name: str) -> tuple[str, ...]:
        """See `Catalogue.inputs`."""
        return self.catalogue.inputs(name)

    @overload
    def result(self, name: Key[Answer]) -> Answer: ...

    @overload
    def result(self, name: str) -> Any: ...

    def result(self, name: str) -> Any:
        """The result of the effect `name`, whether or not the scene names it.

        Its findings begin with those that say what the others do not hold for, see
        `camgeo.effects.premises`; they are made when they are looked at.

        Raises
        ------
        UnknownNameError
            If there is no such effect.
        CycleError
            If it needs itself.
        GeometryError
            With the key of the scene, if data are missing.
        EffectError
            If there is no answer for this design.
        """
        with self.ledger.lock:  # another thread may be computing it
            if name not in self._whole:
                self._whole[name] = self._with_premises(name, self._computed(name))
            return self._whole[name]

    def _computed(self, name: str) -> Any:
        """The result of the effect `name` as it computes it; raises as `result`."""
        return self._nodes(name).result(name)

    def _with_premises(self, name: str, result: Any) -> Any:
        """The `result` of the effect `name` with all its findings."""
        if not isinstance(result, Result):
            return result

        def found() -> Findings:
            told: Findings = self.ledger.once(
                FINDINGS + node_name(name), self._judged,
                lambda: Findings(self._qualified(name, result)),
            )  # fmt: skip
            return told

        whole, errors = LazyFindings(found), result.errors
        if isinstance(errors, InheritedErrors):
            errors = ErrorsWithPremises(errors, whole, lambda: self._computed(CONTACT_FORCE).errors)
        return replace(result, findings=whole, errors=errors)

    def course(self, name: str) -> TimeCourse | None:
        """How the cam turns in the state of the effect `name`; None if that is not known.

        Raises EffectError if it is neither found nor given.
        """
        return self._nodes(name).subject.state.course

    def _nodes(self, name: str) -> Nodes:
        """Where the effect `name` is computed.

        Raises
        ------
        EffectError
            If its speed is neither found nor given.
        """
        if self._stated is None:
            feeds = self._finder is not None and self.catalogue.followed(self._finder)
            kind = pkgutil.resolve_name(FED_BACK) if feeds else Nodes
            self._stated = kind(self._given, self.catalogue, self.ledger)
        if self._finder is None and name in FINDERS and self.catalogue.followed(name):
            return self._of_rigid
        if self._finder is None or not self.catalogue.moved(name):
            return self._stated
        if self._found is None:
            self._found = self._turned(self._stated, self._finder)
        return self._found

    @property
    def _of_rigid(self) -> Nodes:
        """Where what finds a speed is computed if no other effect follows that."""
        if self._rigid is None:
            ledger = self.ledger.named(OF_RIGID)
            self._rigid = Nodes(self._given, self.catalogue.rigid(), ledger)
        return self._rigid

    @property
    def _given(self) -> Subject:
        """The design at the speed of the scene; if it gives but a motor, at one near what is to be
        found, for what does not depend on it.
        """
        if self._finder is None or self.subject.state.course is not None:
            return self.subject
        data = self.effect(SPEED_FLUCTUATION).parse(self.tables[SPEED_FLUCTUATION])
        first = data.first_speed
        return self.subject if first is None else self.subject.turning(ConstantSpeed(first))

    def _turned(self, stated: Nodes, finder: str) -> Nodes:
        """The effects at the found speed; if there is none, at that of the scene."""
        try:
            found = stated.result(finder)
        except EffectError as error:
            if self.subject.state.course is not None:
                return Nodes(self.subject, self.catalogue, self.ledger)
            raise EffectError(
                f"the speed of the cam is neither given nor found: {error.message}",
                finding="no-speed",
                cam_angle=error.cam_angle,
            ) from error
        rough = Nodes(
            self.subject.turning(found.rough_course), self.catalogue,
            self.ledger.named(AT_ROUGH), base=stated,
        )  # fmt: skip
        return Nodes(
            self.subject.turning(found.course), self.catalogue,
            self.ledger.named(AT_FOUND), base=stated, rough=rough,
        )  # fmt: skip

    def findings(self, name: str) -> tuple[Finding, ...]:
        """The findings of the effect `name`; a "broken" one that says why if there is no answer."""
        try:
            return tuple(self.result(name).findings)
        except GeometryError as error:
            if error.key:
                raise
            sentence = in_unit(f"not computed: {error.message}", self.subject.unit)
            return (Finding(name, "broken", sentence),)
        except EffectError as error:
            refusal = Finding(
                name=error.finding or name,
                severity="broken",
                sentence=error.message,
                value=error.value,
                limit=error.limit,
                unit=error.unit,
                cam_angle=error.cam_angle,
                cam_range=error.cam_range,
            )
            trimmed = trimming(self.effect(name), self.subject)
            return stated_in(self.subject.unit, (*trimmed, refusal))

    def _qualified(self, name: str, result: Any) -> tuple[Finding, ...]:
        """The findings of the result of `name`, after those that say what they do not hold for."""
        touching = isinstance(result, Touching)
        lost = result.lost_contact if touching else self._lost_contact(name)
        at_speed_of_scene = not touching or name == CONTACT_FORCE
        taken = self._nodes(name).at_found
        named = tuple(each for each in self.names if not (taken and each in FINDERS))
        effect = self.effect(name)
        flies = lost or (lost is not None and effect.premise == "contact")
        flown = self._flown() if flies and at_speed_of_scene else ()
        found = qualified(
            effect, result.findings, self.subject, lost, named, flown,
            holding=self._holding if lost and at_speed_of_scene else "",
            follows=self._follows(effect), elastic=self._is_elastic(effect),
        )  # fmt: skip
        stated = (*self._at_speed(name, result.findings), *found)
        return stated_in(self.subject.unit, folded(stated))

    def _follows(self, effect: Effect) -> bool:
        """Whether `effect` takes an elastic train of the scene into account."""
        return self.catalogue.followed(effect.name) and (
            self._finder is not None or effect.name not in FINDERS
        )

    def _is_elastic(self, effect: Effect) -> bool:
        """Whether the figures of `effect` are for an elastic train that has mass."""
        if not self._follows(effect):
            return False
        if effect.name in FINDERS:
            return self._computed(effect.name).feedback is not None
        return self._computed(CONTACT_FORCE).behind is not None

    def _at_speed(self, name: str, findings: Sequence[Finding]) -> Iterator[Finding]:
        """For which speed the figures of the effect `name` are, if that is the found one."""
        nodes = self._nodes(name)
        if not nodes.at_found or not self.catalogue.of_given_speed(name):
            return
        course = nodes.subject.course
        if course is not None and any(each.value is not None for each in findings):
            mean = TURN / period(course) / RPM
            sentence = (
                f"these figures are for the speed that {self._finder} finds, {mean:.6g}"
                " rev/min in the mean"
            )
            yield Finding("found-speed", "ok", sentence)

    def _flown(self) -> tuple[tuple[float, float], ...]:
        """The ranges [rad] over which the follower flies, if the scene names what computes them."""
        if LIFT_OFF not in self.tables:
            return ()
        try:
            found: Leaving = self._computed(LIFT_OFF)
        except (EffectError, GeometryError):  # which its own findings report
            return ()
        return found.flown

    @cached_property
    def _holding(self) -> str:
        """Which spring would hold a follower that leaves its only flank; empty without a spring."""
        if SPRING not in self.tables or holds_both_ways(self.subject):
            return ""
        try:
            least = None
            if LIFT_OFF in self.tables:
                closed: Any = self.result(LIFT_OFF)
                least = closed.preload, closed.stiffness
            subject, results = self._nodes(CONTACT_FORCE).subject, (CONTACT_FORCE, SPRING)
            text: str = pkgutil.resolve_name(HOLDING)(subject, *map(self.result, results), least)
            return text
        except (EffectError, GeometryError):  # which their own findings report
            return ""

    def _lost_contact(self, name: str) -> LostContact | None:
        """Where contact is lost; None if the effect `name` can do without contact, if neither it
        nor an effect of the scene needs the contact force, or if there is no contact force.
        """
        if self.effect(name).premise != "contact":
            return None
        asked = {name, *self.names}
        if CONTACT_FORCE not in asked.union(*map(self.catalogue.behind, asked)):
            return None
        try:
            found: LostContact = self._computed(CONTACT_FORCE).lost_contact
        except (EffectError, GeometryError):  # which its own findings report
            return None
        return found

    def recomputed(self, name: str, tolerance: float | None = None) -> Nodes:
        """Effects of the same design in which only `name` is computed again.

        A numerical effect is computed to `tolerance`; None keeps the tolerance of the scene. The
        results that it needs are reused, and are computed now if they have not been yet.
        """
        nodes, catalogue = self._nodes(name), self.catalogue
        if tolerance is not None:
            table = {**self.tables.get(name, {}), "tolerance": tolerance}
            catalogue = catalogue.with_table(name, table)
        self.inputs(name)
        return type(nodes)(nodes.subject, catalogue, Ledger(), nodes.inputs(name))
