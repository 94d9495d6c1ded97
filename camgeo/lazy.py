"""Quantities that are computed when they are first asked for, and a ledger of what that took."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Generic, Protocol, Self, TypeVar, overload

from camgeo.errors import CycleError

Value = TypeVar("Value")
Out = TypeVar("Out", covariant=True)


@dataclass(frozen=True, slots=True)
class Run:
    """One quantity that was computed.

    Attributes
    ----------
    name : of the quantity.
    asked_by : the quantity for which it was computed; empty if it was asked for from outside.
    seconds : it took, with all that it asked for.
    own_seconds : of these, without what it asked for.
    failed : whether it ended in an error.
    """

    name: str
    asked_by: str
    seconds: float
    own_seconds: float
    failed: bool


class Ledger:
    """What was computed, in the order of the answers.

    Attributes
    ----------
    runs : one for each computation that has ended.
    """

    def __init__(self) -> None:
        self.runs: list[Run] = []
        self._open: list[str] = []
        self._inner: list[float] = []

    def run(self, name: str, make: Callable[[], Value]) -> Value:
        """What `make` gives, entered under `name`.

        Raises
        ------
        CycleError
            If `name` is being computed already: it needs itself.
        """
        if name in self._open:
            raise CycleError((*self._open[self._open.index(name) :], name))
        asked_by = self._open[-1] if self._open else ""
        self._open.append(name)
        self._inner.append(0.0)
        failed = True
        start = time.perf_counter()
        try:
            value = make()
            failed = False
        finally:
            seconds = time.perf_counter() - start
            self._open.pop()
            inner = self._inner.pop()
            if self._inner:
                self._inner[-1] += seconds
            self.runs.append(Run(name, asked_by, seconds, seconds - inner, failed))
        return value


class HasLedger(Protocol):
    """What has lazy quantities."""

    @property
    def ledger(self) -> Ledger: ...


class lazy(Generic[Out]):
    """A property that is computed at most once, and entered into the ledger of its owner.

    Like `functools.cached_property` the value stands in the owner's ``__dict__`` afterwards, so
    that asking again costs nothing.
    """

    def __init__(self, make: Callable[[Any], Out]) -> None:
        self.make = make
        self.__doc__ = make.__doc__
        self.name = make.__name__

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    @overload
    def __get__(self, instance: None, owner: type) -> Self: ...

    @overload
    def __get__(self, instance: HasLedger, owner: type) -> Out: ...

    def __get__(self, instance: HasLedger | None, owner: type) -> Self | Out:
        if instance is None:
            return self
        value = instance.ledger.run(self.name, lambda: self.make(instance))
        instance.__dict__[self.name] = value
        return value


def lazy_names(owner: type) -> tuple[str, ...]:
    """Names of the lazy quantities of a class, in the order of their definition."""
    found = [
        name for each in reversed(owner.__mro__) for name, value in vars(each).items()
        if isinstance(value, lazy)
    ]  # fmt: skip
    return tuple(dict.fromkeys(found))
