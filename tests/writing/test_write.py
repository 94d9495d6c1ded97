"""A design's set of files: certificate, the same bytes again, what cannot be written, and writers
of other distributions.
"""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Final
from unittest.mock import Mock

import pytest

import camgeo
from camgeo.app.answers.check import check
from camgeo.app.answers.verify import Reference, Wanted, verifiable_files, verify_files
from camgeo.app.cli.main import main
from camgeo.design import writing as write_module
from camgeo.design import writing as writer_module
from camgeo.design.design import Design
from camgeo.design.product import Product
from camgeo.design.writing import (
    Written,
    find_writer,
    find_writers,
    make_files,
    write_files,
    writer_names,
)
from camgeo.errors import SceneError, ToleranceError, UndercutError
from camgeo.milling import machine
from camgeo.scene.formats.format import (
    FORMATS,
    LARGEST_TOLERANCE,
    SMALLEST_TOLERANCE,
    Format,
    find_format,
    no_options,
    writer_entries,
)
from camgeo.scene.scene import load_scene, parse_scene
from tests.findings import known
from tests.scene.scenes import GROOVE, PLATE, spoilt

SCENES = Path(__file__).parents[2] / "fixtures" / "scenes"

WRITTEN_FORMATS = ("3mf", "csv", "dxf", "gcode", "png", "step", "stl", "svg")


class Claims:
    """A writer whose file, read back, is `deviation` off."""

    format = Format("odd", ".txt", no_options)

    def __init__(self, deviation: float) -> None:
        self.deviation = deviation

    def write(self, product: Product, tolerance: float) -> Written:
        return Written(b"text", {"words": 1})

    def measure(self, product: Product, data: bytes) -> float:
        return self.deviation


def test_writers_are_found() -> None:
    assert set(WRITTEN_FORMATS) <= set(writer_names())
    assert find_writer("dxf").format.suffix == ".dxf"
    with pytest.raises(SceneError, match=r'no writer for this format.*did you mean "gcode"'):
        find_writer("gcod")
    with pytest.raises(SceneError, match=r"pdf: there is no writer .*\(PDFs are drawn by: camgeo"):
        find_writer("pdf")


def test_report_and_certificate(tmp_path: Path) -> None:
    design = camgeo.load(SCENES / "vorschub.toml")
    report = design.write(tmp_path, ["csv", "dxf", "csv"], tolerance=0.01)
    assert [file.name for file in report.files] == ["vorschub.csv", "vorschub.dxf"]
    assert report.paths[-1] == tmp_path / "certificate.json"
    certificate = json.loads(report.paths[-1].read_bytes())
    assert (certificate["tolerance_mm"], certificate["scene"]["sha256"]) == (
        0.01,
        design.scene.made,
    )
    for record, file in zip(certificate["files"], report.files, strict=True):
        data = (tmp_path / file.name).read_bytes()
        assert record["sha256"] == hashlib.sha256(data).hexdigest()
        assert record["bytes"] == file.size == len(data)
        assert record["deviation_mm"] == file.deviation
        assert known(file.deviation) <= 0.01
    assert [finding["name"] for finding in certificate["findings"]]


def test_the_certificate_has_the_findings_on_parts(tmp_path: Path) -> None:
    """Those of `camgeo check`, with the disc; none of a scene that says nothing of its part."""
    scene = camgeo.load(SCENES / "conjugate_lever.toml").scene
    screw = {"diameter": 5, "height": 6}
    edits = {"part.hub": {"diameter": 40, "height": 12}, "part.set_screw": screw}
    for name, values in (("a", edits | {"limits.diameter": 100.0}), ("b", {"part": None})):
        design = camgeo.Design(scene.with_values({"output.formats": ["csv"], **values}))
        design.write(tmp_path / name, ["csv"])
        certificate = json.loads((tmp_path / name / "certificate.json").read_bytes())
        found = [each for each in certificate["findings"] if "part" in each]
        parts = check(design).parts if name == "a" else {}
        keys = ("part", "name", "severity", "value")
        assert [tuple(map(each.get, keys)) for each in found] == [
            (part, each.name, each.severity, each.value)
            for part, one in parts.items()
            for each in one.findings
        ]
        names = {each["name"] for each in found}
        told = {"disc-angle", "largest-diameter", "smallest-wall", "wall-ratio", "set-screw"}
        assert names == (told if parts else set())


@pytest.mark.parametrize(
    "tolerance",
    [0.0, -1.0, float("nan"), float("inf"), SMALLEST_TOLERANCE * (1.0 - 1e-12),
     LARGEST_TOLERANCE * (1.0 + 1e-12)],
)  # fmt: skip
def test_no_tolerance(tolerance: float, tmp_path: Path) -> None:
    design = camgeo.load(SCENES / "vorschub.toml")
    with pytest.raises(SceneError, match="must be a length of 1e-07 mm to 1 mm") as caught:
        design.write(tmp_path / "out", ["csv"], tolerance=tolerance)
    assert [(each.key, each.value) for each in caught.value.faults] == [
        ("tolerance", f"{tolerance:g}")
    ]
    assert not any(tmp_path.iterdir())


def test_what_is_installed_is_looked_through_once(monkeypatch: pytest.MonkeyPatch) -> None:
    counted = Mock(wraps=writer_entries)
    monkeypatch.setattr(writer_module, "writer_entries", counted)
    found = find_writers(WRITTEN_FORMATS)
    assert [*found] == [*WRITTEN_FORMATS]
    assert all(found[name] is find_writer(name) for name in WRITTEN_FORMATS)
    assert counted.call_count == 1 + len(WRITTEN_FORMATS)


@pytest.mark.parametrize("deviation", [0.0011, float("nan"), float("inf")])
def test_file_that_is_off_is_not_kept(
    deviation: float, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The certificate's own check, deliberately broken: a writer that misses its tolerance."""
    monkeypatch.setattr(write_module, "find_writers", lambda _: {"odd": Claims(deviation)})
    design = camgeo.load(SCENES / "vorschub.toml")
    with pytest.raises(ToleranceError, match="the odd file, read back, deviates"):
        write_files(design.discs, tmp_path / "out", ("odd",), 0.001)
    assert not any(tmp_path.iterdir())


def test_the_same_bytes_in_another_process(tmp_path: Path) -> None:
    """Time, hash seed, folders, home, umask, locale, threads and the caller leave no trace."""
    scene = str(SCENES / "inch.toml")
    code = (
        f"import camgeo, sys;camgeo.load({scene!r})"
        f".write(sys.argv[1], {WRITTEN_FORMATS!r}, tolerance=0.01)"
    )
    library = ["-c", code, str(tmp_path / "1")]
    program = ["-m", "camgeo", "build", scene, "-o", str(tmp_path / "4")]
    program += ["--only", ",".join(WRITTEN_FORMATS), "--tolerance", "0.01"]
    runs = []
    for seed, command in (("1", library), ("4", program)):
        # With these seeds a set of ezdxf's class names comes in two orders.
        environment = dict(os.environ, PYTHONHASHSEED=seed, TZ=f"UTC+{seed}")
        home = tmp_path / f"home {seed}"
        if seed == "4":
            home.mkdir()
            threads = {"OPENBLAS_NUM_THREADS": "2", "OMP_NUM_THREADS": "2"}
            environment |= {"HOME": str(home), "LC_ALL": "C", **threads}
        subprocess.run(
            [sys.executable, *command], check=True, env=environment, stdout=subprocess.PIPE,
            cwd=home if seed == "4" else None, umask=0o077 if seed == "4" else -1,
        )  # fmt: skip
        runs.append({path.name: path.read_bytes() for path in sorted((tmp_path / seed).iterdir())})
    assert len(runs[0]) == len(WRITTEN_FORMATS) + 1
    assert runs[0].keys() == runs[1].keys()
    differing = [name for name, data in runs[0].items() if data != runs[1][name]]
    assert not differing


# What cannot be written in any way ----------------------------------------------------------------


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
    assert (tmp_path / "plate.eia") in verifiable_files(tmp_path)
    against = Reference(design.discs, 0.001)
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
    against = Reference(other.discs, 0.001)
    (verdict,) = verify_files((program,), lambda *_: against, Wanted())
    (check,) = [each for each in verdict.checks if each.name == "operations"]
    assert check.ok is False
    assert "needs [[tool]]" in check.note


# A writer of another distribution, installed with camgeo and used from the command line -----------


INCH = Path(__file__).parents[2] / "fixtures" / "scenes" / "inch.toml"

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


def build(
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
    head, _, _ = INCH.read_text().partition("[output]")
    return f"{head}[output]\nformats = [{formats}]\n{table}"


def test_a_scene_names_it_and_its_options_reach_it(installed: Path, tmp_path: Path) -> None:
    table = '[output.sat]\nchord = 0.125\nturn = 45\nschema = "ACIS 7"\n'
    done = build(installed, tmp_path, scene(table))
    assert (done.returncode, done.stderr) == (0, "")
    written = (tmp_path / "out" / "inch.sat").read_text()
    assert written == "SatSpec(chord=3.175, turn=0.7853981633974483, schema='ACIS 7')"
    certificate = json.loads((tmp_path / "out" / "certificate.json").read_text())
    (record, _) = certificate["files"]
    assert (record["file"], record["format"], record["solids"]) == ("inch.sat", "sat", 1)
    # A scene with other options is another one.
    build(installed, tmp_path, scene(table.replace("45", "44")), "--force")
    other = json.loads((tmp_path / "out" / "certificate.json").read_text())
    assert certificate["scene"]["sha256"] != other["scene"]["sha256"]


def test_the_command_line_names_it_too(installed: Path, tmp_path: Path) -> None:
    done = build(installed, tmp_path, scene(formats='"csv"'), "--only", "sat")
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
    done = build(installed, tmp_path, text, "--only", "sat")
    assert done.returncode == 2
    assert "format = sat: needs [part] thickness" in done.stderr
    assert not (tmp_path / "out").exists()
