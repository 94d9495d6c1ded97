"""The known effects: camgeo's by their modules, others by entry points."""

from __future__ import annotations

import importlib.metadata
import inspect
import json
import pkgutil
import re
import subprocess
import sys
from collections.abc import Callable
from types import MappingProxyType, SimpleNamespace
from typing import Any

import pytest

from camgeo.dynamics.effects import results
from camgeo.dynamics.effects.effect import (
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
from camgeo.dynamics.effects.results import (
    FRICTION,
    INERTIA,
    SPRING,
    Friction,
)
from camgeo.errors import CamgeoError, GeometryError, SceneError, UnknownNameError
from camgeo.lazy import Ledger
from camgeo.scene.scene import parse_scene
from tests.effects.fakes import fake
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
