"""Which formats there are: those of camgeo by their modules, others by entry points."""

from __future__ import annotations

import importlib.metadata
import subprocess
import sys
from typing import Any

import pytest

from camgeo.design.writing import find_writer, with_companions
from camgeo.errors import CamgeoError, UnknownNameError
from camgeo.milling.machine import names
from camgeo.milling.milling import GcodeSpec
from camgeo.scene.formats import format as registry
from camgeo.scene.formats.format import (
    FORMATS,
    Format,
    Options,
    find_format,
    foreign_names,
    no_options,
)
from camgeo.scene.scene import parse_scene
from camgeo.scene.values import ValidValues, document
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
    assert options[other] == {"size": 1.0}
    assert options[Format("another", ".a", dict)] == {}


def test_a_suffix_may_depend_on_the_options() -> None:
    form = Format("other", ".o", dict, suffix_of=lambda spec: spec.get("ending", ".p"))
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
    class Broken(Entry):
        def load(self) -> Any:
            raise ImportError("No module named 'toy'")

    register(monkeypatch, Broken("sat", None))
    with pytest.raises(CamgeoError, match=r"toy:WRITER of camgeo.writers cannot be loaded: No mod"):
        find_format("sat")


@pytest.mark.parametrize("name", FORMATS)
def test_all_but_the_value_table_need_a_follower(name: str) -> None:
    without = ValidValues(document(b'name = "drive"'))
    assert ("needs [follower]" in find_format(name).lacking(without)) == (name != "csv")


def test_a_scene_of_camgeos_formats_looks_none_up(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(**_: str) -> Any:
        raise AssertionError("looked up")

    monkeypatch.setattr(importlib.metadata, "entry_points", refuse)
    assert "gcode" in parse_scene(PLATE).output.formats
