"""A scene without a disc, or without what a format needs, cannot be written in any way."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from camgeo.app.answers.check import check
from camgeo.app.answers.verify import Against, Wanted, files_in, verify_files
from camgeo.app.cli.main import main
from camgeo.design.design import Design
from camgeo.design.writing import make_files, write_files
from camgeo.errors import SceneError, UndercutError
from camgeo.milling import machine
from camgeo.scene.formats.format import FORMATS, find_format
from camgeo.scene.scene import load_scene, parse_scene
from tests.scene.scenes import GROOVE, PLATE, spoilt

UNDERCUT = spoilt(PLATE, ("roller_radius = 10", "roller_radius = 45"))
"""A roller too large for the concave part of the cam."""

Door = Callable[[Design, Path, tuple[str, ...]], object]

DOORS: dict[str, Door] = {
    "method": lambda design, folder, formats: design.write(folder, formats),
    "write": lambda design, folder, formats: write_files(design.discs, folder, formats, 0.001),
    "make": lambda design, folder, formats: make_files(design.discs, formats, 0.001),
}

BARE = """camgeo = 1
name = "bare"
[cam]
rotation = "ccw"
[follower]
kind = "translating-roller"
base_radius = 40
roller_radius = 10
[[motion]]
law = "inclined-sine"
span = 120
to = 10
[[motion]]
law = "inclined-sine"
span = 120
to = 0
[[motion]]
dwell = 120
"""
"""A scene without part and output."""

NEEDS = {
    "stl": "needs [part] thickness",
    "3mf": "needs [part] thickness",
    "step": "needs [part] thickness",
    "gcode": "needs [[tool]]: a tool, and how it is run",
    "asc": "needs [linkage]",
}


@pytest.mark.parametrize("door", DOORS.values(), ids=DOORS)
@pytest.mark.parametrize("formats", [("csv", "svg"), ("dxf",), ("csv",)])
def test_a_cam_without_outline_is_not_written(
    door: Door, formats: tuple[str, ...], tmp_path: Path
) -> None:
    design = Design(parse_scene(UNDERCUT))
    assert not design.judgement.has_outline
    with pytest.raises(UndercutError, match="undercut"):
        door(design, tmp_path / "out", formats)
    assert not any(tmp_path.iterdir())


def test_its_picture_and_its_table_stay(tmp_path: Path) -> None:
    scene = tmp_path / "scene.toml"
    scene.write_text(UNDERCUT)
    assert main(["build", str(scene), "-o", str(tmp_path / "out"), "--only", "csv,svg"]) == 1
    assert not (tmp_path / "out").exists()
    assert main(["plot", str(scene), "cam", "-o", str(tmp_path / "cam.svg")]) == 0
    assert main(["table", str(scene), "-o", str(tmp_path / "table.csv")]) == 0


@pytest.mark.parametrize("door", DOORS.values(), ids=DOORS)
@pytest.mark.parametrize("name", NEEDS)
def test_what_a_format_needs_is_needed_at_every_door(
    name: str, door: Door, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    design = Design(parse_scene(BARE))
    with pytest.raises(SceneError) as caught:
        door(design, tmp_path / "out", ("csv", name))
    assert NEEDS[name] in [fault.message for fault in caught.value.faults]
    assert {fault.value for fault in caught.value.faults} == {name}
    assert not any(tmp_path.iterdir())
    scene = tmp_path / "bare.toml"
    scene.write_text(BARE)
    assert main(["build", str(scene), "-o", str(tmp_path / "out"), "--only", name]) == 2
    assert f"format = {name}: {NEEDS[name]}" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("name", FORMATS)
def test_a_scene_is_refused_a_format_exactly_if_it_cannot_be_written_in_it(name: str) -> None:
    """Check and writing ask the same declaration; the scene is checked in any case."""
    design = Design(parse_scene(f'{BARE}[output]\nformats = ["{name}"]\n'))
    lacking = find_format(name).lacking(design.disc.values)
    told = check(design).formats
    if not lacking:
        assert make_files(design.discs, (name,), 0.01)
        assert not told
        return
    with pytest.raises(SceneError) as caught:
        make_files(design.discs, (name,), 0.01)
    assert [fault.message for fault in caught.value.faults] == lacking
    assert [each.sentence for each in told] == [str(fault) for fault in caught.value.faults]
    assert all(f'output.formats[1] = "{name}": {each}' in caught.value.args[0] for each in lacking)


@pytest.mark.parametrize("name", ["stl", "3mf", "step", "gcode"])
def test_a_groove_of_no_depth_is_no_body(name: str) -> None:
    text = spoilt(GROOVE, ("groove_depth = 10\n", ""))
    head, _, _ = text.partition("[output]")
    table = '[output]\nformats = ["dxf"]\n'
    with pytest.raises(SceneError, match=r"needs \[part\] groove_depth, for the cam is a groove"):
        Design(parse_scene(head + table)).write("out", [name])


def profile_with_ending(ending: str) -> str:
    """The profile of LinuxCNC with another ending of its programs."""
    text = Path(machine.__file__).with_name("machines").joinpath("linuxcnc.toml").read_text()
    assert text.count('".ngc"') == 1
    return text.replace(".ngc", ending)


def test_a_program_has_the_ending_of_its_machine_and_is_found_by_its_format(tmp_path: Path) -> None:
    """An ending that nothing verifies by itself is verified by what the certificate says."""
    (tmp_path / "mill.toml").write_text(profile_with_ending(".eia"))
    scene = tmp_path / "plate.toml"
    scene.write_text(PLATE.replace('"linuxcnc"', '"mill.toml"'))
    design = Design(load_scene(scene))
    design.write(tmp_path, ["gcode"])
    assert (tmp_path / "plate.eia") in files_in(tmp_path)
    against = Against(design.discs, 0.001)
    (verdict,) = verify_files((tmp_path / "plate.eia",), lambda *_: against, Wanted())
    assert "deviation" in {check.name for check in verdict.checks}
    assert all(check.ok is not False for check in verdict.checks)


def test_no_file_takes_the_name_of_another(tmp_path: Path) -> None:
    (tmp_path / "mill.toml").write_text(profile_with_ending(".dxf"))
    scene = tmp_path / "plate.toml"
    scene.write_text(PLATE.replace('"linuxcnc"', '"mill.toml"'))
    design = Design(load_scene(scene))
    with pytest.raises(
        SceneError, match=r"gcode: would be plate\.dxf, as another file of the same"
    ):
        make_files(design.discs, ("dxf", "gcode"), 0.01)


def test_a_program_is_verified_against_a_scene_with_milling(tmp_path: Path) -> None:
    Design(parse_scene(PLATE)).write(tmp_path, ["gcode"])
    program = tmp_path / "plate.ngc"
    other = Design(parse_scene(BARE))
    against = Against(other.discs, 0.001)
    (verdict,) = verify_files((program,), lambda *_: against, Wanted())
    (check,) = [each for each in verdict.checks if each.name == "operations"]
    assert check.ok is False
    assert "needs [[tool]]" in check.note
