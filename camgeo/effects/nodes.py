"""Results of effects for one state of motion: each is computed once, with what it needs."""

from __future__ import annotations

import pkgutil
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from typing import Any, Final

import numpy as np

from camgeo.effects.catalogue import Catalogue
from camgeo.effects.effect import Column, Effect, Request, Result, Results, Subject, machine_of
from camgeo.effects.inherited import InheritedErrors
from camgeo.effects.results import CONTACT_FORCE, FINDERS, VIBRATION, Elastic
from camgeo.effects.rules import Table
from camgeo.errors import EffectError, GeometryError
from camgeo.lazy import Ledger
from camgeo.numeric.arrays import FloatArray
from camgeo.state.state import Speed, Used

TOLERANCE: Final = 1e-6
"""Default for numerical effects, relative to the largest magnitude of the result."""


TRAIN_OFF: Final = " with the train off by its error"
"""What the ledger adds to the names of effects that are computed for errors alone."""


def node_name(name: str) -> str:
    """Name of the effect `name` in the ledger."""
    return f"effects.{name}"


def _place(name: str, key: str | None) -> str:
    """The full key in the scene for a `key` of the table of the effect `name`, or for the table."""
    return ".".join(filter(None, (node_name(name), key)))


class Nodes:
    """The effects of `subject` in one state.

    Parameters
    ----------
    subject : the design, which turns as in that state.
    catalogue : of its effects.
    ledger : records what was computed.
    known : results that are known already.
    base : has the results that do not depend on the speed, if these are for the found speed.
    rough : the same for the found speed known less accurately, from which errors follow.
    """

    def __init__(
        self,
        subject: Subject,
        catalogue: Catalogue,
        ledger: Ledger,
        known: Mapping[str, Any] | None = None,
        *,
        base: Nodes | None = None,
        rough: Nodes | None = None,
    ) -> None:
        self.subject = subject
        self.catalogue = catalogue
        self.ledger = ledger
        self._base = base
        self._rough = rough
        self._off: tuple[Nodes, ...] | None = None
        self._near: dict[str, Any] = {}
        self._results: dict[str, Any] = dict(known or {})
        self._failures: dict[str, EffectError] = {}

    @property
    def at_found(self) -> bool:
        """Whether they are for the speed that is found."""
        return self._base is not None

    def result(self, name: str) -> Any:
        """The result of the effect `name`; raises as `camgeo.effects.graph.Effects.result`."""
        with self.ledger.lock:  # another thread may be computing it
            if self._base is not None and not self.catalogue.moved(name):
                return self._base.result(name)
            if name in self._results:
                return self._results[name]
            if name in self._failures:
                raise self._failures[name]
            self.catalogue.inputs(name)
            try:
                found = self.ledger.run(node_name(name), lambda: self._compute(name))
            except EffectError as error:
                self._failures[name] = error
                raise
            self._results[name] = found
            return found

    def beside(self, name: str, near: Any) -> Any:
        """The result of the effect `name`, which is known to be `near` another; raises as
        `result`.
        """
        self._near[name] = near
        return self.result(name)

    def inputs(self, name: str) -> dict[str, Any]:
        """The results that the effect `name` receives; raises as `result`."""
        return {each: self.result(each) for each in self.catalogue.received(name)}

    def _compute(self, name: str) -> Any:
        effect, tables = self.catalogue.effect(name), self.catalogue.tables
        if effect.tabled and name not in tables:
            raise GeometryError(
                f"is missing: without it there is no {effect.title}", key=node_name(name)
            )
        if self.subject.disc is None and not effect.of_drive:
            raise GeometryError("needs [follower]", key="follower")
        results = Results(self.inputs(name))
        table = tables.get(name, {})
        tolerance = float(table.get("tolerance", TOLERANCE))
        if name in tables and effect.rules:
            self._refuse_misfits(effect, table)
        try:
            data = effect.parse(table)
        except GeometryError as error:
            raise GeometryError(error.message, _place(name, error.key), error.value) from error
        compute = pkgutil.resolve_name(effect.compute)
        near = self._near.get(name)
        return self._stated(name, compute(Request(self.subject, data, results, tolerance, near)))

    def _refuse_misfits(self, effect: Effect, table: Mapping[str, Any]) -> None:
        """Raise GeometryError with the key if the effect or one of its keys does not fit."""
        machine = machine_of(self.subject)
        for key, message in (
            fault for rule in effect.rules for fault in rule(machine, Table(table))
        ):
            raise GeometryError(message, _place(effect.name, key))

    def _stated(self, name: str, result: Any) -> Any:
        """The `result` of the effect `name` with its state, and with what the errors of a found
        speed and of an elastic train add to those of its figures.
        """
        if not isinstance(result, Result):
            return result
        state, rough = self.subject.state, self._rough
        found = self._base is not None or name in FINDERS
        speed: Speed = "found" if found else "stated"
        known = found or state.course is not None
        used = Used(state.model, speed if known else None, state.sense)
        result = replace(result, state=used)
        others: list[Callable[[], Result]] = []
        if self._follows(name):
            others += [partial(self._with_train, number, name, result) for number in range(2)]
        if rough is not None and state.course is not None:
            jumps = state.course.jumps
            columns = tuple(_also_jumping(each, jumps) for each in result.columns)
            result = replace(result, columns=columns)
            others.append(partial(rough.beside, name, result))
        return replace(result, errors=InheritedErrors(result, others)) if others else result

    def _follows(self, name: str) -> bool:
        """Whether the effect `name` was computed here from the force of an elastic train."""
        train = self._results.get(VIBRATION)
        if train is None or train.behind is None or name in FINDERS:
            return False  # they state the errors of the speeds that they find themselves
        return VIBRATION in self.catalogue.behind(name)

    def _with_train(self, number: int, name: str, near: Any) -> Any:
        """The result of the effect `name` with one of the trains that are off by the error of their
        force, see `camgeo.effects.elastic.ElasticTrain.off`; `near` is that with the train itself.
        """
        if self._off is None:
            train, contact = self.result(VIBRATION), self.result(CONTACT_FORCE)
            self._off = tuple(
                WithTrain(self, replace(train, behind=each))
                for each in train.behind.off(contact.demand)
            )
        return self._off[number].beside(name, near)


class WithTrain(Nodes):
    """The effects of `nodes` with another elastic `train`."""

    def __init__(self, nodes: Nodes, train: Elastic) -> None:
        ledger = nodes.ledger.named(TRAIN_OFF)
        super().__init__(nodes.subject, nodes.catalogue, ledger, {VIBRATION: train})
        self._nodes = nodes

    def result(self, name: str) -> Any:
        """As that of `nodes`, unless it depends on the train."""
        if name != VIBRATION and VIBRATION not in self.catalogue.behind(name):
            return self._nodes.result(name)
        return super().result(name)


def _also_jumping(column: Column, places: FloatArray) -> Column:
    """The column, which may jump at `places` (k,) [rad], too."""
    if not len(places):
        return column
    return replace(column, borders=np.unique(np.concatenate((column.borders, places))))
