"""Lazy quantities: computed at most once, and recorded with the reason and the duration."""

from __future__ import annotations

import itertools
import math
import sys
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.app.answers.explain import lazy_names
from camgeo.errors import Cancelled, CycleError, EffectError, GeometryError, ToleranceError
from camgeo.lazy import Computation, Ledger, lazy
from tests.waiting import give_way


class Owner:
    """`whole` needs `left` and `right`, both need `base`; `entry` needs `one`, which needs `two`,
    that needs `one`. Each lets other threads come between, and takes seconds of a clock that stands
    still otherwise: all sums of them are exact.
    """

    def __init__(self, ledger: Ledger | None = None) -> None:
        self.ledger = Ledger() if ledger is None else ledger
        self.ledger.clock = lambda: self.now
        self.now = 0.0
        self.made: list[str] = []
        self.broken = False

    def spend(self, name: str, seconds: float) -> None:
        give_way()
        self.made.append(name)
        self.now += seconds

    @lazy
    def base(self) -> object:
        """What the others are based on."""
        self.spend("base", 8.0)
        if self.broken:
            raise ValueError("no base")
        return object()

    @lazy
    def left(self) -> tuple[object, ...]:
        self.spend("left", 1.0)
        return ("left", self.base)

    @lazy
    def right(self) -> tuple[object, ...]:
        self.spend("right", 2.0)
        return ("right", self.base)

    @lazy
    def whole(self) -> tuple[object, ...]:
        self.spend("whole", 4.0)
        found = (self.left, self.right)
        self.spend("whole", 0.5)
        return found

    @lazy
    def entry(self) -> object:
        return self.one

    @lazy
    def one(self) -> object:
        return self.two

    @lazy
    def two(self) -> object:
        give_way()
        found: object = self.one
        return found


def test_each_is_computed_once_when_it_is_asked_for_and_recorded() -> None:
    owner = Owner()
    assert (owner.made, owner.ledger.runs) == ([], [])
    assert set(vars(owner)) == {"ledger", "now", "made", "broken"}
    assert owner.whole is owner.whole
    assert owner.whole == (("left", owner.base), ("right", owner.base))
    assert owner.made == ["whole", "left", "base", "right", "whole"]
    assert owner.ledger.runs == [
        Computation("base", "left", 8.0, 8.0, failed=False),
        Computation("left", "whole", 9.0, 1.0, failed=False),
        Computation("right", "whole", 2.0, 2.0, failed=False),
        Computation("whole", "", 15.5, 4.5, failed=False),
    ]
    assert sum(run.net_seconds for run in owner.ledger.runs) == owner.now


def test_what_was_known_is_not_charged_again() -> None:
    owner = Owner()
    assert (owner.left, owner.right) == (("left", owner.base), ("right", owner.base))
    assert [(run.name, run.requester, run.seconds) for run in owner.ledger.runs] == [
        ("base", "left", 8.0),
        ("left", "", 9.0),
        ("right", "", 2.0),
    ]


def test_a_failure_of_a_run_is_entered_and_not_kept() -> None:
    owner = Owner()
    owner.broken = True
    with pytest.raises(ValueError, match="no base"):
        owner.whole  # noqa: B018 - it is computed
    assert [(run.name, run.requester, run.failed) for run in owner.ledger.runs] == [
        ("base", "left", True),
        ("left", "whole", True),
        ("whole", "", True),
    ]
    assert not {"base", "left", "whole"} & set(vars(owner))
    owner.broken = False
    owner.ledger.runs.clear()
    assert len(owner.whole) == 2
    assert [run.failed for run in owner.ledger.runs] == [False] * 4
    assert owner.ledger.runs[-1].requester == ""


class Unanswered:
    """A quantity that has no answer, and one that needs it."""

    def __init__(self, error: Exception) -> None:
        self.ledger = Ledger()
        self.error = error

    @lazy
    def sought(self) -> int:
        raise self.error

    @lazy
    def needing(self) -> int:
        return self.sought


@pytest.mark.parametrize(
    "error",
    [GeometryError("no disc", "key"), ToleranceError("too far", 0.1, 0.2), EffectError("no speed")],
)
def test_what_has_no_answer_is_computed_once(error: Exception) -> None:
    owner = Unanswered(error)
    for _ in range(3):
        with pytest.raises(type(error)) as caught:
            owner.needing  # noqa: B018 - it is computed
        assert caught.value is error
        with pytest.raises(type(error)):
            owner.sought  # noqa: B018 - it is computed
    assert [run.name for run in owner.ledger.runs] == ["sought", "needing"]


def test_a_ring_is_refused_with_its_way() -> None:
    ring = Owner()
    with pytest.raises(CycleError, match="depends on itself: one -> two -> one") as caught:
        ring.entry  # noqa: B018 - it is computed
    assert caught.value.way == ("one", "two", "one")
    assert isinstance(caught.value, RecursionError)
    # What the cycle did not reach is reported as failed, and the ledger is free again.
    assert [(run.name, run.failed) for run in ring.ledger.runs] == [
        ("two", True),
        ("one", True),
        ("entry", True),
    ]
    with ring.ledger.entry("other"):
        pass
    assert ring.ledger.runs[-1].requester == ""


def test_names_come_in_the_order_of_their_definition() -> None:
    class More(Owner):
        @lazy
        def added(self) -> int:
            return 0

        @lazy
        def left(self) -> tuple[object, ...]:
            return ()

        def plain(self) -> int:
            return 0

    names = ("base", "left", "right", "whole", "entry", "one", "two")
    assert lazy_names(Owner) == names
    assert lazy_names(More) == (*names, "added")
    assert isinstance(Owner.base, lazy)
    assert (Owner.base.__doc__, Owner.base.name) == ("What the others are based on.", "base")


THREADS = 8


def asked_at_once(ask: Callable[[int], object]) -> list[object]:
    """The answers to eight threads that ask at the same moment."""
    start = threading.Barrier(THREADS)

    def wait_and_ask(number: int) -> object:
        start.wait()
        return ask(number)

    with ThreadPoolExecutor(THREADS) as pool:
        return list(pool.map(wait_and_ask, range(THREADS)))


@pytest.mark.parametrize("_round", range(5))
def test_threads_that_ask_at_once_are_answered_from_one_computation(_round: int) -> None:
    owner = Owner()
    names = ("whole", "left", "right", "base")
    found = asked_at_once(lambda number: getattr(owner, names[number % 4]))
    assert sorted(owner.made) == ["base", "left", "right", "whole", "whole"]
    assert sorted(run.name for run in owner.ledger.runs) == ["base", "left", "right", "whole"]
    assert all(value is getattr(owner, names[k % 4]) for k, value in enumerate(found))


def test_a_ring_is_found_in_every_thread_and_only_there() -> None:
    owner = Owner()

    def ask(number: int) -> object:
        if number % 2:
            return owner.whole
        with pytest.raises(CycleError, match="depends on itself: one -> two -> one"):
            owner.entry  # noqa: B018 - it is computed
        return owner.whole

    assert len({id(value) for value in asked_at_once(ask)}) == 1


def test_ledgers_side_by_side_do_not_wait_for_each_other() -> None:
    """Each of two owners asks the other; with a lock each, two threads would wait for ever."""
    main = Owner()
    other = Owner(Ledger(shared_with=main.ledger))

    def ask(number: int) -> object:
        first, second = (main, other) if number % 2 else (other, main)

        with first.ledger.entry(f"pair {number}"):
            give_way()
            return second.base

    assert len({id(value) for value in asked_at_once(ask)}) == 2
    assert sorted(run.name for run in main.ledger.runs)[0] == "base"


def test_progress_gets_each_name_once_before_it_is_computed() -> None:
    stated: list[str] = []
    owner = Owner(Ledger(progress=stated.append))
    asked_at_once(lambda _: owner.whole)
    assert stated == ["whole", "left", "base", "right"]


def test_a_cancelled_computation_ends_at_the_next_step() -> None:
    stop = threading.Event()
    owner = Owner(Ledger(progress=lambda name: stop.set() if name == "base" else None,
                        cancelled=stop.is_set))  # fmt: skip
    with pytest.raises(Cancelled, match="before right was computed"):
        owner.whole  # noqa: B018 - it is computed
    assert [(run.name, run.failed) for run in owner.ledger.runs] == [
        ("base", False),
        ("left", False),
        ("whole", True),
    ]
    stop.clear()
    owner.whole  # noqa: B018 - it goes on from what there is
    assert owner.made == ["whole", "left", "base", "whole", "right", "whole"]


Tree = tuple[float, list["Tree"]]

trees: st.SearchStrategy[Tree] = st.recursive(
    st.tuples(st.integers(0, 1000).map(float), st.just([])),
    lambda inner: st.tuples(st.integers(0, 1000).map(float), st.lists(inner, max_size=3)),
    max_leaves=20,
)
"""Whole seconds of a quantity, and what it asks for."""


@given(tree=trees)
def test_own_seconds_add_up(tree: Tree) -> None:
    """Those of all quantities are the seconds of the one that was asked for."""
    ledger, spent, numbers = Ledger(), [0.0], itertools.count()
    ledger.clock = lambda: math.fsum(spent)

    def make(tree: Tree) -> None:
        spent.append(tree[0])
        for inner in tree[1]:
            with ledger.entry(f"quantity {next(numbers)}"):
                make(inner)

    with ledger.entry("root"):
        make(tree)
    root = ledger.runs[-1]
    assert root == replace(root, name="root", requester="", failed=False)
    assert root.seconds == math.fsum(spent)
    # Sums of whole numbers are exact.
    assert math.fsum(run.net_seconds for run in ledger.runs) == root.seconds
    assert all(0.0 <= run.net_seconds <= run.seconds for run in ledger.runs)


def frames() -> int:
    """Frames on the stack of the caller."""
    count, frame = 0, sys._getframe(1)
    while frame.f_back is not None:
        count, frame = count + 1, frame.f_back
    return count


def test_a_quantity_costs_one_frame() -> None:
    """Besides that of the function that computes it."""

    class Framed:
        ledger = Ledger()

        @lazy
        def inner(self) -> int:
            return frames()

        @lazy
        def outer(self) -> int:
            return frames() - self.inner

    assert Framed().outer == -2
