"""The effects of one design: each is computed once, on demand, together with what it needs."""

from __future__ import annotations

import pkgutil
from collections.abc import Callable, Mapping
from typing import Any, Final, overload

from camgeo.check.finding import Finding
from camgeo.check.judge import FINDINGS
from camgeo.displayed import clipped
from camgeo.effects.effect import Answer, Effect, Key, Request, Results, Subject, machine_of
from camgeo.effects.premises import qualified, trimming
from camgeo.effects.registry import find_effect
from camgeo.effects.results import CONTACT_FORCE, LIFT_OFF, LostContact, Touching
from camgeo.effects.rules import Table
from camgeo.errors import CycleError, EffectError, GeometryError
from camgeo.lazy import Ledger

TOLERANCE: Final = 1e-6
"""Default for numerical effects, relative to the largest magnitude of the result."""

Find = Callable[[str], Effect]


def node_name(name: str) -> str:
    """Name of the effect `name` in the ledger."""
    return f"effects.{name}"


def _place(name: str, key: str | None) -> str:
    """The full key in the scene for a `key` of the table of the effect `name`, or for the table."""
    return ".".join(filter(None, (node_name(name), key)))


class Effects:
    """The effects of `subject`, by name.

    Parameters
    ----------
    subject : the design.
    tables : the table of each effect that the scene names, in internal units.
    ledger : records what was computed.
    find : returns the effect with a given name.
    """

    def __init__(
        self,
        subject: Subject,
        tables: Mapping[str, Mapping[str, Any]],
        ledger: Ledger,
        find: Find = find_effect,
    ) -> None:
        self.subject = subject
        self.tables = tables
        self.ledger = ledger
        self._find = find
        self._known: dict[str, Effect] = {}
        self._results: dict[str, Any] = {}
        self._failures: dict[str, EffectError] = {}

    def __repr__(self) -> str:
        return clipped(f"Effects({', '.join(map(repr, self.names))})")

    @property
    def names(self) -> tuple[str, ...]:
        """The effects that the scene names, in its order."""
        return tuple(self.tables)

    def effect(self, name: str) -> Effect:
        """The declaration of the effect `name`; UnknownNameError if there is none."""
        if name not in self._known:
            self._known[name] = self._find(name)
        return self._known[name]

    def inputs(self, name: str) -> tuple[str, ...]:
        """The effects whose results `name` receives: those it needs, and used ones in the scene.

        Raises
        ------
        CycleError
            If an effect needs itself, with the path of the cycle.
        """
        self._walk(name, ())
        return self._inputs(name)

    def _inputs(self, name: str) -> tuple[str, ...]:
        effect = self.effect(name)
        used = [each for each in effect.uses if each in self.tables]
        better = {each.by for each in effect.refined_by if each.followed and each.by in used}
        if better and self.subject.output == "rigid":
            used = [each for each in used if each not in better]
        return (*effect.needs, *(each for each in used if each not in effect.needs))

    def _walk(self, name: str, way: tuple[str, ...]) -> None:
        if name in way:
            raise CycleError((*way[way.index(name) :], name))
        for each in self._inputs(name):
            self._walk(each, (*way, name))

    @overload
    def result(self, name: Key[Answer]) -> Answer: ...

    @overload
    def result(self, name: str) -> Any: ...

    def result(self, name: str) -> Any:
        """The result of the effect `name`, whether or not the scene names it.

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
            if name in self._results:
                return self._results[name]
            if name in self._failures:
                raise self._failures[name]
            self.inputs(name)
            try:
                found = self.ledger.run(node_name(name), lambda: self._compute(name))
            except EffectError as error:
                self._failures[name] = error
                raise
            self._results[name] = found
            return found

    def _compute(self, name: str) -> Any:
        effect = self.effect(name)
        if effect.tabled and name not in self.tables:
            raise GeometryError(
                f"is missing: without it there is no {effect.title}", key=node_name(name)
            )
        if self.subject.disc is None and not effect.of_drive:
            raise GeometryError("needs [follower]", key="follower")
        results = Results({each: self.result(each) for each in self._inputs(name)})
        table = self.tables.get(name, {})
        tolerance = float(table.get("tolerance", TOLERANCE))
        if name in self.tables and effect.rules:
            self._refuse_misfits(effect, table)
        try:
            data = effect.parse(table)
        except GeometryError as error:
            raise GeometryError(error.message, _place(name, error.key), error.value) from error
        compute = pkgutil.resolve_name(effect.compute)
        return compute(Request(self.subject, data, results, tolerance))

    def _refuse_misfits(self, effect: Effect, table: Mapping[str, Any]) -> None:
        """Raise GeometryError with the key if the effect or one of its keys does not fit."""
        machine = machine_of(self.subject)
        for key, message in (
            fault for rule in effect.rules for fault in rule(machine, Table(table))
        ):
            raise GeometryError(message, _place(effect.name, key))

    def findings(self, name: str) -> tuple[Finding, ...]:
        """The findings of the effect `name`; a "broken" one that says why if there is no answer.

        First come those that say what the others do not hold for, see `camgeo.effects.premises`.
        """
        try:
            result = self.result(name)
        except GeometryError as error:
            if error.key:
                raise
            return (Finding(name, "broken", f"not computed: {error.message}"),)
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
            return (*trimming(self.effect(name), self.subject), refusal)
        return self.ledger.run(FINDINGS + node_name(name), lambda: self._qualified(name, result))

    def _qualified(self, name: str, result: Any) -> tuple[Finding, ...]:
        """The findings of the result of `name`, after those that say what they do not hold for."""
        touching = isinstance(result, Touching)
        lost = result.lost_contact if touching else self._lost_contact(name)
        at_speed_of_scene = not touching or name == CONTACT_FORCE
        effect = self.effect(name)
        flies = lost or (lost is not None and effect.premise == "contact")
        flown = self._flown() if flies and at_speed_of_scene else ()
        return qualified(effect, result.findings, self.subject, lost, self.names, flown,
                         elastic=self._is_elastic(effect))  # fmt: skip

    def _is_elastic(self, effect: Effect) -> bool:
        """Whether the figures of `effect` are for an elastic train that has mass."""
        followed = any(each.followed and each.by in self.tables for each in effect.refined_by)
        if not followed or self.subject.output == "rigid":
            return False
        return self.result(CONTACT_FORCE).behind is not None

    def _flown(self) -> tuple[tuple[float, float], ...]:
        """The ranges [rad] over which the follower flies, if the scene names what computes them."""
        if LIFT_OFF not in self.tables:
            return ()
        try:
            return self.result(LIFT_OFF).flown
        except (EffectError, GeometryError):  # which its own findings report
            return ()

    def _lost_contact(self, name: str) -> LostContact | None:
        """Where contact is lost; None if the effect `name` can do without contact, if no effect of
        the scene needs the contact force, or if there is no contact force.
        """
        if self.effect(name).premise != "contact" or not self._called_for(CONTACT_FORCE):
            return None
        try:
            found: LostContact = self.result(CONTACT_FORCE).lost_contact
        except (EffectError, GeometryError):  # which its own findings report
            return None
        return found

    def _called_for(self, name: str) -> bool:
        """Whether the scene names the effect `name` or one that needs it."""

        def needed(each: str) -> bool:
            return each == name or any(needed(other) for other in self._inputs(each))

        return any(needed(each) for each in self.names)

    def recomputed(self, name: str, tolerance: float | None = None) -> Effects:
        """Effects of the same design in which only `name` is computed again.

        A numerical effect is computed to `tolerance`; None keeps the tolerance of the scene. The
        results that it needs are reused, and are computed now if they have not been yet.
        """
        tables = dict(self.tables)
        if tolerance is not None:
            tables[name] = {**tables.get(name, {}), "tolerance": tolerance}
        again = Effects(self.subject, tables, Ledger(), self._find)
        again._results = {each: self.result(each) for each in self.inputs(name)}
        return again
