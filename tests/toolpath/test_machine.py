"""Machine profiles: schema and classes agree, and each profile is consistent with itself."""

from __future__ import annotations

import copy
import re
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any, get_args, get_type_hints

import pytest
import tomlkit
from hypothesis import given
from hypothesis import strategies as st
from jsonschema_rs import meta

from camgeo.errors import Fault, SceneError
from camgeo.milling import machine as machines
from camgeo.milling.machine import (
    EARLIER,
    EVIDENCE,
    MEANINGS,
    Machine,
    load,
    names,
    parse,
    profile_faults,
    schema,
)

FOLDER = Path(machines.__file__).parent / "machines"

TABLES = {
    name: tomllib.loads((FOLDER / f"{name}.toml").read_text(encoding="utf-8")) for name in names()
}


def test_the_schema_is_one_and_describes_every_key() -> None:
    meta.validate(schema())

    def described(node: Mapping[str, Any]) -> Iterator[Mapping[str, Any]]:
        for each in node.get("properties", {}).values():
            yield each
            yield from described(each)
            yield from described(each.get("items", {}))

    assert all(each["description"].endswith(".") for each in described(schema()))


def test_schema_and_classes_have_the_same_keys() -> None:
    def same(kind: Any, node: Mapping[str, Any]) -> None:
        hints = get_type_hints(kind)
        assert {field.name for field in fields(kind)} == set(node["properties"])
        for field in fields(kind):
            inner = [each for each in (hints[field.name], *get_args(hints[field.name]))
                     if is_dataclass(each)]  # fmt: skip
            own = node["properties"][field.name]
            for each in inner:
                same(each, own.get("items", own))

    same(Machine, schema())
    evidence = schema()["properties"]["evidence"]["items"]["properties"]["kind"]
    assert evidence["enum"] == list(EVIDENCE)
    meaning = schema()["properties"]["words"]["properties"]["meaning"]
    assert meaning["additionalProperties"]["enum"] == list(MEANINGS)


def paths(table: Mapping[str, Any], path: tuple[str, ...] = ()) -> Iterator[tuple[str, ...]]:
    for key, value in table.items():
        yield (*path, key)
        if isinstance(value, dict):
            yield from paths(value, (*path, key))


PATHS = [path for path in paths(TABLES["haas"]) if path[0] != "evidence"]

ODD = st.one_of(
    st.none(), st.booleans(), st.integers(-5, 20_000), st.floats(allow_nan=False, width=32),
    st.text("aG{}5. ", max_size=3), st.just("{two}"), st.just([]), st.just(["M{x}"]), st.just([1]),
    st.just({}), st.just({"mm": 0, "inch": 4}),
)  # fmt: skip


def faults_in(text: str) -> tuple[Fault, ...]:
    try:
        parse(text, "x.toml")
    except SceneError as error:
        return error.faults
    return ()


@given(st.sampled_from(PATHS), ODD)
def test_a_profile_is_read_or_all_its_faults_have_keys(path: tuple[str, ...], odd: object) -> None:
    """Whatever one value is; None leaves the key out."""
    table = copy.deepcopy(TABLES["haas"])
    inner = table
    for key in path[:-1]:
        inner = inner[key]
    inner.pop(path[-1])
    if odd is not None:
        inner[path[-1]] = odd
    faults = faults_in(tomlkit.dumps(table))
    assert all(fault.key for fault in faults)
    named = [fault.key.partition("[")[0].rpartition(".")[0] for fault in faults]
    assert not faults or any(".".join(path).startswith(each) for each in named)


def test_a_first_retract_goes_to_a_place_of_the_machine() -> None:
    """The clearance height is elsewhere before a tool's length holds."""
    table = copy.deepcopy(TABLES["linuxcnc"])
    table["retract"]["first"] = True
    (fault,) = faults_in(tomlkit.dumps(table))
    assert fault.key.endswith("retract.first")


def test_the_nominal_radius_has_a_place_in_programs() -> None:
    """In the blocks that switch, or in a tool change that each operation repeats."""
    table = copy.deepcopy(TABLES["linuxcnc"])
    table["compensation"]["nominal"] = "OFFN=-{radius}"
    (fault,) = faults_in(tomlkit.dumps(table))
    assert fault.key.endswith("compensation.nominal")
    table["compensation"]["left"] += " {nominal}"
    assert not faults_in(tomlkit.dumps(table))
    table = copy.deepcopy(TABLES["heidenhain"])
    table["tool_change"]["repeat"] = False
    (fault,) = faults_in(tomlkit.dumps(table))
    assert fault.key.endswith("tool_change.repeat")


@pytest.mark.parametrize("name", names())
def test_the_profiles_are_their_files(name: str) -> None:
    assert profile_faults(TABLES[name]) == []
    assert parse(tomlkit.dumps(TABLES[name]), "x.toml") == load(name)


def test_keys_of_earlier_profiles_are_refused_with_the_new_ones() -> None:
    assert set(EARLIER).isdisjoint(schema()["properties"])
    for new in EARLIER.values():
        node = schema()
        for key in new.split("."):
            node = node["properties"][key]
    with pytest.raises(SceneError, match="preamble: is a key of earlier profiles; it is program"):
        parse('preamble = ["G17"]\n', "x.toml")


# Each profile -------------------------------------------------------------------------------------


def blocks_in(machine: Machine) -> Iterator[str]:
    tables = (
        machine.program, machine.tool_change, machine.retract, machine.spindle, machine.coolant,
        machine.dwell, machine.smoothing,
    )  # fmt: skip
    for table in tables:
        for field in fields(table) if table is not None else ():
            value = getattr(table, field.name)
            yield from value if isinstance(value, tuple) else ()
    yield from machine.work_offsets.values()
    yield from (machine.unit.mm, machine.unit.inch)
    if machine.compensation is not None:
        yield from (machine.compensation.left, machine.compensation.right, machine.compensation.off)


OF_BLOCKS = {
    "TOLERANCE", "TIME", "DATUM", "SETTING", "NUMBER", "DWELL", "FMAX", "INCH", "PGM",
}  # fmt: skip
"""Words within blocks of klartext."""


@pytest.mark.parametrize("name", names())
def test_a_controller_accepts_the_words_of_its_own_profile(name: str) -> None:
    machine = load(name)
    for block in blocks_in(machine):
        if machine.dialect == "klartext":
            codes = re.findall(r"\b(M)(\d+)\b", block.partition(";")[0])
        else:
            codes = re.findall(r"([GM])(\d+(?:\.\d+)?)", block)
        for letter, number in codes:
            known = machine.words.g if letter == "G" else machine.words.m
            assert float(number) in known, f"{letter}{number} of {block}"
        named = {*" ".join(machine.words.names).split(), *OF_BLOCKS}
        assert set(re.findall(r"[A-Z]{3,}\d*", block)) <= named, block


@pytest.mark.parametrize("name", names())
def test_each_profile_says_what_its_keys_rest_on(name: str) -> None:
    known = {".".join(path) for path in paths(TABLES[name])}
    properties = schema()["properties"]
    known |= {
        f"{key}.{inner}" for key in properties for inner in properties[key].get("properties", {})
    }
    known |= set(properties)
    about = [key for each in load(name).evidence for key in each.about]
    assert set(about) <= known
    for needed in ("arcs", "dwell", "retract", "tool_change", "words"):
        assert any(key.partition(".")[0] == needed for key in about), needed


def test_a_profile_without_smoothing_or_with_one_that_bounds_it() -> None:
    """Where smoothing cannot be switched off a deviation is stated at any tolerance."""
    for name in ("heidenhain", "sinumerik"):
        smoothing = load(name).smoothing
        assert smoothing is not None
        assert smoothing.smallest <= smoothing.share * 0.001
    assert load("grbl").smoothing is None
