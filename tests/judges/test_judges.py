"""What programs of others say of our files, where they are installed.

`python -m tests.judges` shows which ran; here those that are absent are skipped with a word.
"""

from __future__ import annotations

import re
import zlib
from dataclasses import replace
from pathlib import Path
from random import Random

import pytest

import camgeo
from camgeo.design.verify import Reading
from camgeo.milling.machine import load
from camgeo_export.interpreter.run import run
from camgeo_export.step.writer import WRITER as STEP_WRITER
from camgeo_export.verify.step import VERIFIER as STEP
from tests.draws.programs import compared, program
from tests.judges import (
    bad,
    chromium,
    freecad,
    grbl,
    lib3mf_reader,
    librecad,
    node,
    occ,
    prusa,
    rs274,
)
from tests.judges.__main__ import JUDGES, main
from tests.judges.files import COMPENSATED, Given, files, reports, scenes, sheets
from tests.judges.paths import difference
from tests.judges.programs import (
    SIX,
    TOLERANCE,
    milled_scenes,
    programs,
    random_contour,
    random_program,
    scene_of,
    workshop,
)
from tests.judges.programs_of_others import Refusal
from tests.long_form import LONG, examples

NEAR = 1e-4
"""How far another interpreter's path may be from ours [mm]; Grbl computes in single precision."""

linuxcnc = pytest.mark.skipif(bool(rs274.absent()), reason=rs274.absent() or "is there")
grbl_parser = pytest.mark.skipif(bool(grbl.absent()), reason=grbl.absent() or "is there")
slicer = pytest.mark.skipif(bool(prusa.missing()), reason=prusa.missing() or "is there")
browser = pytest.mark.skipif(bool(chromium.missing()), reason=chromium.missing() or "is there")
cad = pytest.mark.skipif(bool(freecad.missing()), reason=freecad.missing() or "is there")
suite = pytest.mark.skipif(bool(bad.absent()), reason=bad.absent() or "is there")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return workshop(tmp_path_factory.mktemp("workshop"))


@linuxcnc
@pytest.mark.parametrize("scene", milled_scenes() if LONG else SIX)
def test_linuxcnc_runs_the_same_path(scene: str, folder: Path) -> None:
    for _, data in programs(folder, scene, "linuxcnc"):
        text = data.decode()
        legs, said = rs274.run(text)
        assert said == ""
        assert difference(run(text, load("linuxcnc")), legs) <= NEAR


@linuxcnc
@pytest.mark.parametrize("seed", range(examples(2, long=30)))
def test_linuxcnc_understands_random_programs_as_we_do(seed: int) -> None:
    text = random_program(Random(seed), 300, absolute_centres=True)
    legs, said = rs274.run(text)
    assert said == ""
    assert len(legs) > 150
    assert difference(run(text, load("linuxcnc"), most=10_000), legs) <= 1e-9


@linuxcnc
@pytest.mark.parametrize("first", range(0, examples(20, long=300), 10))
def test_what_linuxcnc_refuses_under_compensation_is_found(first: int) -> None:
    """We also find moves that it would shorten to nothing behind the last corner."""
    stricter = 0
    for seed in range(first, first + 10):
        text = random_contour(Random(seed))
        _, said = rs274.run(text)
        found = {each.rule for each in run(text, load("linuxcnc")).findings}
        ours = bool(found & {"gouge", "compensation"})
        assert ours or not said, (seed, said)
        stricter += ours and not said
    assert stricter <= 2


@grbl_parser
@pytest.mark.parametrize("scene", milled_scenes() if LONG else SIX)
def test_grbl_runs_the_same_path(scene: str, folder: Path) -> None:
    for _, data in programs(folder, scene, "grbl"):
        text = data.decode()
        legs, errors = grbl.run(text)
        assert errors == []
        assert difference(run(text, load("grbl")), legs) <= NEAR


@grbl_parser
@pytest.mark.parametrize("seed", range(examples(2, long=30)))
def test_grbl_understands_random_programs_as_we_do(seed: int) -> None:
    text = random_program(Random(seed), 300, absolute_centres=False)
    legs, errors = grbl.run(text)
    assert errors == []
    # Centres of arcs by their radius move by more than the ends that single precision rounds.
    assert difference(run(text, load("grbl"), most=10_000), legs) <= 2e-3


@linuxcnc
@pytest.mark.parametrize("seed", range(examples(4, long=60)))
def test_linuxcnc_refuses_and_runs_short_programs_as_we_say(seed: int) -> None:
    assert compared(program(Random(seed), "linuxcnc"), "linuxcnc")[0] == ""


@grbl_parser
@pytest.mark.parametrize("seed", range(examples(20, long=300)))
def test_grbl_refuses_and_runs_short_programs_as_we_say(seed: int) -> None:
    assert compared(program(Random(seed), "grbl"), "grbl")[0] == ""


@suite
def test_programs_that_must_fail_do() -> None:
    assert len(bad.programs()) >= 20
    assert [path.name for path in bad.programs() if not bad.found(path)] == []


def test_a_path_that_differs_is_told() -> None:
    """The comparison itself."""
    from tests.judges.paths import Leg

    found = run("G21 G0 Z5\nG0 X1 Y2\nG2 X3 Y2 I1 J0 F1\nM2\n", load("linuxcnc"))
    legs = [
        Leg(1, "rapid", (0.0, 0.0, 5.0)),
        Leg(2, "rapid", (1.0, 2.0, 5.0)),
        Leg(3, "arc", (3.0, 2.0, 5.0), 2 + 2j, -1),
    ]
    assert difference(found, legs) == 0.0
    assert difference(found, [*legs[:2], Leg(3, "arc", (3.0, 2.1, 5.0), 2 + 2j, -1)]) >= 0.09
    for wrong in ([*legs, legs[0]], legs[:2], [*legs[:2], Leg(3, "arc", legs[2].end, 2 + 2j, 1)]):
        with pytest.raises(AssertionError):
            difference(found, wrong)


READERS = {
    "freecad": (freecad, ("dxf", "stl", "step")),
    "opencascade": (occ, ("step",)),
    "librecad": (librecad, ("dxf",)),
    "prusa": (prusa, ("stl", "3mf")),
    "lib3mf": (lib3mf_reader, ("3mf",)),
}


@pytest.mark.parametrize(
    ("name", "kind"), [(name, kind) for name, (_, kinds) in READERS.items() for kind in kinds]
)
def test_others_read_the_files_that_we_wrote(name: str, kind: str, tmp_path: Path) -> None:
    judge = READERS[name][0]
    if reason := judge.missing():
        pytest.skip(reason)
    for given in files(tmp_path, kind, scenes(kind) if LONG else [SIX[0]]):
        judge.judge(given)


def test_lib3mf_refuses_another_body(tmp_path: Path) -> None:
    (given,) = files(tmp_path, "3mf", [SIX[0]])
    with pytest.raises(Refusal, match="its volume is"):
        lib3mf_reader.judge(replace(given, volume=1.001 * given.volume))


@slicer
def test_a_slicer_refuses_an_open_body(tmp_path: Path) -> None:
    (given,) = files(tmp_path, "stl", [SIX[0]])
    data = given.path.read_bytes()
    count = int.from_bytes(data[80:84], "little") - 1
    given.path.write_bytes(data[:80] + count.to_bytes(4, "little") + data[84:-50])
    with pytest.raises(Refusal, match="is not one closed body"):
        prusa.judge(given)


@slicer
def test_perimeters_run_along_the_exact_part(tmp_path: Path) -> None:
    (given,) = files(tmp_path, "stl", [SIX[0]])
    assert prusa.slice_(given) <= TOLERANCE + prusa.RESOLUTION
    design = camgeo.load(scene_of(SIX[0]))
    larger = {"follower.base_radius": design.cam.follower.base_radius + 0.2}
    other = camgeo.Design(design.scene.with_values(larger)).disc.drawn.part
    with pytest.raises(Refusal, match=r"of the disc is 0\.2"):
        prusa.slice_(replace(given, part=other))


@slicer
def test_perimeters_run_along_the_compensated_part(tmp_path: Path) -> None:
    """Foot and scale included."""
    (given,) = files(tmp_path, "3mf", [SIX[0]], COMPENSATED)
    assert prusa.slice_(given) <= TOLERANCE + prusa.RESOLUTION


def test_loops_of_a_sliced_body_are_read() -> None:
    text = (
        "G1 X9 Y9 E1\n;LAYER_CHANGE\n;Z:0.8\n;HEIGHT:0.8\nG1 X0 Y0 F100\nG1 X2 Y0 E.1\nG1 X2 Y1.5"
        " E.1 ; perimeter\nG1 X5 Y5 F100\nG1 X6 Y5 E.1\n;LAYER_CHANGE\n;Z:1.2\n;HEIGHT:0.4\n"
    )
    found = prusa.perimeters(text)
    assert list(found) == pytest.approx([0.4, 1.0])
    first, second = found[0.4]
    assert (first.tolist(), second.tolist()) == ([0j, 2 + 0j, 2 + 1.5j], [5 + 5j, 6 + 5j])


@pytest.fixture(scope="module")
def sheet(tmp_path_factory: pytest.TempPathFactory) -> Path:
    (page,) = sheets(tmp_path_factory.mktemp("sheet"), [SIX[0]])
    return page


@browser
def test_a_browser_shows_a_setup_sheet(sheet: Path) -> None:
    chromium.judge(sheet)


@browser
def test_a_browser_shows_a_report_and_turns_its_cam(tmp_path: Path) -> None:
    (page,) = reports(tmp_path, ["setzhub"])
    chromium.judge_report(page)


@browser
def test_a_browser_refuses_a_report_that_is_wrong(tmp_path: Path) -> None:
    (page,) = reports(tmp_path, ["setzhub"])
    text = page.read_text("utf-8")
    for good, changed in (
        ('"animation":', '"animations":'),
        ("<main>", "<main><script>1</script><figure></figure>"),
    ):
        assert good in text
        text = text.replace(good, changed)
    page.write_text(text, "utf-8")
    with pytest.raises(Refusal) as refused:
        chromium.judge_report(page)
    for fault in ("the cam does not turn", "a figure is blank", "not its own"):
        assert fault in str(refused.value)


@browser
def test_a_browser_refuses_a_sheet_that_is_wrong(sheet: Path, tmp_path: Path) -> None:
    text = sheet.read_text("utf-8")
    for good, changed in (
        ("<!DOCTYPE html>", ""),
        ("<h2>Tools", "<h2></h2><h2>Tools"),
        ("<figure>", '<figure style="width: 90em">'),
        ("</style>", "svg { width: 20px }</style>"),
        ('viewBox="0 0', 'viewBox="100 0'),
        ("</body>", "<img src='https://camgeo.invalid/a.png'></body>"),
    ):
        assert good in text
        text = text.replace(good, changed, 1)
    wrong = tmp_path / "wrong.html"
    wrong.write_text(text, "utf-8")
    with pytest.raises(Refusal) as refused:
        chromium.judge(wrong)
    for fault in (*chromium.FAULTS, "Content Security Policy"):
        assert fault in str(refused.value)


def test_the_size_of_what_is_stroked_is_read_from_a_page() -> None:
    page = b"0.06 0 0 -0.06 0 842 cm\n0 0 m\n9999 0 l\nW* n\n100 200 m\n1300 200 l\n1300 700 l\nS\n"
    paper = b"%PDF-1.4\nstream\n" + zlib.compress(page) + b"endstream\n"
    point = 0.06 * 25.4 / 72.0
    assert librecad.stroked(paper) == pytest.approx((1200.0 * point, 500.0 * point))


@pytest.mark.parametrize(
    ("says", "fault"),
    [
        ('{"size": [100.0, 50.01]}', ""),
        ('{"size": [100.0, 50.1]}', "mm large"),
        ('{"solid": true, "volume": 10.0}', ""),
        ('{"solid": false, "volume": 10.0}', "not one closed body"),
        ('{"solid": true, "volume": 10.1}', "its volume is"),
        ('{"error": "it has no curves"}', "it has no curves"),
        ('{"solid": true, "volume": 10.0, "faces": 7}', "has 7 faces, not 0"),
    ],
)
def test_what_freecad_says_is_judged(
    says: str, fault: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By a program that says it in FreeCAD's place."""
    program = tmp_path / "freecadcmd"
    program.write_text(f"#!/bin/sh\necho Banner\necho 'camgeo: {says}'\n")
    program.chmod(0o755)
    monkeypatch.setenv(freecad.VARIABLE, str(program))
    given = Given(tmp_path / "a.dxf", (100.0, 50.0), 10.0)
    if fault:
        with pytest.raises(Refusal, match=fault):
            freecad.judge(given)
    else:
        freecad.judge(given)


@pytest.mark.parametrize(
    ("says", "fault"),
    [
        ('{"solids": 1, "shells": 1, "faces": 7, "valid": true, "volume": 10.0}', ""),
        ('{"solids": 1, "shells": 1, "faces": 7, "valid": false, "volume": 10.0}', "one valid"),
        ('{"solids": 2, "shells": 2, "faces": 7, "valid": true, "volume": 10.0}', "one valid"),
        ('{"solids": 1, "shells": 1, "faces": 8, "valid": true, "volume": 10.0}', "has 8 faces"),
        ('{"solids": 1, "shells": 1, "faces": 7, "valid": true, "volume": 10.1}', "its volume"),
        ('{"error": "it is not read"}', "it is not read"),
    ],
)
def test_what_opencascade_says_is_judged(
    says: str, fault: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By a program that says it in the place of a Python that has it."""
    program = tmp_path / "python"
    program.write_text(f"#!/bin/sh\necho 'camgeo: {says}'\n")
    program.chmod(0o755)
    monkeypatch.setenv(occ.VARIABLE, str(program))
    assert occ.missing() == ""
    given = Given(tmp_path / "a.step", volume=10.0, faces=7)
    if fault:
        with pytest.raises(Refusal, match=fault):
            occ.judge(given)
    else:
        occ.judge(given)


def test_a_python_without_opencascade_is_told(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv(occ.VARIABLE, "")
    assert occ.missing() == "CAMGEO_OCC names no Python that has OCP"
    monkeypatch.setenv(occ.VARIABLE, str(tmp_path / "gone"))
    assert occ.missing().endswith("gone is not there")
    (tmp_path / "python").write_text("#!/bin/sh\nexit 1\n")
    (tmp_path / "python").chmod(0o755)
    monkeypatch.setenv(occ.VARIABLE, str(tmp_path / "python"))
    assert occ.missing().endswith("has no OCP")


def test_scripts_that_are_not_what_their_sources_give_are_named(tmp_path: Path) -> None:
    kept, made = tmp_path / "kept", tmp_path / "made"
    for folder, texts in ((kept, "abc"), (made, "aBd")):
        folder.mkdir()
        for name, text in zip(("same.js", "other.js", f"{folder.name}.js"), texts, strict=True):
            (folder / name).write_text(text)
    assert node.differing(kept, made) == ["kept.js", "made.js", "other.js"]
    assert node.differing(kept, kept) == []


def test_a_variable_that_names_nothing_makes_a_judge_absent(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv(prusa.VARIABLE, str(tmp_path / "gone"))
    assert prusa.missing() == f"{tmp_path / 'gone'} is not there"


def test_the_table_fails_on_a_judge_that_is_absent_only_if_all_are_wanted(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    judges = tuple((name, lambda: "gone", judge) for name, _, judge in JUDGES)
    monkeypatch.setattr("tests.judges.__main__.JUDGES", judges)
    assert (main([]), main(["--all"])) == (0, 1)
    assert capsys.readouterr().out.count("absent: gone") == 2 * len(JUDGES)


@cad
def test_freecad_refuses_a_solid_without_one_of_its_faces(tmp_path: Path) -> None:
    given, *_ = files(tmp_path, "step", [SIX[0]])
    data = given.path.read_bytes()
    given.path.write_bytes(re.sub(rb"(=CLOSED_SHELL\('',\()#\d+,", rb"\1", data))
    with pytest.raises(Refusal, match=r"not one closed body|has \d+ faces|BRep"):
        freecad.judge(given)


@cad
def test_freecad_reads_chamfers_as_cones(tmp_path: Path) -> None:
    """One valid solid of as many faces, of the volume of its own arcs, and verified when it has
    been written again.
    """
    edges = {"outline": {"width": 0.5}, "bore": {"width": 1, "edges": "upper"}}
    keys = {"part": {"thickness": 10, "bore": 20, "chamfers": edges}}
    base = camgeo.load(scene_of(SIX[0])).scene
    product = camgeo.Design(base.with_values(keys)).disc
    written = STEP_WRITER.write(product, TOLERANCE)
    path = tmp_path / "chamfers.step"
    path.write_bytes(written.data)
    volume, faces = (written.facts[key] for key in ("volume_mm3", "faces"))
    assert int(written.facts["cones"]) > 10
    given = Given(path, volume=float(volume), near=1e-11, faces=int(faces))
    freecad.judge(given, tmp_path / "again.step")


@cad
@pytest.mark.parametrize(
    "feature", [{"keyway": {"width": 6, "depth": 2.8}}, {"d_shaft": {"across": 18}}]
)
def test_freecad_reads_mitred_chamfers(
    tmp_path: Path, feature: dict[str, dict[str, int | float]]
) -> None:
    """Cones and planes meet along parabolas: one valid solid, and verified when written again."""
    keys = {"part": {"thickness": 10, "bore": 20, "chamfers": {"bore": {"width": 1}}, **feature}}
    product = camgeo.Design(camgeo.load(scene_of(SIX[0])).scene.with_values(keys)).disc
    written = STEP_WRITER.write(product, TOLERANCE)
    path = tmp_path / "mitred.step"
    path.write_bytes(written.data)
    volume, faces = (written.facts[key] for key in ("volume_mm3", "faces"))
    given = Given(path, volume=float(volume), near=1e-11, faces=int(faces))
    freecad.judge(given, tmp_path / "again.step")
    again = (tmp_path / "again.step").read_bytes()
    checks = STEP.checks(product, again, Reading("again.step"), TOLERANCE)
    assert [check for check in checks if check.ok is False] == []


@cad
def test_what_freecad_makes_of_a_solid_is_verified_too(tmp_path: Path) -> None:
    """Its file has another schema, seams, other entities, and is in no way ours."""
    given, *_ = files(tmp_path, "step", [SIX[0]])
    freecad.judge(given, tmp_path / "again.step")
    data = (tmp_path / "again.step").read_bytes()
    product = camgeo.load(scene_of(SIX[0])).disc
    assert not STEP.origin(data).version
    checks = STEP.checks(product, data, Reading("again.step"), TOLERANCE)
    assert [check for check in checks if check.ok is False] == []
    assert {"deviation", "volume", "uncertainty"} <= {check.name for check in checks}
