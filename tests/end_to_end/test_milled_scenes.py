"""Scenes that state blank, holding and operations, from the command line and for every controller.

Those of fixtures/milling: `camgeo build` writes and reads back all their files, `verify` and `lint`
find nothing, the setup sheet simulates them without a flaw, and nothing is found for other machine
profiles; judges run the programs where they are installed.
"""

from __future__ import annotations

import io
import json
import shutil
from contextlib import redirect_stdout
from functools import cache
from pathlib import Path
from typing import Any, Final

import pytest

import camgeo
from camgeo.app.answers.setup import setup_sheet
from camgeo.app.cli.main import main
from camgeo.design.design import Design
from camgeo.design.product import product_sides
from camgeo.milling import machine as machines
from camgeo.scene.formats.gcode import FORMAT
from camgeo.scene.scene import parse_scene
from camgeo_export.gcode.writer import WRITER
from camgeo_export.interpreter.run import run
from camgeo_export.verify.gcode import program_bench
from tests.long_form import LONG

FOLDER: Final = Path(__file__).parents[2] / "fixtures" / "milling"

SCENES: Final = sorted(FOLDER.glob("*.toml"))

COARSE: Final = 0.05
"""Tolerance [mm] of programs for other controllers than the scene's."""


@pytest.fixture(scope="module", params=SCENES, ids=lambda path: path.stem)
def scene(request: pytest.FixtureRequest) -> Path:
    return Path(request.param)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The scenes with the profiles beside them, where scenes may name them."""
    found = tmp_path_factory.mktemp("shop")
    shutil.copytree(FOLDER, found, dirs_exist_ok=True)
    for name in machines.names():
        source = Path(machines.__file__).parent / "machines" / f"{name}.toml"
        shutil.copy(source, found / f"profile-{name}.toml")
    return found


def said(*words: str) -> Any:
    """What a command that succeeds reports, as JSON."""
    with redirect_stdout(io.StringIO()) as reported:
        assert main([*words, "--json"]) == 0
    return json.loads(reported.getvalue())


def test_all_its_files_are_right_and_the_sheet_has_no_flaw(scene: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    said("build", str(scene), "-o", str(out))
    design = camgeo.load(scene)
    wanted = {*design.scene.output.formats}
    sides = product_sides(design.disc)
    assert len(list(out.iterdir())) == len(wanted) + len(sides)
    said("verify", str(out), "--scene", str(scene))
    options = design.disc.options[FORMAT]
    machine = machines.load(options.machine)
    blank = design.scene.milling
    assert blank is not None
    program = str(out / f"{design.name}{machine.extension}")
    words = ["--stock-top", f"{blank.stock.top}", "--clearance", f"{options.heights.clearance}"]
    said("lint", program, "--machine", options.machine, *words)
    for path in out.glob(f"{design.name}-second-side{machine.extension}"):
        said("lint", str(path), "--machine", options.machine, "--scene", str(scene))
    sheet = setup_sheet(design)
    for own, side in zip(sheet.sheets, sides, strict=True):
        assert own.flaws == ()
        assert [step.operation.name for step in own.steps] == [cut.name for cut in side.milled.cuts]


@cache
def programs_for(folder: Path, scene: Path, machine: str) -> list[tuple[Any, bytes]]:
    """The disc and its program for a machine; several where that cannot change its tools.

    Where it has no compensation, the path is computed.
    """
    text = scene.read_text("utf-8")
    if machines.load(machine).compensation is None:
        text = text.replace('compensation = "wear"', 'compensation = "computed"')
    given = parse_scene(text, str(folder / scene.name))
    edited = given.with_values({"output.gcode.machine": f"profile-{machine}.toml"})
    (product,) = Design(edited).discs
    return [(each, WRITER.write(each, COARSE).data) for each in WRITER.pieces(product)]


PAIRS: Final = [
    (scene, machine)
    for k, scene in enumerate(SCENES)
    for machine in (machines.names() if LONG else machines.names()[k % 5 :: 5])
]
"""Scenes and controllers: each has a fifth of the others, in the long form all."""


@pytest.mark.parametrize(
    ("path", "machine"), PAIRS, ids=[f"{path.stem}-{machine}" for path, machine in PAIRS]
)
def test_nothing_is_found_on_any_controller(path: Path, machine: str, folder: Path) -> None:
    profile = machines.load(machine)
    for product, data in programs_for(folder, path, machine):
        assert run(data, profile, program_bench(product, profile)).findings == ()
        if LONG or not profile.tool_change.change:  # then of several programs, each by itself
            assert WRITER.measure(product, data) <= COARSE
