"""The known effects, camgeo's by their modules and others by entry points, and the graph of them:
each runs at most once, with its inputs; cycles are refused.
"""

from __future__ import annotations

import importlib.metadata
import inspect
import json
import pkgutil
import re
import subprocess
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType, SimpleNamespace
from typing import Any

import pytest

from camgeo.check.finding import Finding
from camgeo.dynamics.effects import results
from camgeo.dynamics.effects.effect import (
    TOLERANCE,
    Column,
    Effect,
    Key,
    Only,
    Request,
    Results,
)
from camgeo.dynamics.effects.graph import Effects
from camgeo.dynamics.effects.registry import (
    EFFECTS,
    FLATS,
    GROUP,
    ONE_DISC,
    effect_names,
    find_effect,
)
from camgeo.dynamics.effects.results import FRICTION, INERTIA, SPRING, Friction
from camgeo.errors import (
    CamgeoError,
    CycleError,
    EffectError,
    GeometryError,
    SceneError,
    UnknownNameError,
)
from camgeo.lazy import Ledger
from camgeo.scene.scene import parse_scene
from tests.effects.fakes import fake
from tests.effects.scenes import design
from tests.findings import effect_findings
from tests.scene.scenes import PLATE

NAME = "noise"

SCHEMA = MappingProxyType(
    {
        "type": "object",
        "required": ["mass"],
        "additionalProperties": False,
        "properties": {
            "mass": {"type": "number", "minimum": 0, "x-unit": "kg"},
            "gap": {"description": "Play of it.", "$ref": "#/$defs/length"},
            "bands": {"type": "array", "items": {"type": "number", "x-unit": "Hz"}},
            "odd": {"multipleOf": 2},
        },
    }
)


def parse(table: Any) -> dict[str, Any]:
    """Arithmetic that asks for numbers, as an effect that trusts its schema does."""
    if "gap" in table and table["gap"] > 1000.0:
        raise GeometryError("must not exceed 1000 mm", key="gap")
    return {"mass": 1.0 * table["mass"], **table}


FOREIGN = fake(NAME, title="noise of the follower", parse=parse, schema=SCHEMA)


class Entry:
    """An entry point that counts how often it is loaded."""

    def __init__(self, name: str, value: Any) -> None:
        self.name = name
        self.value = value
        self.loads = 0

    def load(self) -> Any:
        self.loads += 1
        return self.value


@pytest.fixture
def register(monkeypatch: pytest.MonkeyPatch) -> Callable[[str, Any], Entry]:
    """Registers an effect of another distribution, for this test."""
    entries: list[Entry] = []

    def entry_points(*, group: str) -> tuple[Entry, ...]:
        return tuple(entries) if group == GROUP else ()

    def register(name: str, value: Any) -> Entry:
        entries.append(Entry(name, value))
        return entries[-1]

    monkeypatch.setattr(importlib.metadata, "entry_points", entry_points)
    return register


Register = Callable[[str, Any], Entry]


@pytest.mark.parametrize("name", EFFECTS)
def test_each_is_an_effect_of_its_name(name: str) -> None:
    """Its rules are about keys that there are, and it does not need itself, whatever a scene names,
    all of them at worst.
    """
    effect = find_effect(name)
    assert isinstance(effect, Effect)
    assert effect.name == name
    assert effect.title
    assert not effect.title.endswith(".")
    assert {*effect.needs, *effect.uses} <= set(EFFECTS) - {name}
    keys = effect.schema["properties"].keys()
    assert ("tolerance" in keys) == effect.numerical
    assert all(set(rule.keys) <= keys for rule in effect.rules if isinstance(rule, Only))
    everything: dict[str, dict[str, Any]] = {each: {} for each in EFFECTS}
    subject: Any = SimpleNamespace(output="elastic")
    assert name not in Effects(subject, everything, Ledger()).inputs(name)


def test_finding_effects_imports_nothing_that_computes() -> None:
    code = (
        "import json, sys\nfrom camgeo.dynamics.effects.registry import find_effect\n"
        "for name in sys.argv[1:]:\n    find_effect(name)\nprint(json.dumps(sorted(sys.modules)))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, *EFFECTS], capture_output=True, text=True, check=True
    )
    prefix = "camgeo.dynamics.effects."
    found = {each.removeprefix(prefix) for each in json.loads(done.stdout) if prefix in each}
    assert found == {"effect", "registry", "results", "tables", "wording"}


def test_there_is_no_such_effect(register: Register) -> None:
    register(NAME, FOREIGN)
    with pytest.raises(UnknownNameError) as caught:
        find_effect("sprung")
    assert str(caught.value) == (
        f'there is no effect "sprung" (did you mean "spring"?); there are'
        f" {', '.join((*EFFECTS, NAME))}"
    )


def test_a_foreign_effect_is_loaded_when_it_is_asked_for(register: Register) -> None:
    entry = register(NAME, FOREIGN)
    assert effect_names() == (*EFFECTS, NAME)
    assert entry.loads == 0
    assert find_effect(NAME) is FOREIGN
    assert entry.loads == 1


def test_own_effects_cannot_be_taken_over(register: Register) -> None:
    entry = register(EFFECTS[0], FOREIGN)
    assert effect_names() == EFFECTS
    assert entry.loads == 0


@pytest.mark.parametrize("value", [None, "noise", Effect, fake("other")])
def test_what_is_no_effect_of_that_name_is_refused(register: Register, value: Any) -> None:
    register(NAME, value)
    with pytest.raises(TypeError, match="registered as effect 'noise' is not an effect"):
        find_effect(NAME)


# In a scene ---------------------------------------------------------------------------------------


def with_noise(text: str, scene: str = PLATE) -> str:
    return f"{scene}\n[effects.noise]\n{text}\n"


def test_its_table_is_converted_by_its_schema(register: Register) -> None:
    register(NAME, FOREIGN)
    text = with_noise("mass = 2\ngap = 0.5\nbands = [1, 2.5]")
    table = parse_scene(text).effects[NAME]
    hertz = 2.0 * 3.141592653589793
    assert table == {"mass": 2e-3, "gap": 0.5, "bands": (hertz, 2.5 * hertz)}
    inch = text.replace('length = "mm"', 'length = "inch"')
    assert parse_scene(inch).effects[NAME] == {**table, "gap": 0.5 * 25.4}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("gap = 0.5", r"line \d+: effects\.noise\.mass: is missing: it is needed"),
        ("mass = -1", r"line \d+: effects\.noise\.mass = -1: must be a number, at least 0 \(kg\)"),
        ('mass = "heavy"', r"effects\.noise\.mass = \"heavy\": must be a number"),
        (
            "mass = 1\nloud = 3",
            r"effects\.noise\.loud.*: is not a known key; known here: mass, gap",
        ),
        ("mass = 1\ngab = 3", r"effects\.noise\.gab.*: is not a known key \(did you mean gap\?"),
        ("mass = 1\ngap = 0", r"effects\.noise\.gap = 0: must be a positive number, 1e-9 to 1e9"),
        (
            'mass = 1\nbands = [1, "two"]',
            r"effects\.noise\.bands\[2\] = \"two\": must be a number \(Hz\)",
        ),
        ("mass = 1\nodd = 3", r"effects\.noise\.odd = 3: 3 is not a multiple of 2"),
        ("mass = 1\ngap = 2000", r"effects\.noise\.gap = 2000: must not exceed 1000 mm"),
    ],
)
def test_what_the_schema_or_the_effect_refuses_is_reported(
    register: Register, text: str, message: str
) -> None:
    register(NAME, FOREIGN)
    with pytest.raises(SceneError, match=message) as caught:
        parse_scene(with_noise(text))
    (fault,) = caught.value.faults
    assert fault.line is not None


def test_a_unit_that_does_not_exist_is_reported_with_the_units_that_do(register: Register) -> None:
    schema = {"type": "object", "properties": {"mass": {"type": "number", "x-unit": "stone"}}}
    register(NAME, fake(NAME, parse=parse, schema=schema))
    message = r'effects\.noise\.mass: the x-unit "stone" of its schema is unknown; known: kg, '
    with pytest.raises(CamgeoError, match=message):
        parse_scene(with_noise("mass = 1"))


def test_where_it_has_no_place_is_reported(register: Register) -> None:
    register(NAME, fake(NAME, schema=SCHEMA, rules=(Only(FLATS, "gap"), Only(ONE_DISC))))
    with pytest.raises(SceneError, match=r"effects\.noise\.gap = 1: is for flat-faced followers"):
        parse_scene(with_noise("mass = 1\ngap = 1"))
    assert NAME in parse_scene(with_noise("mass = 1")).effects


def test_request_is_what_it_gets(register: Register) -> None:
    seen: list[Request[Any]] = []
    register(NAME, fake(NAME, seen.append, parse=parse, schema=SCHEMA))
    from camgeo.design.design import Design

    design = Design(parse_scene(with_noise("mass = 3")))
    assert design.effect(NAME) is None
    (request,) = seen
    assert request.subject.cam.drive.plan.segments is design.cam.drive.plan.segments
    assert request.data == {"mass": 3e-3}
    assert request.results.get(INERTIA) is None


# Results of each other ----------------------------------------------------------------------------


KEYS = [each for each in vars(results).values() if isinstance(each, Key)]
PROMISED = {
    name: promised
    for promised, name in re.findall(r'Key\[(\w+)\]\("([\w-]+)"\)', inspect.getsource(results))
}
"""The classes that the keys state for the type checker, by the names of the effects."""


@pytest.mark.parametrize("key", KEYS)
def test_a_key_is_that_of_the_effect_whose_result_it_promises(key: str) -> None:
    compute = pkgutil.resolve_name(find_effect(key).compute)
    promised = getattr(results, PROMISED[key])
    for name in compute.__annotations__["return"].split(" | "):
        assert issubclass(compute.__globals__[name], promised)


def test_what_is_asked_for_has_a_key() -> None:
    effects = [find_effect(name) for name in EFFECTS]
    asked = [name for each in effects for name in (*each.needs, *each.uses)]
    assert {*asked} <= {*KEYS}
    assert all(isinstance(name, Key) for name in asked)


def test_results_are_found_by_their_keys() -> None:
    given: Any = object()
    results = Results({"friction": given})
    found: Friction = results[FRICTION]
    assert found is given
    assert results.get(FRICTION) is given
    assert results.get(SPRING) is None
    with pytest.raises(KeyError):
        results[SPRING]


# The graph ----------------------------------------------------------------------------------------


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
    assert [(run.name, run.requester) for run in effects.ledger.runs] == [
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
    assert (request.data, request.tolerance) == (("parsed", {"tolerance": 1e-3, "mass": 2.0}), 1e-3)
    assert request.subject is SUBJECT
    unnamed = fakes.of({"user": {}}).result("user").given["vague"].request
    assert (unnamed.data, unnamed.tolerance) == (("parsed", {}), TOLERANCE)


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
    assert (after.request.tolerance, after.request.data) == (1e-8, {"mass": 2.0, "tolerance": 1e-8})
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
    asked = {run.name: run.requester for run in plate.ledger.runs}
    assert asked["smooth_angles"] == "effects.angles"
    assert asked["motion"] == "smooth_angles"
    assert asked["effects.angles"] == ""
