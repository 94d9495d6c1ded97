"""Programs of a controller that cannot change tools: one for each run of a tool, one set."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import camgeo
from camgeo.app.answers.answer import text
from camgeo.app.answers.setup import setup_sheet
from camgeo.app.cli.main import main
from camgeo.design.design import Design
from camgeo.design.product import disc_of
from camgeo.errors import SceneError
from camgeo_export.gcode.writer import WRITER

SCENES = Path(__file__).resolve().parents[2] / "fixtures" / "scenes"

SECOND = """
[[tool]]
number = 2
diameter = 12
spindle_speed = 2500
feed = 250
plunge_feed = 80
stepdown = 2
"""

OPERATIONS = "".join(
    f"""
[[operation]]
kind = "{kind}"
boundary = "{boundary}"
tool = {tool}
allowance = {allowance}
"""
    for kind, boundary, tool, allowance in (
        ("rough", "bore", 1, 0.3),
        ("finish", "bore", 1, 0.0),
        ("rough", "outline", 2, 0.4),
        ("finish", "outline", 1, 0.0),
    )
)

NAMES = ["setzhub-1-t1.nc", "setzhub-2-t2.nc", "setzhub-3-t1.nc"]


def scene(machine: str = "grbl") -> str:
    whole = (SCENES / "setzhub.toml").read_text().replace("linuxcnc", machine)
    head, tail = whole.split("[holding]")
    return f"{head}{SECOND}{OPERATIONS}[holding]{tail}"


@pytest.fixture(scope="module")
def design() -> Design:
    return camgeo.loads(scene())


@pytest.fixture(scope="module")
def folder(design: Design, tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("programs")
    (made / "scene.toml").write_text(scene())
    design.write(made, ["gcode"], tolerance=0.01)
    return made


def test_each_run_of_a_tool_has_its_program(design: Design, folder: Path) -> None:
    certificate = json.loads((folder / "certificate.json").read_text())
    assert [each["file"] for each in certificate["files"]] == NAMES
    wanted = [["rough bore", "bore"], ["rough outline"], ["outline"]]
    for name, operations, tool in zip(NAMES, wanted, (1, 2, 1), strict=True):
        lines = (folder / name).read_text().splitlines()
        named = [line[11:-1] for line in lines if line.startswith("(operation ")]
        assert named == operations
        spindle = next(line for line in lines if line.startswith("(tool "))
        assert spindle.startswith(f"(tool {tool}:")
        assert not any(line.startswith("T") or "M6" in line for line in lines)
    assert sum(each["operations"] for each in certificate["files"]) == len(design.disc.milled.cuts)


def test_all_of_them_verify_and_lint(folder: Path) -> None:
    words = ["--scene", str(folder / "scene.toml")]
    assert main(["verify", *(str(folder / name) for name in NAMES), *words]) == 0
    assert main(["lint", *(str(folder / name) for name in NAMES), "--machine", "grbl"]) == 0


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("program 2 of 3", "program 3 of 3"),
        ("program 2 of 3", "program 9 of 3"),
        ("G1 Z0.0000", "G1 Z-1.0000"),
    ],
)
def test_one_that_is_changed_fails(folder: Path, tmp_path: Path, old: str, new: str) -> None:
    program = (folder / NAMES[1]).read_text()
    assert old in program
    (tmp_path / NAMES[1]).write_text(program.replace(old, new, 1))
    words = ["--scene", str(folder / "scene.toml")]
    assert main(["verify", str(tmp_path / NAMES[1]), *words]) == 1


def test_the_setup_sheet_says_what_is_in_which_file(design: Design) -> None:
    told = text(setup_sheet(design, 0.01))
    assert "setzhub-2-t2.nc: rough outline, with tool 2 in the spindle" in told


def test_a_machine_that_changes_tools_has_one_program() -> None:
    product = camgeo.loads(scene("linuxcnc")).disc
    assert WRITER.pieces(product) == (product,)


def test_the_whole_is_never_written_into_one_file(design: Design) -> None:
    with pytest.raises(SceneError, match="cannot change tools"):
        WRITER.write(design.disc, 0.01)


@pytest.mark.parametrize("end", ["", "-1-t1", "-12-t3"])
def test_names_of_programs_tell_the_disc(end: str) -> None:
    discs = camgeo.load(SCENES / "conjugate_lever.toml").discs
    assert disc_of(discs, f"conjugate_lever{end}") is discs[0]
    assert disc_of(discs, f"conjugate_lever-return{end}") is discs[1]
