"""Formats: those of camgeo by their modules, others by entry points, and their options."""

from __future__ import annotations

import importlib.metadata
import subprocess
import sys
from collections.abc import Callable
from decimal import Decimal
from typing import Any
from unittest.mock import Mock

import pytest

import camgeo
from camgeo.design.writing import find_writer, with_companions
from camgeo.errors import CamgeoError, SceneError, UnknownNameError
from camgeo.milling.machine import names
from camgeo.milling.milling import GcodeSpec
from camgeo.scene.formats import format as registry
from camgeo.scene.formats.csv import LARGEST_STEP, SMALLEST_STEP, CsvSpec
from camgeo.scene.formats.dxf import ENTITIES, DxfSpec
from camgeo.scene.formats.format import (
    FORMATS,
    Format,
    Options,
    find_format,
    foreign_names,
    no_options,
)
from camgeo.scene.formats.threemf import FORMAT, PlateBody, ThreeMfSpec
from camgeo.scene.scene import parse_scene
from camgeo.scene.values import ValidValues, document
from tests.contour.cams import SCENES
from tests.part.parts import refused
from tests.scene.scenes import PLATE


@pytest.mark.parametrize("name", FORMATS)
def test_each_is_the_format_of_its_name_and_of_its_writer(name: str) -> None:
    form = find_format(name)
    writer = find_writer(name)
    assert form.name == name
    assert writer.format is form
    suffixes = [each.format.suffix for each in with_companions(writer)]
    assert len(set(suffixes)) == len(suffixes)
    # The options of a format without a table are its defaults.
    assert Options()[form] == form.parse({})


def test_declarations_import_nothing_that_computes() -> None:
    modules = {place.partition(":")[0] for place in FORMATS.values()}
    imports = "; ".join(f"import camgeo.scene.formats.{name}" for name in modules)
    code = (
        f"import camgeo.design.design, sys; had = set(sys.modules); {imports};"
        " print(*set(sys.modules) - had)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = {name for name in done.stdout.split() if name.startswith("camgeo")}
    declared = {name for name in loaded if name.startswith("camgeo.scene.formats")}
    assert declared >= {f"camgeo.scene.formats.{name}" for name in modules}
    milling = {f"camgeo.milling{name}" for name in ("", ".holding", ".milling", ".tool")}
    assert loaded - declared <= {
        "camgeo.numeric.checked", "camgeo.record", "camgeo.scene", *milling,
    }  # fmt: skip


def test_options_are_those_of_the_format_that_is_asked_for() -> None:
    other = Format("other", ".o", dict)
    options = Options({"other": {"size": 1.0}})
    assert (options[other], options[Format("another", ".a", dict)]) == ({"size": 1.0}, {})


def test_a_suffix_may_depend_on_the_options() -> None:
    form = Format("other", ".o", dict, choose_suffix=lambda spec: spec.get("ending", ".p"))
    assert form.ending(Options({})) == ".p"
    assert form.ending(Options({"other": {"ending": ".q"}})) == ".q"
    assert Format("other", ".o", dict).ending(Options({})) == ".o"
    gcode = find_format("gcode")
    for machine, suffix in (("linuxcnc", ".ngc"), ("heidenhain", ".h"), ("mach3", ".tap")):
        assert gcode.ending(Options({"gcode": GcodeSpec(machine=machine)})) == suffix


def test_what_a_scene_asks_of_a_program() -> None:
    asked = (
        'machine = "linuxcnc"\ncoolant = "mist"\nwork_offset = "G59.3"\n'
        "spin_up = 2.5\nprogram_number = 7"
    )
    scene = parse_scene(PLATE.replace('machine = "linuxcnc"', asked))
    spec = scene.output.options[find_format("gcode")]
    assert (spec.coolant, spec.work_offset, spec.spin_up, spec.program_number) == (
        "mist", "G59.3", 2.5, 7,
    )  # fmt: skip
    assert parse_scene(PLATE).output.options[find_format("gcode")].spin_up is None


def test_scenes_may_name_every_machine() -> None:
    node = find_format("gcode").schema["properties"]["machine"]
    assert node["x-values"] == list(names())
    assert node["pattern"].startswith(f"^({'|'.join(names())})$")
    assert all(
        f'"{name}"' in text for name in names() for text in (node["x-allowed"], node["description"])
    )


class Entry:
    """An entry point of a writer, which counts how often it is loaded."""

    value = "toy:WRITER"

    def __init__(self, name: str, writer: Any) -> None:
        self.name = name
        self._writer = writer
        self.loads = 0

    def load(self) -> Any:
        self.loads += 1
        return self._writer


class Writer:
    def __init__(self, form: Any) -> None:
        self.format = form


def register(monkeypatch: pytest.MonkeyPatch, *entries: Entry) -> None:
    def entry_points(*, group: str) -> tuple[Entry, ...]:
        return entries if group == registry.GROUP else ()

    monkeypatch.setattr(importlib.metadata, "entry_points", entry_points)


def test_others_are_loaded_when_they_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    form = Format("sat", ".sat", no_options)
    named, left = Entry("sat", Writer(form)), Entry("iges", Writer(None))
    register(monkeypatch, named, left, Entry("dxf", None))
    assert foreign_names() == ("iges", "sat")
    assert (named.loads, left.loads) == (0, 0)
    assert find_format("sat") is form
    assert (named.loads, left.loads) == (1, 0)
    with pytest.raises(UnknownNameError, match=r'no format "igs" \(did you mean "iges"\?\)'):
        find_format("igs")


@pytest.mark.parametrize("writer", [None, Writer(None), Writer(Format("iges", ".i", no_options))])
def test_what_is_no_writer_of_its_format(writer: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    register(monkeypatch, Entry("sat", writer))
    with pytest.raises(CamgeoError, match=r"toy:WRITER of camgeo.writers is not a writer of "):
        find_format("sat")


def test_a_writer_that_cannot_be_loaded_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Entry, "load", Mock(side_effect=ImportError("No module named 'toy'")))
    register(monkeypatch, Entry("sat", None))
    with pytest.raises(CamgeoError, match=r"toy:WRITER of camgeo.writers cannot be loaded: No mod"):
        find_format("sat")


@pytest.mark.parametrize("name", FORMATS)
def test_all_but_the_value_table_need_a_follower(name: str) -> None:
    without = ValidValues(document(b'name = "drive"'))
    assert ("needs [follower]" in find_format(name).lacking(without)) == (name != "csv")


def test_a_scene_of_camgeos_formats_looks_none_up(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(importlib.metadata, "entry_points", Mock(side_effect=AssertionError))
    assert "gcode" in parse_scene(PLATE).output.formats


@pytest.mark.parametrize(
    ("make", "value", "key"),
    [
        *(
            (CsvSpec, Decimal(text), "output.csv.step")
            for text in ("0", "-1", "91", "NaN", "sNaN", "Inf")
        ),
        *(
            (CsvSpec, value, "output.csv.step")
            for value in (91.0, 0, float("nan"), "1", None, True)
        ),
        *((DxfSpec, value, "output.dxf.entity") for value in ("", "arc", None, 3)),
    ],
)
def test_wrong_options_are_refused(make: Callable[[Any], Any], value: Any, key: str) -> None:
    with refused(key, "must be"):
        make(value)


def test_the_ends_of_the_ranges_are_in_them() -> None:
    assert [CsvSpec(Decimal(text)).step for text in ("0.001", "90")]
    assert CsvSpec(90).step == LARGEST_STEP  # type: ignore[arg-type]  # numbers of Python pass too
    node = find_format("csv").schema["properties"]["step"]
    assert (Decimal(repr(node["minimum"])), node["maximum"]) == (SMALLEST_STEP, LARGEST_STEP)
    assert [DxfSpec(entity).entity for entity in ENTITIES] == list(ENTITIES)
    assert find_format("dxf").schema["properties"]["entity"]["enum"] == list(ENTITIES)


ON_PLATE: dict[str, Any] = {"output.3mf.plate": ["cam", "roller", "test-ring"], "part.bore": 20}


def test_defaults_and_a_whole_table() -> None:
    assert FORMAT.parse({}) == ThreeMfSpec((), 5.0, None, None)
    found = FORMAT.parse({"plate": ("cam", "roller"), "gap": 2.0, "roller_bore": 6.0})
    assert found == ThreeMfSpec(("cam", "roller"), 2.0, None, 6.0)


@pytest.mark.parametrize(
    ("table", "key"),
    [
        ({"plate": ("cam", "cam")}, "plate"),
        ({"plate": ("gear",)}, "plate"),
        ({"gap": 0.0}, "gap"),
        ({"roller_width": -1.0}, "roller_width"),
    ],
)
def test_doors(table: dict[str, Any], key: str) -> None:
    with refused(f"output.3mf.{key}"):
        FORMAT.parse(table)


def test_a_scene_with_a_plate() -> None:
    scene = camgeo.load(SCENES / "plate_translating.toml").scene
    found = scene.with_values({**ON_PLATE, "output.3mf.gap": 3}).output.options[FORMAT]
    assert found == ThreeMfSpec(("cam", "roller", "test-ring"), 3.0)
    assert scene.output.options[FORMAT] == ThreeMfSpec()
    assert scene.with_values(ON_PLATE).made != scene.with_values({"part.bore": 20}).made


@pytest.mark.parametrize(
    ("name", "values", "key", "message"),
    [
        ("plate_translating", {"plate": ["gear"]}, "plate[1]", "must be one of"),
        ("plate_translating", {"plate": []}, "plate", "must be a list, each named once"),
        ("plate_translating", {"plate": ["return-cam"]}, "plate", "needs .follower.return. for"),
        (
            "conjugate_carriage",
            {"plate": ["return-cam"]},
            "plate",
            r"cannot hold .return-cam.: it is one piece with .cam.",
        ),
        ("tappet", {"plate": ["roller"]}, "plate", "has no roller"),
        ("knife_edge", {"plate": ["roller"]}, "plate", "is a knife edge"),
        ("plate_translating", {"gap": 2}, "gap", "needs plate"),
        (
            "plate_translating",
            {"plate": ["cam"], "roller_bore": 3},
            "roller_bore",
            "needs a roller",
        ),
        (
            "plate_translating",
            {"plate": ["roller"], "roller_bore": 20},
            "roller_bore",
            "must be less than the diameter of the roller, 20",
        ),
    ],
)
def test_refusals(name: str, values: dict[str, Any], key: str, message: str) -> None:
    scene = camgeo.load(SCENES / f"{name}.toml").scene
    if name == "conjugate_carriage":
        scene = scene.with_values({"part.pair": {"gap": 8, "spacer": 40}})
    with pytest.raises(SceneError, match=message) as caught:
        scene.with_values({f"output.3mf.{each}": value for each, value in values.items()})
    assert [fault.key for fault in caught.value.faults] == [f"output.3mf.{key}"]


def test_a_ring_needs_a_bore() -> None:
    scene = camgeo.load(SCENES / "plate_translating.toml").scene
    values = {"part.bore": None, "part.keyway": None, "output.3mf.plate": ["test-ring"]}
    with pytest.raises(SceneError, match=r"needs .part. bore for"):
        scene.with_values(values)


def test_all_bodies_are_described() -> None:
    items = FORMAT.schema["properties"]["plate"]
    assert items["items"]["enum"] == [each.value for each in PlateBody]
    assert all(f'"{each}"' in items["description"] for each in PlateBody)
