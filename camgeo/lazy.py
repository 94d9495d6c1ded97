"""Quantities that are computed on first use, and a ledger of what was computed."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, MutableMapping
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from typing import Any, Final, Generic, Protocol, Self, TypeVar, overload

from camgeo.errors import Cancelled, CycleError, EffectError, GeometryError, ToleranceError

NO_ANSWER: Final = (GeometryError, ToleranceError, EffectError)
"""Errors that depend on the data of a quantity alone, as its value does."""

Value = TypeVar("Value", covariant=True)


@dataclass(frozen=True, slots=True)
class Computation:
    """One quantity that was computed.

    Attributes
    ----------
    name : of the quantity.
    requester : the quantity for which it was computed; empty if requested from outside.
    seconds : it took, including all that it needed.
    net_seconds : of these, without what it needed.
    failed : whether it ended in an error.
    """

    name: str
    requester: str
    seconds: float
    net_seconds: float
    failed: bool


class Ledger:
    """A record of what was computed, in order of completion.

    Threads may access quantities concurrently: one of them computes, with all that it needs, and
    the others wait. No computation may wait for another thread that accesses the same owner.

    Parameters
    ----------
    progress : is called with the name of each quantity that starts.
    cancelled : is called when a quantity starts; True ends the computation.
    shared_with : ledger of an owner whose quantities use those of this one, and vice versa: one
        thread at a time computes for both.

    Attributes
    ----------
    runs : one for each computation that has ended.
    lock : held by the thread that computes.
    clock : seconds now; those that pass unless it is replaced.
    """

    def __init__(
        self,
        progress: Callable[[str], None] | None = None,
        cancelled: Callable[[], bool] | None = None,
        shared_with: Ledger | None = None,
    ) -> None:
        self.runs: list[Computation] = []
        self._progress = progress
        self._cancelled = cancelled
        self.lock: threading.RLock = threading.RLock() if shared_with is None else shared_with.lock
        self._open: list[str] = []
        self._inner: list[float] = []
        self._what = ""
        self.clock = time.perf_counter

    def named(self, what: str) -> Ledger:
        """The same record for another owner, whose quantities have `what` behind their names."""
        ledger = Ledger(self._progress, self._cancelled, shared_with=self)
        ledger.runs, ledger._open, ledger._inner = self.runs, self._open, self._inner
        ledger._what, ledger.clock = what, self.clock
        return ledger

    def __reduce__(self) -> tuple[type[Ledger], tuple[()]]:
        """A copy or pickle is an empty ledger, without results and hooks."""
        return Ledger, ()

    def entry(self, name: str, known: MutableMapping[str, Any] | None = None) -> Entry:
        """Within it the quantity `name` is computed, by this thread alone, and recorded.

        With `known`, a quantity without an answer is not computed twice: its error, one of
        `NO_ANSWER`, is kept there and raised again.

        Raises
        ------
        CycleError
            If `name` is already being computed: it depends on itself.
        Cancelled
            If `cancelled` returns True.
        """
        return Entry(self, name, known)

    def begin(self, name: str) -> str:
        """Notes that `name` is being computed, and returns its name in the record."""
        name = f"{name}{self._what}"
        if name in self._open:
            raise CycleError((*self._open[self._open.index(name) :], name))
        if self._cancelled is not None and self._cancelled():
            raise Cancelled(f"cancelled before {name} was computed")
        if self._progress is not None:
            self._progress(name)
        self._open.append(name)
        self._inner.append(0.0)
        return name

    def end(self, name: str, seconds: float, *, failed: bool) -> None:
        """Records what has been begun last."""
        self._open.pop()
        inner = self._inner.pop()
        if self._inner:
            self._inner[-1] += seconds
        requester = self._open[-1] if self._open else ""
        self.runs.append(Computation(name, requester, seconds, seconds - inner, failed))


class Entry:
    """What is computed within it is recorded in a ledger, whose lock it holds.

    It is no function that calls another, so that computing takes no frame of its own on the stack.

    Parameters
    ----------
    ledger : that records.
    name : of the quantity.
    known : where an error is kept, one of `NO_ANSWER`, and raised when it is asked for again.
    """

    __slots__ = ("failed", "known", "ledger", "name", "start")

    def __init__(
        self, ledger: Ledger, name: str, known: MutableMapping[str, Any] | None = None
    ) -> None:
        self.ledger, self.name, self.known = ledger, name, known
        self.failed = f"{name}: failed"  # no attribute has this name

    def __enter__(self) -> None:
        self.ledger.lock.acquire()
        try:
            if self.known is not None and self.failed in self.known:
                raise self.known[self.failed].with_traceback(None)
            self.name = self.ledger.begin(self.name)
            self.start = self.ledger.clock()
        except BaseException:
            self.ledger.lock.release()
            raise

    def __exit__(self, kind: object, error: BaseException | None, _: object) -> None:
        try:
            seconds = self.ledger.clock() - self.start
            self.ledger.end(self.name, seconds, failed=error is not None)
            if self.known is not None and isinstance(error, NO_ANSWER):
                self.known[self.failed] = error
        finally:
            self.ledger.lock.release()


class HasLedger(Protocol):
    """An object with lazy quantities."""

    @property
    def ledger(self) -> Ledger: ...


class lazy(Generic[Value]):
    """A property that is computed at most once, and recorded in the ledger of its owner.

    As with `functools.cached_property` the value is then stored in the owner's ``__dict__``, so
    that further access costs nothing. The ledger must exist as soon as the owner does: two threads
    that created one each would compute twice. Pickles and copies of an owner that is
    `camgeo.record.Pickled` contain neither.
    """

    def __init__(self, make: Callable[[Any], Value]) -> None:
        self.make = make
        self.__doc__ = make.__doc__
        self.name = make.__name__

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    @overload
    def __get__(self, instance: None, owner: type) -> Self: ...

    @overload
    def __get__(self, instance: HasLedger, owner: type) -> Value: ...

    def __get__(self, instance: HasLedger | None, owner: type) -> Self | Value:
        if instance is None:
            return self
        known = instance.__dict__
        with instance.ledger.lock:  # another thread may have set it meanwhile
            if self.name not in known:
                with self.entry(instance):
                    known[self.name] = self.make(instance)
            value: Value = known[self.name]
            return value

    def entry(self, instance: HasLedger) -> AbstractContextManager[None]:
        """Within which the value is computed."""
        return Entry(instance.ledger, self.name, instance.__dict__)


class built(lazy[Value]):
    """A property that is assembled at most once and computes nothing, so no ledger records it."""

    def entry(self, instance: HasLedger) -> AbstractContextManager[None]:
        """See `lazy.entry`."""
        return nullcontext()
