"""Quantities that are computed on first use, and a ledger of these computations."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, MutableMapping
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from typing import Any, Final, Generic, Protocol, Self, TypeVar, overload

from camgeo.errors import Cancelled, CycleError, EffectError, GeometryError, ToleranceError

NO_ANSWER: Final = (GeometryError, ToleranceError, EffectError)
"""Errors that are determined by the data of a quantity, as its value is: they are kept like one."""

Value = TypeVar("Value", covariant=True)


@dataclass(frozen=True, slots=True)
class Computation:
    """One quantity that was computed.

    Attributes
    ----------
    name : of the quantity.
    requester : the quantity for which it was computed; empty if requested from outside.
    seconds : time taken, including the quantities that it needed.
    net_seconds : time taken, without the quantities that it needed.
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
    progress : called with the name of each quantity whose computation starts.
    cancelled : called when a computation starts; True ends it.
    shared_with : ledger of an owner whose quantities depend on those of this one, and vice versa:
        both have one lock, so that only one thread at a time computes for them.

    Attributes
    ----------
    runs : the computations that have ended.
    lock : held by the thread that computes.
    clock : returns the time [s]; it may be replaced, e.g. by one of CPU time.
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
        """A ledger with the same record for another owner; `what` is appended to its names."""
        ledger = Ledger(self._progress, self._cancelled, shared_with=self)
        ledger.runs, ledger._open, ledger._inner = self.runs, self._open, self._inner
        ledger._what, ledger.clock = what, self.clock
        return ledger

    def __reduce__(self) -> tuple[type[Ledger], tuple[()]]:
        """A copy or pickle is an empty ledger, without results and hooks."""
        return Ledger, ()

    def entry(self, name: str, known: MutableMapping[str, Any] | None = None) -> LedgerEntry:
        """A context in which the quantity `name` is computed by this thread alone, and recorded.

        With `known`, a quantity without a result is not computed twice: its error, one of
        `NO_ANSWER`, is kept there and raised again.

        Raises
        ------
        CycleError
            If `name` is already being computed: it depends on itself.
        Cancelled
            If `cancelled` returns True.
        """
        return LedgerEntry(self, name, known)

    def begin(self, name: str) -> str:
        """Record that the computation of `name` begins; return its name in the record."""
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
        """Record that the computation begun last has ended."""
        self._open.pop()
        inner = self._inner.pop()
        if self._inner:
            # The time of an inner computation does not count for the one that needed it.
            self._inner[-1] += seconds
        requester = self._open[-1] if self._open else ""
        self.runs.append(Computation(name, requester, seconds, seconds - inner, failed))


class LedgerEntry:
    """A context that records a computation in a ledger, and holds the lock of that meanwhile.

    It is a context, not a function that calls the computation, so that deep chains of quantities
    need no further frames on the stack.

    Parameters
    ----------
    ledger : records the computation.
    name : of the quantity.
    known : keeps its error, one of `NO_ANSWER`, which is raised again on the next request.
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
                # Without its traceback, which would grow each time and keep frames alive.
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

    As with `functools.cached_property` the value is then stored in the ``__dict__`` of the owner,
    so that further access costs nothing. The ledger must exist as soon as the owner does: two
    threads that each created one would compute twice. Pickles and copies of a
    `camgeo.record.Pickled` owner contain neither values nor ledger.
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
        """The context in which the value is computed."""
        return LedgerEntry(instance.ledger, self.name, instance.__dict__)


class built(lazy[Value]):
    """A property that is assembled at most once and computes nothing, so no ledger records it."""

    def entry(self, instance: HasLedger) -> AbstractContextManager[None]:
        """See `lazy.entry`."""
        return nullcontext()
