"""What objects show of themselves, and what their pickles and copies hold."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable
from dataclasses import dataclass, field, fields, is_dataclass
from enum import Enum
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import camgeo
from camgeo import record
from camgeo.app.answers.check import check
from camgeo.app.answers.laws import laws_of_task
from camgeo.app.answers.table import table_of_scene
from camgeo.check.finding import Finding, Findings
from camgeo.design.design import Design
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
from camgeo.pictures.plots import of_design
from camgeo.record import LONGEST, WORDS, Brief, Pickled, brief

FIXTURES = Path(__file__).parents[1] / "fixtures"

OF_CAM = ("drive", "disc", "follower")
OF_DESIGN = (
    "scene", "drive", "cams", "cam", "judgement", "findings", "effects", "discs", "disc",
    "tabulated",
)  # fmt: skip


def told(name: str) -> dict[str, Any]:
    """Objects of a design by the path that leads to them."""
    design = camgeo.load(FIXTURES / name)
    assert design.findings  # computed before it is described
    found: dict[str, Any] = {"design": design, "check": check(design)}
    found |= {f"design.{each}": getattr(design, each) for each in OF_DESIGN}
    found |= {f"design.cam.{each}": getattr(design.cam, each) for each in OF_CAM}
    scene, disc = design.scene, design.cam.disc
    found |= {f"design.scene.{each}": value for each, value in vars(scene).items() if value}
    found |= {f"disc.{each}": value for each, value in vars(disc).items()}
    found |= {f"plan.{k}": each for k, each in enumerate(scene.plan.segments)}
    found |= {f"effect.{each}": design.effect(each) for each in scene.effects}
    found["table"] = table_of_scene(design, 30).table
    found["figure"] = of_design(design, ["motion"])[0]
    found["panel"] = found["figure"].rows[0].panels[0]
    return found


@pytest.mark.parametrize("name", ["scenes/setzhub.toml", "effects/conjugate_lever.toml"])
def test_every_part_of_a_design_describes_itself_in_a_few_lines(name: str) -> None:
    found = told(name)
    own = {path: each for path, each in found.items() if is_dataclass(each)}
    assert {"design", "design.judgement", "disc.pitch_curve", "table", "figure"} <= own.keys()
    long = {path: repr(each) for path, each in own.items() if len(repr(each)) > 2 * LONGEST}
    assert long == {}
    for each in own.values():
        assert type(each).__name__ in repr(each)
        assert "array(" not in repr(each).replace("ndarray(", "")

    for each in found.values():
        if isinstance(each, Brief):
            assert len(repr(each)) <= LONGEST
            assert "\n" not in repr(each)


def test_a_design_is_described_without_computing_anything() -> None:
    design = camgeo.load(FIXTURES / "scenes" / "setzhub.toml")
    assert repr(design) == "Design('setzhub', oscillating-roller)"
    assert repr(design.scene).startswith("Scene('setzhub', file='")
    assert repr(design.judgement).startswith("Judgement(")
    assert design.ledger.runs == []


def test_effects_are_named() -> None:
    design = camgeo.load(FIXTURES / "effects" / "press.toml")
    assert repr(design.effects) == f"Effects{design.effects.names}"
    assert design.ledger.runs == []


def test_findings_are_counted() -> None:
    ok, broken = Finding("a", "ok", "it is"), Finding("b", "broken", "it is not")
    figure, kept = Finding("a", "ok", "it is", 1.0), Finding("a", "ok", "it is", 1.0, 2.0)
    assert repr(kept) == "Finding('a', 'ok', 'it is')"
    assert repr(figure) == "Finding('a', 'figure', 'it is')"
    told = "<4 findings: 1 broken (b), 2 note, 1 figure>"
    assert repr(Findings([broken, ok, ok, figure])) == told
    assert repr(Findings([broken] * 5)) == "<5 findings: 5 broken (b, b, b and 2 more)>"
    assert repr(Findings()) == "<0 findings>"
    assert len(repr(Finding("a", "ok", "so " * LONGEST))) == LONGEST
    assert Findings([ok]) == (ok,)


@dataclass(frozen=True, slots=True)
class Data(Brief):
    values: FloatArray
    names: tuple[str, ...] = ("a",) * 1000
    name: str = "n" * 1000


@dataclass(frozen=True)
class Kept(Pickled):
    values: FloatArray

    def __repr__(self) -> str:
        return "as it says"


@dataclass(frozen=True)
class Inheriting(Kept):
    more: float = 0.1 + 0.2


def test_a_description_is_short_whatever_an_object_holds() -> None:
    one = Data(np.zeros((240, 2)))
    name = f"'{'n' * (WORDS - 1)}…'"
    assert repr(one) == f"Data(values=ndarray(240, 2), names=<1,000 items>, name={name})"
    assert Data.__slots__ == ("values", "names", "name")
    assert repr(Kept(np.zeros(3))) == repr(Inheriting(np.zeros(3))) == "as it says"


class Way(Enum):
    THERE = "there"


@pytest.mark.parametrize(("value", "text"), [
    (0.1 + 0.2, "0.3"),
    (1 / 3 + 2e9j, "0.333333+2e+09j"),
    (True, "True"),
    (None, "None"),
    ("\x1b[31m", r"'\x1b[31m'"),
    (b"abc", "<3 bytes>"),
    ((1,), "<1 item>"),
    (Way.THERE, "'there'"),
    (Finding("a", "ok", "b"), "Finding(…)"),
    (check, "function(…)"),
    (Path("a/b"), "'a/b'"),
])  # fmt: skip
def test_values_in_a_few_words(value: object, text: str) -> None:
    assert brief(value) == text


def test_answers_describe_themselves_in_a_line() -> None:
    found = laws_of_task("R-R", {})
    assert repr(found).startswith("Laws(rows=<")
    assert [each.name for each in fields(found)] == ["rows", "running", "tasks", "places"]
    assert Design.__repr__ is not Brief.__repr__


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
