"""Caches of results, each kept with the immutable object that it depends on.

`Answers` keep the values of a motion at the cam angles of the latest requests, `recalling` does so
for any quantity. `kept_with_owner` keeps the last result of a function with its first argument,
`kept_with_each` computes a function for many objects at once and keeps each result with its object.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from functools import wraps
from threading import Lock
from typing import Any, Concatenate, Final, Generic, ParamSpec, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from camgeo.numeric.arrays import FloatArray, Number, read_only

P = ParamSpec("P")
Result = TypeVar("Result")

MOST_ANGLES: Final = 65_536
"""Total number of cam angles whose values `Answers` keep, those of the latest requests [3 MB]."""

MOST_VALUES: Final = 1 << 19
"""The same for quantities with one number per angle [8 MB], such as forces: computing those of a
stiff train takes this many angles."""

Kept = dict[Callable[..., Any], tuple[Any, Any]]
"""By function: the arguments of its last call, and the result."""


class HasKept(Protocol):
    """An immutable object with which results are kept."""

    @property
    def kept(self) -> Kept: ...


Owner = TypeVar("Owner", bound=HasKept)


class Answers(Generic[Result]):
    """A cache of the values at the latest cam angles, `most` in total or MOST_ANGLES, by request;
    safe for concurrent threads.
    """

    def __init__(self, most: int | None = None) -> None:
        self._most = most
        self._entries: dict[Hashable, tuple[Result, int]] = {}
        self._angles = 0
        self._lock = Lock()

    def recall(self, make: Callable[[], Result], way: Hashable, *angles: FloatArray) -> Result:
        """The result of `make`, which depends on `way` and `angles` (n,) [rad] alone: read-only,
        and while it is kept the same object for equal arguments.
        """
        count, most = len(angles[0]), MOST_ANGLES if self._most is None else self._most
        if count > most:
            # A request larger than the whole cache would evict everything and then itself.
            return make()
        question = way, *(phi.tobytes() for phi in angles)
        with self._lock:
            entry = self._entries.pop(question, None)
            if entry is not None:
                # Put back at the end: a dict keeps its order, and the least recently used entry
                # comes first.
                self._entries[question] = entry
                return entry[0]
        # Computed without the lock, so that threads do not wait for each other; at worst two of
        # them compute the same answer.
        answer = make()
        with self._lock:
            if question not in self._entries:
                self._entries[question] = answer, count
                self._angles += count
            while self._angles > most:
                self._angles -= self._entries.pop(next(iter(self._entries)))[1]
        return answer


def recalling(
    quantity: Callable[P, NDArray[Number]], most: int = MOST_VALUES
) -> Callable[P, NDArray[Number]]:
    """`quantity` with a cache of its values, read-only, at the latest cam angles, `most` in total.

    Those of its arguments that are arrays are cam angles.
    """
    answers: Answers[NDArray[Number]] = Answers(most)

    def values(*question: P.args, **_: P.kwargs) -> NDArray[Number]:
        angles = [argument for argument in question if isinstance(argument, np.ndarray)]
        way = tuple(argument for argument in question if not isinstance(argument, np.ndarray))
        return answers.recall(lambda: read_only(quantity(*question, **_)), way, *angles)

    return values


def kept_with_owner(
    make: Callable[Concatenate[Owner, P], Result],
) -> Callable[Concatenate[Owner, P], Result]:
    """Keep the result of `make` with its first argument until `make` is called with other ones.

    What depends on the motion plan alone is kept with the plan: editing the follower does not
    change it.
    """

    @wraps(make)
    def once(owner: Owner, /, *rest: P.args, **named: P.kwargs) -> Result:
        question = rest, named
        entry = owner.kept.get(make)  # read once: another thread may replace it
        if entry is None or entry[0] != question:
            entry = owner.kept[make] = question, make(owner, *rest, **named)
        result: Result = entry[1]
        return result

    return once


class kept_with_each(Generic[Owner, Result]):
    """A function of one owner that can be computed for many owners at once; each result is kept
    with its owner.

    The result for an owner must not depend, not even in its last bit, on the other owners that are
    computed together with it.
    """

    def __init__(self, make: Callable[[Sequence[Owner]], Sequence[Result]]) -> None:
        self._make = make
        self.__doc__ = make.__doc__

    def __call__(self, owner: Owner) -> Result:
        """The result of one owner."""
        entry = owner.kept.get(self._make)
        if entry is None:
            self.settle((owner,))
            entry = owner.kept[self._make]
        result: Result = entry[1]
        return result

    def settle(self, owners: Sequence[Owner]) -> None:
        """Compute the results of those `owners` that have none, all at once."""
        missing = [owner for owner in owners if self._make not in owner.kept]
        for owner, result in zip(missing, self._make(missing) if missing else (), strict=True):
            owner.kept[self._make] = None, result
