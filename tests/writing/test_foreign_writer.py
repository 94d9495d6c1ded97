"""A writer of another distribution, installed with camgeo and used from the command line."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Final

import pytest

SCENE = Path(__file__).parents[2] / "fixtures" / "scenes" / "inch.toml"

WRITER = """
from dataclasses import dataclass

from camgeo.errors import GeometryError
from camgeo.design.writing import Written
from camgeo.scene.formats.format import Format


@dataclass(frozen=True)
class SatSpec:
    chord: float = 2.0
    turn: float = 0.0
    schema: str = "ACIS 7"

    def __post_init__(self):
        if self.schema == "ACIS 4" and self.turn:
            raise GeometryError("has no place in ACIS 4", key="turn")


def within_the_part(values):
    chord, thickness = values.get("output", "sat", "chord"), values.get("part", "thickness")
    if chord is not None and thickness is not None and not chord < thickness:
        yield "chord", f"must be less than the thickness, {thickness:g}"


FORMAT = Format(
    "sat",
    ".sat",
    lambda table: SatSpec(**table),
    {
        "description": "The solid.",
        "type": "object",
        "additionalProperties": False,
        "properties": {
            "chord": {"description": "Longest chord.", "$ref": "#/$defs/length"},
            "turn": {"type": "number", "minimum": 0, "maximum": 90, "x-unit": "degrees"},
            "schema": {"enum": ["ACIS 4", "ACIS 7"]},
        },
    },
    needs=("part.thickness",),
    rules=(within_the_part,),
)


class SatWriter:
    format = FORMAT

    def write(self, product, tolerance):
        return Written(repr(product.options[FORMAT]).encode(), {"solids": 1})

    def measure(self, product, data):
        return 0.0


WRITER = SatWriter()
"""


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder on Python's path with the distribution."""
    folder = tmp_path_factory.mktemp("site")
    (folder / "toy_sat.py").write_text(WRITER)
    info = folder / "toy_sat-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: toy-sat\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text("[camgeo.writers]\nsat = toy_sat:WRITER\n")
    return folder


def environment(installed: Path) -> dict[str, str]:
    """Of a process that has the distribution on its path."""
    path = os.pathsep.join(filter(None, (str(installed), os.environ.get("PYTHONPATH"))))
    return dict(os.environ, PYTHONPATH=path)


def camgeo(
    installed: Path, folder: Path, text: str, *arguments: str
) -> subprocess.CompletedProcess[str]:
    """`camgeo build` of a scene in `folder`, into its folder "out"."""
    (folder / "scene.toml").write_text(text)
    words = [sys.executable, "-m", "camgeo", "build", "scene.toml", "-o", "out", *arguments]
    return subprocess.run(
        words, cwd=folder, env=environment(installed), capture_output=True, text=True
    )


def scene(table: str = "", formats: str = '"sat", "csv"') -> str:
    """The fixture scene, in inches, with other output."""
    head, _, _ = SCENE.read_text().partition("[output]")
    return f"{head}[output]\nformats = [{formats}]\n{table}"


def test_a_scene_names_it_and_its_options_reach_it(installed: Path, tmp_path: Path) -> None:
    table = '[output.sat]\nchord = 0.125\nturn = 45\nschema = "ACIS 7"\n'
    done = camgeo(installed, tmp_path, scene(table))
    assert (done.returncode, done.stderr) == (0, "")
    written = (tmp_path / "out" / "inch.sat").read_text()
    assert written == "SatSpec(chord=3.175, turn=0.7853981633974483, schema='ACIS 7')"
    certificate = json.loads((tmp_path / "out" / "certificate.json").read_text())
    (record, _) = certificate["files"]
    assert (record["file"], record["format"], record["solids"]) == ("inch.sat", "sat", 1)
    # A scene with other options is another one.
    camgeo(installed, tmp_path, scene(table.replace("45", "44")), "--force")
    other = json.loads((tmp_path / "out" / "certificate.json").read_text())
    assert certificate["scene"]["sha256"] != other["scene"]["sha256"]


def test_the_command_line_names_it_too(installed: Path, tmp_path: Path) -> None:
    done = camgeo(installed, tmp_path, scene(formats='"csv"'), "--only", "sat")
    assert (done.returncode, done.stderr) == (0, "")
    written = (tmp_path / "out" / "inch.sat").read_text()
    assert written == "SatSpec(chord=2.0, turn=0.0, schema='ACIS 7')"


WRONG: Final = (
    (scene("[output.sat]\nchord = 9\n"), "output.sat.chord = 9: must be less than the thick"),
    (scene("[output.sat]\nchord = 0\n"), "output.sat.chord = 0: must be a positive number"),
    (scene("[output.sat]\nturn = 91\n"), "must be a number from 0 to 90 (degrees)"),
    (scene("[output.sat]\ncord = 1\n"), "is not a known key (did you mean chord?)"),
    (scene('[output.sat]\nschema = "ACIS 5"\n'), 'must be one of "ACIS 4", "ACIS 7"'),
    (scene('[output.sat]\nschema = "ACIS 4"\nturn = 1\n'), "output.sat.turn = 1: has no pl"),
    (
        scene("[output.satt]\nchord = 1\n"),
        "output.satt: is not a known key (did you mean sat?)",
    ),
    (scene(formats='"satt"'), '(did you mean "sat"?)'),
    (scene(formats='"iges"'), '"svg", "png", "asc", "drawing", "sat"'),
    (scene().replace("thickness =", "# thickness ="), '= "sat": needs [part] thickness'),
)
"""Scenes, and what is said of them."""

BUILD_EACH: Final = """
import contextlib, io, json, sys
from camgeo.app.cli.main import main
answers = []
for path in sys.argv[1:]:
    with contextlib.redirect_stderr(io.StringIO()) as reported:
        answers.append((main(["build", path, "-o", path + "-out"]), reported.getvalue()))
print(json.dumps(answers))
"""
"""One interpreter for many scenes."""


def test_wrong_scenes_are_refused_as_for_formats_of_camgeo(installed: Path, tmp_path: Path) -> None:
    files = [str(tmp_path / f"{number}.toml") for number in range(len(WRONG))]
    for file, (text, _) in zip(files, WRONG, strict=True):
        Path(file).write_text(text)
    command = [sys.executable, "-c", BUILD_EACH, *files]
    done = subprocess.run(
        command, env=environment(installed), capture_output=True, text=True, check=True
    )
    for file, (code, reported), (_, message) in zip(
        files, json.loads(done.stdout), WRONG, strict=True
    ):
        assert code == 2
        assert message in reported
        assert "Traceback" not in reported
        assert not Path(f"{file}-out").exists()


def test_it_is_asked_for_what_the_scene_lacks(installed: Path, tmp_path: Path) -> None:
    text = scene(formats='"csv"').replace("thickness =", "# thickness =")
    done = camgeo(installed, tmp_path, text, "--only", "sat")
    assert done.returncode == 2
    assert "format = sat: needs [part] thickness" in done.stderr
    assert not (tmp_path / "out").exists()
