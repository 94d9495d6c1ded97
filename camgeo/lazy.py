"""Quantities that are computed when they are first asked for, and a ledger of what that took."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, MutableMapping
from dataclasses import dataclass
from typing import Any, Generic, Protocol, Self, TypeVar, overload

from camgeo.errors import Cancelled, CycleError

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

    Threads may ask at the same time: one of them computes, with all that it asks for, and the
    others wait for it. No computation may wait for another thread that asks the same owner.

    Parameters
    ----------
    progress : is called with the name of each quantity that starts.
    cancelled : is asked when a quantity starts whether all is to end.
    beside : the ledger of an owner whose quantities ask for those of this one, and the other way
        round: of both together one thread computes at a time.

    Attributes
    ----------
    runs : one for each computation that has ended.
    lock : is held by the thread that computes.
    """

    def __init__(
        self,
        progress: Callable[[str], None] | None = None,
        cancelled: Callable[[], bool] | None = None,
        beside: Ledger | None = None,
    ) -> None:
        self.runs: list[Run] = []
        self._progress = progress
        self._cancelled = cancelled
        self.lock: threading.RLock = threading.RLock() if beside is None else beside.lock
        self._open: list[str] = []
        self._inner: list[float] = []

    def __reduce__(self) -> tuple[type[Ledger], tuple[()]]:
        """A copy or pickle is an empty ledger: what was computed stays behind, and so do hooks."""
        return Ledger, ()

    def once(self, name: str, known: MutableMapping[str, Any], make: Callable[[], Any]) -> Any:
        """What stands in `known` under `name`; if nothing does, what `make` gives stands there now.

        Raises as `run`.
        """
        with self.lock:  # another thread may have made it meanwhile
            if name not in known:
                known[name] = self.run(name, make)
            return known[name]

    def run(self, name: str, make: Callable[[], Value]) -> Value:
        """What `make` gives, entered under `name`.

        Raises
        ------
        CycleError
            If `name` is being computed already: it needs itself.
        Cancelled
            If all is to end.
        """
        with self.lock:
            if name in self._open:
                raise CycleError((*self._open[self._open.index(name) :], name))
            if self._cancelled is not None and self._cancelled():
                raise Cancelled(f"told to stop before {name} was computed")
            if self._progress is not None:
                self._progress(name)
            return self._run(name, make)

    def _run(self, name: str, make: Callable[[], Value]) -> Value:
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
    that asking again costs nothing. The ledger must be there when the owner is: two threads that
    made one each would compute twice. Neither travels in a pickle or copy of an owner that is
    `camgeo.pickled.Pickled`.
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
        return self.find(instance)

    def find(self, instance: HasLedger) -> Out:
        """The value, made now if no thread has made it."""
        found: Out = instance.ledger.once(self.name, instance.__dict__, lambda: self.make(instance))
        return found


class built(lazy[Out]):
    """A property that is put together at most once and computes nothing, so no ledger has it."""

    def find(self, instance: HasLedger) -> Out:
        """See `lazy.find`."""
        with instance.ledger.lock:
            if self.name not in instance.__dict__:
                instance.__dict__[self.name] = self.make(instance)
            found: Out = instance.__dict__[self.name]
            return found


def lazy_names(owner: type) -> tuple[str, ...]:
    """Names of the lazy quantities of a class, in the order of their definition."""
    found = [
        name for each in reversed(owner.__mro__) for name, value in vars(each).items()
        if isinstance(value, lazy) and not isinstance(value, built)
    ]  # fmt: skip
    return tuple(dict.fromkeys(found))
