"""A writer of another distribution, installed with camgeo and used from the command line."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

SCENE = Path(__file__).parents[2] / "fixtures" / "scenes" / "inch.toml"

WRITER = """
from dataclasses import dataclass

from camgeo.errors import GeometryError
from camgeo.writing.writer import Written
from camgeo.formats.format import Format


@dataclass(frozen=True)
class StepSpec:
    chord: float = 2.0
    turn: float = 0.0
    schema: str = "AP214"

    def __post_init__(self):
        if self.schema == "AP203" and self.turn:
            raise GeometryError("has no place in AP203", key="turn")


def within_the_part(values):
    chord, thickness = values.get("output", "step", "chord"), values.get("part", "thickness")
    if chord is not None and thickness is not None and not chord < thickness:
        yield "chord", f"must be less than the thickness, {thickness:g}"


FORMAT = Format(
    "step",
    ".step",
    lambda table: StepSpec(**table),
    {
        "description": "The solid.",
        "type": "object",
        "additionalProperties": False,
        "properties": {
            "chord": {"description": "Longest chord.", "$ref": "#/$defs/length"},
            "turn": {"type": "number", "minimum": 0, "maximum": 90, "x-unit": "degrees"},
            "schema": {"enum": ["AP203", "AP214"]},
        },
    },
    needs=("part.thickness",),
    rules=(within_the_part,),
)


class StepWriter:
    format = FORMAT

    def write(self, product, tolerance):
        return Written(repr(product.options[FORMAT]).encode(), {"solids": 1})

    def measure(self, product, data):
        return 0.0


WRITER = StepWriter()
"""


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder on Python's path with the distribution."""
    folder = tmp_path_factory.mktemp("site")
    (folder / "toy_step.py").write_text(WRITER)
    info = folder / "toy_step-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: toy-step\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text("[camgeo.writers]\nstep = toy_step:WRITER\n")
    return folder


def camgeo(
    installed: Path, folder: Path, text: str, *arguments: str
) -> subprocess.CompletedProcess[str]:
    """`camgeo build` of a scene in `folder`, into its folder "out"."""
    (folder / "scene.toml").write_text(text)
    words = [sys.executable, "-m", "camgeo", "build", "scene.toml", "-o", "out", *arguments]
    path = os.pathsep.join(filter(None, (str(installed), os.environ.get("PYTHONPATH"))))
    environment = dict(os.environ, PYTHONPATH=path)
    return subprocess.run(words, cwd=folder, env=environment, capture_output=True, text=True)


def scene(table: str = "", formats: str = '"step", "csv"') -> str:
    """The fixture scene, in inches, with other output."""
    head, _, _ = SCENE.read_text().partition("[output]")
    return f"{head}[output]\nformats = [{formats}]\n{table}"


def test_a_scene_names_it_and_its_options_reach_it(installed: Path, tmp_path: Path) -> None:
    table = '[output.step]\nchord = 0.125\nturn = 45\nschema = "AP214"\n'
    done = camgeo(installed, tmp_path, scene(table))
    assert (done.returncode, done.stderr) == (0, "")
    written = (tmp_path / "out" / "inch.step").read_text()
    assert written == "StepSpec(chord=3.175, turn=0.7853981633974483, schema='AP214')"
    (record, _) = json.loads((tmp_path / "out" / "certificate.json").read_text())["files"]
    assert (record["file"], record["format"], record["solids"]) == ("inch.step", "step", 1)


def test_a_scene_with_other_options_is_another(installed: Path, tmp_path: Path) -> None:
    hashes = set()
    for number, chord in enumerate((1, 2, 2.0)):
        folder = tmp_path / str(number)
        folder.mkdir()
        camgeo(installed, folder, scene(f"[output.step]\nturn = {chord}\n"))
        certificate = json.loads((folder / "out" / "certificate.json").read_text())
        hashes.add(certificate["scene"]["sha256"])
    assert len(hashes) == 2


def test_the_command_line_names_it_too(installed: Path, tmp_path: Path) -> None:
    done = camgeo(installed, tmp_path, scene(formats='"csv"'), "--only", "step")
    assert (done.returncode, done.stderr) == (0, "")
    assert (tmp_path / "out" / "inch.step").read_text() == repr_of_defaults()


def repr_of_defaults() -> str:
    return "StepSpec(chord=2.0, turn=0.0, schema='AP214')"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (scene("[output.step]\nchord = 9\n"), "output.step.chord = 9: must be less than the thick"),
        (scene("[output.step]\nchord = 0\n"), "output.step.chord = 0: must be a positive number"),
        (scene("[output.step]\nturn = 91\n"), "must be a number from 0 to 90 (degrees)"),
        (scene("[output.step]\ncord = 1\n"), "is not a known key (did you mean chord?)"),
        (scene('[output.step]\nschema = "AP213"\n'), 'must be one of "AP203", "AP214"'),
        (scene('[output.step]\nschema = "AP203"\nturn = 1\n'), "output.step.turn = 1: has no pl"),
        (scene("[output.stp]\nchord = 1\n"), "output.stp: is not a known key (did you mean step?)"),
        (scene(formats='"stp"'), '(did you mean "step"?)'),
        (scene(formats='"iges"'), '"svg", "png", "asc", "step"'),
        (scene().replace("thickness =", "rim ="), '= "step": needs [part] thickness'),
    ],
)
def test_wrong_scenes_are_refused_as_for_formats_of_camgeo(
    text: str, message: str, installed: Path, tmp_path: Path
) -> None:
    done = camgeo(installed, tmp_path, text)
    assert done.returncode == 2
    assert message in done.stderr
    assert "Traceback" not in done.stderr
    assert not (tmp_path / "out").exists()


def test_it_is_asked_for_what_the_scene_lacks(installed: Path, tmp_path: Path) -> None:
    text = scene(formats='"csv"').replace("thickness =", "# thickness =")
    done = camgeo(installed, tmp_path, text, "--only", "step")
    assert done.returncode == 2
    assert "format = step: needs [part] thickness" in done.stderr
    assert not (tmp_path / "out").exists()
