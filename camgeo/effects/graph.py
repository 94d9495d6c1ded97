"""The effects of one design: each is computed when it is asked for, once, with what it needs."""

from __future__ import annotations

import pkgutil
from collections.abc import Callable, Mapping
from typing import Any, Final, overload

from camgeo.check.finding import Finding
from camgeo.effects.effect import Answer, Effect, Key, Request, Results, Subject, machine_of
from camgeo.effects.registry import find_effect
from camgeo.effects.rules import Table
from camgeo.errors import CycleError, EffectError, GeometryError
from camgeo.lazy import Ledger

TOLERANCE: Final = 1e-6
"""Of numerical effects, as a share of the largest magnitude, where the scene gives none."""

Find = Callable[[str], Effect]


def node_name(name: str) -> str:
    """What the ledger calls the effect `name`."""
    return f"effects.{name}"


def _place(name: str, key: str | None) -> str:
    """The key of a scene for a `key` of the table of the effect `name`, or for all of it."""
    return ".".join(filter(None, (node_name(name), key)))


class Effects:
    """The effects of `subject`, by name.

    Parameters
    ----------
    subject : the design.
    tables : what the scene says of each effect it names, in the units inside.
    ledger : where it is entered what was computed.
    find : gives the effect of a name.
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

    @property
    def names(self) -> tuple[str, ...]:
        """The effects that the scene names, in its order."""
        return tuple(self.tables)

    def effect(self, name: str) -> Effect:
        """The declaration of the effect `name`; KeyError if there is none."""
        if name not in self._known:
            self._known[name] = self._find(name)
        return self._known[name]

    def inputs(self, name: str) -> tuple[str, ...]:
        """The effects whose results `name` is given: what it needs, and what it uses of the scene.

        Raises
        ------
        CycleError
            If an effect needs itself, with the way from it to it.
        """
        self._walk(name, ())
        return self._inputs(name)

    def _inputs(self, name: str) -> tuple[str, ...]:
        effect = self.effect(name)
        used = tuple(each for each in effect.uses if each in self.tables)
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
        """The result of the effect `name`, which the scene need not name.

        Raises
        ------
        KeyError
            If there is no such effect.
        CycleError
            If it needs itself.
        GeometryError
            With the key of the scene, if data are missing.
        EffectError
            If it has no answer for this design.
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
            spec = effect.parse(table)
        except GeometryError as error:
            raise GeometryError(error.message, _place(name, error.key), error.value) from error
        compute = pkgutil.resolve_name(effect.compute)
        return compute(Request(self.subject, spec, results, tolerance))

    def _refuse_misfits(self, effect: Effect, table: Mapping[str, Any]) -> None:
        """Raise GeometryError with the key, if the effect or a key of its table has no place."""
        machine = machine_of(self.subject)
        for key, message in (told for rule in effect.rules for told in rule(machine, Table(table))):
            raise GeometryError(message, _place(effect.name, key))

    def findings(self, name: str) -> tuple[Finding, ...]:
        """What the effect `name` finds; one that has no answer says so, and is beyond a limit."""
        try:
            found: tuple[Finding, ...] = self.result(name).findings
        except GeometryError as error:
            if error.key:
                raise
            return (Finding(name, "broken", f"not computed: {error.message}"),)
        except EffectError as error:
            return (
                Finding(
                    name=error.finding or name,
                    severity="broken",
                    sentence=error.message,
                    value=error.value,
                    limit=error.limit,
                    unit=error.unit,
                    cam_angle=error.cam_angle,
                    cam_range=error.cam_range,
                ),
            )
        return found

    def retold(self, name: str, tolerance: float | None = None) -> Effects:
        """Effects of the same design in which only `name` is to be computed anew.

        To `tolerance`, if it is one that takes any; None leaves it the one it has.

        What it needs is taken over; it is computed now if it was not.
        """
        tables = dict(self.tables)
        if tolerance is not None:
            tables[name] = {**tables.get(name, {}), "tolerance": tolerance}
        again = Effects(self.subject, tables, Ledger(), self._find)
        again._results = {each: self.result(each) for each in self.inputs(name)}
        return again
