"""Programs of whole jobs: their words, one for each tool, where tools are changed, what is cut."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import pytest

import camgeo
from camgeo.app.answers.answer import text
from camgeo.app.answers.setup import setup_sheet
from camgeo.app.cli.main import main
from camgeo.design.design import Design
from camgeo.design.product import Product, disc_of
from camgeo.errors import GeometryError, SceneError
from camgeo.milling.machine import load, names
from camgeo.milling.milling import GcodeSpec
from camgeo.scene.scene import parse_scene
from camgeo_export.gcode.writer import WRITER
from camgeo_export.interpreter.run import run
from camgeo_export.verify.gcode import VERIFIER
from tests.export.stub_product import SECOND_TOOL, StubProduct
from tests.export.verified import TOLERANCE, faults, read_back
from tests.interpreter.results import weighted
from tests.kept import compare_documents
from tests.toolpath import programs
from tests.toolpath.test_features import ROUND_BLANK, STATED
from tests.toolpath.test_features import SCENE as FEATURED

FLOODED: Final = replace(SECOND_TOOL, name="two flutes", coolant="flood")

CUT: Final = re.compile(
    r"(?:N?\d+ )?(?:G[123]|L|C|CC)(?: ?(?:[XYZIJF][-+]?[\d.]+|DR[-+]|R0|G[123]))+"
)
"""A block of a cut and nothing else."""

JOBS: Final = (
    "stated, all kinds", "stated, conventional", "planned, a hub, holes and a mark",
    "stated, a spiral from a plate", "planned, from a plate with tabs", "engraved", "inches",
    "clamps that move",
)  # fmt: skip
"""Scenes of `tests.toolpath.programs`."""


def stubs() -> Iterator[tuple[str, Product]]:
    """Two tools, two walls, for each controller in both units."""
    for machine in names():
        for unit in ("mm", "inch"):
            spec = GcodeSpec(machine=machine)
            tool = FLOODED if load(machine).tool_change.change else None
            yield f"{machine}, {unit}", StubProduct(second_tool=tool, gcode=spec, unit=unit)
    spec = GcodeSpec(machine="haas", work_offset="G56", coolant="off", tool_change_height=50.0)
    yield "haas, other options", StubProduct(second_tool=FLOODED, gcode=spec)
    spec = replace(spec, machine="linuxcnc", clearance_height=30.0, retract_height=6.0)
    yield "linuxcnc, other options", StubProduct(second_tool=FLOODED, gcode=spec)


STUBS: Final = dict(stubs())


def summed(text: str) -> list[str | float]:
    """The lines; of each run of blocks that only cut, the number of blocks and a sum of theirs."""
    found: list[str | float] = []
    run: list[float] = []
    for line in [*text.splitlines(), ""]:
        if line and CUT.fullmatch(line):
            run.append(weighted(float(each) for each in re.findall(r"[-+]?\d+\.?\d*", line)))
            continue
        if run:
            found += [f"{len(run)} cuts", sum(run)]
            run = []
        found.append(line)
    return found


def said(disc: Product) -> Any:
    """All programs of a product: text, facts, deviation."""
    found = []
    for piece in WRITER.pieces(disc):
        written = WRITER.write(piece, TOLERANCE)
        text = written.data.decode("ascii")
        for given, word in ((piece.version, "VERSION"), (piece.scene_hash, "HASH")):
            text = re.sub(re.escape(given), word, text, flags=re.IGNORECASE)
        facts = {key: str(value) for key, value in written.facts.items()}
        found.append([summed(text), facts, WRITER.measure(piece, written.data)])
    return found


@pytest.mark.parametrize("name", [*STUBS, *JOBS])
def test_the_words_of_a_program_are_as_kept(name: str) -> None:
    """Its lines, the sums of its cuts, what is told of it, and how exact it is."""
    scene = programs.SCENES.get(name, programs.CLAMPS)
    disc = STUBS[name] if name in STUBS else Design(parse_scene(scene)).disc
    found = said(disc)
    compare_documents(f"export/programs/{name}", {name: found})
    assert all(0.0 <= deviation <= TOLERANCE for _, _, deviation in found)
    assert len(found) == len(list(WRITER.pieces(disc)))


# Parts with a hub, a timing mark and holes --------------------------------------------------------


@pytest.mark.parametrize("text", [FEATURED, FEATURED + ROUND_BLANK.replace("top = 1", "") + STATED])
def test_programs_are_measured_and_verified(text: str) -> None:
    read_back(WRITER, camgeo.loads(text).disc, least=0.0)


def test_a_mark_that_is_missing_in_a_program_is_found() -> None:
    product = camgeo.loads(FEATURED).disc
    data = WRITER.write(product, TOLERANCE).data.decode()
    start = data.index("(operation engrave mark)")
    end = data.index("(operation drill", start)
    cut = "\n".join(line for line in data[start:end].split("\n") if " Z-6.5" not in line)
    assert cut != data[start:end]
    damaged = (data[:start] + cut + data[end:]).encode()
    assert faults(VERIFIER, product, damaged)


# A controller that cannot change tools: one program for each run of a tool ------------------------


SCENES = Path(__file__).resolve().parents[2] / "fixtures" / "scenes"

SECOND_TABLE = """
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


def with_two_tools(machine: str = "grbl") -> str:
    whole = (SCENES / "setzhub.toml").read_text().replace("linuxcnc", machine)
    head, tail = whole.split("[holding]")
    return f"{head}{SECOND_TABLE}{OPERATIONS}[holding]{tail}"


@pytest.fixture(scope="module")
def design() -> Design:
    return camgeo.loads(with_two_tools())


@pytest.fixture(scope="module")
def folder(design: Design, tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("programs")
    (made / "scene.toml").write_text(with_two_tools())
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
    product = camgeo.loads(with_two_tools("linuxcnc")).disc
    assert WRITER.pieces(product) == (product,)


def test_the_whole_is_never_written_into_one_file(design: Design) -> None:
    with pytest.raises(SceneError, match="cannot change tools"):
        WRITER.write(design.disc, 0.01)


@pytest.mark.parametrize("end", ["", "-1-t1", "-12-t3"])
def test_names_of_programs_tell_the_disc(end: str) -> None:
    discs = camgeo.load(SCENES / "conjugate_lever.toml").discs
    assert disc_of(discs, f"conjugate_lever{end}") is discs[0]
    assert disc_of(discs, f"conjugate_lever-return{end}") is discs[1]


# Where tools are changed: at the machine's reference, or at a height that is stated ---------------


AWAY = 60.0

HEIGHTS = [name for name in names() if load(name).retract.is_a_height]


def written(machine: str, away: float | None) -> str:
    gcode = GcodeSpec(machine=machine, tool_change_height=away)
    # Grbl changes no tools: then one tool does all.
    second = SECOND_TOOL if load(machine).tool_change.change else None
    return WRITER.write(StubProduct(second_tool=second, gcode=gcode), TOLERANCE).data.decode()


def test_some_machines_retract_to_a_height_and_some_do_not() -> None:
    assert {"linuxcnc", "mach3", "grbl"} <= set(HEIGHTS) < set(names())


@pytest.mark.parametrize("machine", HEIGHTS)
@pytest.mark.parametrize("away", [None, AWAY])
def test_tools_are_changed_and_programs_end_there(machine: str, away: float | None) -> None:
    """Reached along Z alone, with the length of the old tool in force."""
    found = run(written(machine, away), load(machine))
    assert found.findings == ()
    changes = [each for each in found.events if each.kind == "tool change"][1:]
    assert bool(changes) == (machine != "grbl")
    assert all(each.z == (away or 5.0) for each in changes)
    assert found.moves[-1].z_end == (away or 5.0)
    up = [move for move in found.moves if move.z_end == AWAY]
    assert all(move.start == move.end and move.kind == "rapid" for move in up)


@pytest.mark.parametrize("machine", [name for name in names() if name not in HEIGHTS])
def test_others_go_to_their_reference_all_the_same(machine: str) -> None:
    assert written(machine, AWAY) == written(machine, None)


def test_it_is_not_below_the_clearance_height() -> None:
    with pytest.raises(GeometryError, match="tool_change_height") as caught:
        GcodeSpec(clearance_height=20.0, tool_change_height=10.0)
    assert caught.value.key == "output.gcode.tool_change_height"


@pytest.mark.parametrize(
    ("machine", "stated", "told"),
    [("linuxcnc", False, True), ("linuxcnc", True, False), ("haas", False, False),
     ("grbl", False, False)],
)  # fmt: skip
def test_a_change_close_above_the_part_is_told(machine: str, stated: bool, told: bool) -> None:
    own = with_two_tools(machine)
    if stated:
        own = own.replace(f'"{machine}"', f'"{machine}"\ntool_change_height = 60')
    milled = camgeo.loads(own).disc.milled
    found = milled.findings(milled.toolpath(0.01), 0.01)
    low = [each for each in found if each.name == "tool-change-height"]
    assert [each.severity for each in low] == (["warning"] if told else [])
