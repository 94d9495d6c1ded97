"""Pickled data hold what they were made from: checks, read-only arrays and the version apply."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
import pytest

from camgeo import record
from camgeo.errors import (
    Cancelled,
    CycleError,
    EffectError,
    Fault,
    GeometryError,
    OutputError,
    SceneError,
    ToleranceError,
    UndercutError,
    UnknownNameError,
    UnsafeError,
    VersionError,
)
from camgeo.lazy import Ledger, lazy
from camgeo.numeric import checked
from camgeo.numeric.arrays import FloatArray
from camgeo.record import Pickled

TRAVELS: dict[str, Callable[[Any], Any]] = {
    "pickle": lambda value: pickle.loads(pickle.dumps(value)),
    "old pickle": lambda value: pickle.loads(pickle.dumps(value, protocol=0)),
    "copy": copy.copy,
    "deepcopy": copy.deepcopy,
}


@dataclass(frozen=True)
class Row(Pickled):
    """Heights with what was computed of them."""

    heights: FloatArray
    name: str = "row"
    ledger: Ledger = field(default_factory=Ledger, init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        checked.hold(self, heights=checked.array("heights", self.heights))

    @lazy
    def total(self) -> float:
        return float(np.sum(self.heights))

    @cached_property
    def largest(self) -> float:
        return float(np.max(self.heights))


@pytest.mark.parametrize("travel", TRAVELS.values(), ids=TRAVELS)
def test_data_travel_without_what_was_computed(travel: Callable[[Row], Row]) -> None:
    row = Row(np.array([1.0, 2.0]), "two")
    assert (row.total, row.largest) == (3.0, 2.0)
    found = travel(row)
    assert set(vars(found)) == {"heights", "name", "ledger"}
    assert found.name == "two"
    assert not found.heights.flags.writeable
    assert found.heights.tobytes() == row.heights.tobytes()
    assert found.ledger is not row.ledger
    assert found.ledger.runs == []
    assert found.total == 3.0


def test_another_version_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    data = pickle.dumps(Row(np.ones(2)))
    monkeypatch.setattr(record, "__version__", "99.1")
    with pytest.raises(VersionError, match=r"a Row pickled by camgeo .* camgeo 99\.1; create it"):
        pickle.loads(data)


@pytest.mark.parametrize(
    "error",
    [
        SceneError([Fault("follower.arm", "1", "is too short", line=3)], "a.toml"),
        GeometryError("must be above 0", "arm", "-1"),
        UndercutError("has undercut", "arm", "-1"),
        UnsafeError("a plunge", "output.gcode", ""),
        ToleranceError("chords cannot follow", 0.1, 0.2),
        OutputError("cannot be written"),
        CycleError(("a", "b", "a")),
        EffectError("jams", finding="jam", value=1.0, cam_range=(0.0, 1.0)),
        UnknownNameError("effect", "sprung", ("spring", "load")),
        Cancelled("cancelled before it was computed"),
        VersionError("of another version"),
    ],
    ids=lambda error: type(error).__name__,
)
@pytest.mark.parametrize("travel", TRAVELS.values(), ids=TRAVELS)
def test_errors_travel_as_they_are(
    travel: Callable[[Exception], Exception], error: Exception
) -> None:
    found = travel(error)
    assert type(found) is type(error)
    assert (str(found), found.args, vars(found)) == (str(error), error.args, vars(error))
