"""The graph of effects: each runs at most once, with its inputs; cycles are refused."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import pytest

from camgeo.check.finding import Finding
from camgeo.dynamics.effects.effect import TOLERANCE, Column, Effect, Request
from camgeo.dynamics.effects.graph import Effects
from camgeo.errors import CycleError, EffectError, GeometryError
from camgeo.lazy import Ledger
from tests.effects.fakes import fake
from tests.effects.scenes import design
from tests.findings import effect_findings

SUBJECT: Any = SimpleNamespace(disc=object(), output="elastic", unit="mm")
"""None of the effects here asks anything of the design."""


@dataclass(frozen=True, slots=True)
class Answer:
    """A result that records what its effect was given."""

    name: str
    request: Request[Any]
    findings: tuple[Finding, ...] = ()
    columns: tuple[Column, ...] = ()
    error: float | None = None

    @property
    def given(self) -> dict[str, Any]:
        return dict(self.request.results._by_name)


class Fakes:
    """Effects made up for a test, and which of them were computed."""

    def __init__(self) -> None:
        self.effects: dict[str, Effect] = {}
        self.found: list[str] = []
        self.calls: list[str] = []

    def add(
        self, name: str, compute: Callable[[Request[Any]], Any] | None = None, **options: Any
    ) -> None:
        def counted(request: Request[Any]) -> Any:
            self.calls.append(name)
            if compute is not None:
                return compute(request)
            return Answer(name, request, (Finding(name, "ok", f"{name} was computed"),))

        self.effects[name] = fake(name, counted, title=f"title of {name}", **options)

    def find(self, name: str) -> Effect:
        self.found.append(name)
        return self.effects[name]

    def of(self, tables: Mapping[str, Mapping[str, Any]] | None = None) -> Effects:
        return Effects(SUBJECT, tables or {}, Ledger(), find=self.find)


@pytest.fixture
def fakes() -> Fakes:
    return Fakes()


def no_answer(request: Request[Any]) -> Any:
    raise EffectError(
        "it jams at 90 degrees",
        finding="jamming",
        value=3.0,
        limit=5.0,
        unit="deg",
        cam_range=(1.0, 2.0),
    )


def diamond(fakes: Fakes) -> None:
    fakes.add("base")
    fakes.add("left", needs=("base",))
    fakes.add("right", needs=("base",))
    fakes.add("top", needs=("left", "right"), uses=("base",))
    fakes.add("aside", needs=("base",))


def test_nothing_is_looked_up_before_it_is_asked_for(fakes: Fakes) -> None:
    diamond(fakes)
    effects = fakes.of({"top": {}, "aside": {}})
    assert effects.names == ("top", "aside")
    assert fakes.found == fakes.calls == []
    assert effects.ledger.runs == []


def test_each_is_computed_once_over_a_diamond(fakes: Fakes) -> None:
    diamond(fakes)
    effects = fakes.of({"top": {}})
    top = effects.result("top")
    assert effects.result("top") is top
    assert top.given["left"].given["base"] is top.given["right"].given["base"]
    assert effects.result("base") is top.given["left"].given["base"]
    assert sorted(fakes.calls) == ["base", "left", "right", "top"]
    assert sorted(fakes.found) == ["base", "left", "right", "top"]
    assert [(run.name, run.asked_by) for run in effects.ledger.runs] == [
        ("effects.base", "effects.left"),
        ("effects.left", "effects.top"),
        ("effects.right", "effects.top"),
        ("effects.top", ""),
    ]


def test_what_is_used_is_given_only_if_the_scene_names_it(fakes: Fakes) -> None:
    fakes.add("spring")
    fakes.add("friction")
    fakes.add("force", uses=("spring", "friction"))
    effects = fakes.of({"force": {}, "friction": {}})
    assert effects.inputs("force") == ("friction",)
    assert set(effects.result("force").given) == {"friction"}
    assert fakes.calls == ["friction", "force"]
    assert "spring" not in fakes.found


def test_an_effect_sees_only_its_own_inputs(fakes: Fakes) -> None:
    diamond(fakes)
    effects = fakes.of({"top": {}, "left": {}})
    assert set(effects.result("left").given) == {"base"}
    with pytest.raises(KeyError):
        effects.result("left").request.results["right"]


def test_the_table_reaches_parse_and_its_tolerance_the_effect(fakes: Fakes) -> None:
    fakes.add("vague", parse=lambda table: ("parsed", dict(table)), numerical=True)
    fakes.add("user", needs=("vague",))
    request = fakes.of({"vague": {"tolerance": 1e-3, "mass": 2.0}}).result("vague").request
    assert request.data == ("parsed", {"tolerance": 1e-3, "mass": 2.0})
    assert request.tolerance == 1e-3
    assert request.subject is SUBJECT
    unnamed = fakes.of({"user": {}}).result("user").given["vague"].request
    assert unnamed.data == ("parsed", {})
    assert unnamed.tolerance == TOLERANCE


@pytest.mark.parametrize("link", ["needs", "uses"])
def test_a_ring_is_refused_with_its_way(fakes: Fakes, link: str) -> None:
    fakes.add("entry", needs=("one",))
    fakes.add("one", needs=("two",))
    options: dict[str, Any] = {link: ("three",)}
    fakes.add("two", **options)
    fakes.add("three", needs=("one",))
    effects = fakes.of({"entry": {}, "three": {}})
    for ask in (effects.result, effects.inputs):
        with pytest.raises(CycleError, match="one -> two -> three -> one") as caught:
            ask("entry")
        assert caught.value.way == ("one", "two", "three", "one")
    assert fakes.calls == []
    assert effects.ledger.runs == []


def test_a_use_that_the_scene_does_not_name_closes_no_ring(fakes: Fakes) -> None:
    fakes.add("one", needs=("two",))
    fakes.add("two", uses=("one",))
    assert set(fakes.of().result("one").given) == {"two"}
    with pytest.raises(CycleError, match="one -> two -> one"):
        fakes.of({"one": {}}).result("one")


@pytest.mark.parametrize("asked", ["spring", "force"])
def test_a_missing_table_is_reported_with_its_key(fakes: Fakes, asked: str) -> None:
    fakes.add("spring", tabled=True)
    fakes.add("force", needs=("spring",))
    effects = fakes.of({"force": {}})
    with pytest.raises(GeometryError, match="without it there is no title of spring") as caught:
        effects.result(asked)
    assert caught.value.key == "effects.spring"
    assert fakes.calls == []
    # Missing data are no answer of the effect, so no finding hides them.
    with pytest.raises(GeometryError):
        effects.findings(asked)


def test_what_parse_refuses_is_reported_with_the_whole_key(fakes: Fakes) -> None:
    """An empty table, of an effect that another one needs, or a design that is no scene's."""

    def parse(table: Mapping[str, Any]) -> Any:
        raise GeometryError("is missing: nothing comes of nothing", key="preload", value="7")

    fakes.add("spring", parse=parse)
    fakes.add("force", needs=("spring",))
    with pytest.raises(GeometryError, match="nothing comes of nothing") as caught:
        fakes.of().result("force")
    assert (caught.value.key, caught.value.value) == ("effects.spring.preload", "7")


def test_without_a_speed_there_is_no_course(fakes: Fakes) -> None:
    """For an effect that the scene does not name, so that its keys were not checked."""
    fakes.add("power", lambda request: request.course)
    ring, plate = design("ring", ""), design("plate_translating", "")
    with pytest.raises(GeometryError, match="the speed of the cam is needed") as caught:
        Effects(ring.effects.subject, {}, Ledger(), find=fakes.find).result("power")
    assert caught.value.key == "cam.speed"
    assert (
        Effects(plate.effects.subject, {}, Ledger(), find=fakes.find).result("power")
        is plate.drive.time_course
    )


def test_no_answer_is_one_finding_of_all_that_need_it(fakes: Fakes) -> None:
    fakes.add("force", no_answer)
    fakes.add("torque", needs=("force",))
    fakes.add("speed", needs=("torque", "force"))
    effects = fakes.of({"speed": {}, "force": {}})
    expected = Finding(
        "jamming", "broken", "it jams at 90 degrees", 3.0, 5.0, "deg", cam_range=(1.0, 2.0)
    )
    for name in ("speed", "torque", "force"):
        assert effects.findings(name) == (expected,)
        assert effects.findings(name) == (expected,)
        with pytest.raises(EffectError, match="it jams"):
            effects.result(name)
    assert fakes.calls == ["force"]
    assert [(run.name, run.failed) for run in effects.ledger.runs] == [
        ("effects.force", True),
        ("effects.torque", True),
        ("effects.speed", True),
    ]


def test_a_finding_without_a_name_has_that_of_the_effect(fakes: Fakes) -> None:
    def compute(request: Request[Any]) -> Any:
        raise EffectError("no spectrum")

    fakes.add("spectrum", compute)
    assert fakes.of().findings("spectrum") == (Finding("spectrum", "broken", "no spectrum"),)


def test_other_errors_are_not_kept(fakes: Fakes) -> None:
    tries = []

    def compute(request: Request[Any]) -> Any:
        tries.append(request)
        if len(tries) == 1:
            raise ValueError("out of luck")
        return Answer("moody", request)

    fakes.add("moody", compute)
    effects = fakes.of()
    with pytest.raises(ValueError, match="out of luck"):
        effects.result("moody")
    assert effects.result("moody").name == "moody"


# Told anew ----------------------------------------------------------------------------------------


def test_only_what_is_renewed_is_computed_again(fakes: Fakes) -> None:
    diamond(fakes)
    effects = fakes.of({"top": {"mass": 2.0, "tolerance": 1e-3}, "base": {}})
    before = effects.result("top")
    fakes.calls.clear()
    entered = len(effects.ledger.runs)
    again = effects.recomputed("top", 1e-8)
    after = again.result("top")
    assert fakes.calls == ["top"]
    assert after is not before
    assert after.request.tolerance == 1e-8
    assert after.request.data == {"mass": 2.0, "tolerance": 1e-8}
    assert set(after.given) == {"left", "right", "base"}
    assert all(after.given[name] is before.given[name] for name in after.given)
    # The first graph knows nothing of it.
    assert effects.result("top") is before
    assert effects.tables["top"]["tolerance"] == 1e-3
    assert len(effects.ledger.runs) == entered
    assert [run.name for run in again.ledger.runs] == ["effects.top"]


def test_without_its_inputs_it_cannot_be_renewed(fakes: Fakes) -> None:
    fakes.add("force", no_answer)
    fakes.add("torque", needs=("force",), numerical=True)
    with pytest.raises(EffectError, match="it jams"):
        fakes.of({"torque": {}}).recomputed("torque", 1e-3)


# Of a design --------------------------------------------------------------------------------------


def test_a_design_has_one_graph_and_one_ledger(fakes: Fakes) -> None:
    plate = design("plate_translating", "")
    assert plate.effects.names == ()
    assert effect_findings(plate) == ()
    assert plate.disc.columns() == ()
    assert plate.effects is plate.effects
    assert plate.effects.subject.cam.follower is plate.cam.follower

    def compute(request: Request[Any]) -> Any:
        return Answer("angles", request, columns=()), request.subject.cam.drive.smooth_angles

    fakes.add("angles", compute)
    graph = Effects(plate.effects.subject, {"angles": {}}, plate.ledger, find=fakes.find)
    _, angles = graph.result("angles")
    assert angles is plate.drive.smooth_angles
    asked = {run.name: run.asked_by for run in plate.ledger.runs}
    assert asked["smooth_angles"] == "effects.angles"
    assert asked["motion"] == "smooth_angles"
    assert asked["effects.angles"] == ""
