"""What programs of others say of our files, where they are installed, and what pages draw.

`python -m tests.judges` shows which ran; here those that are absent are skipped with a word.
"""

from __future__ import annotations

import json
import re
import zlib
from collections.abc import Callable, Sequence
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from random import Random
from typing import Any, Final

import numpy as np
import pytest
import shapely

import camgeo
from camgeo.design.product import Product
from camgeo.design.verify import ReadingOptions
from camgeo.milling.machine import load
from camgeo.numeric.arrays import FloatArray
from camgeo.pictures.model import Axis, Figure, Line, Panel, Style, figure_data, over
from camgeo_export.browser.bundles import bundle
from camgeo_export.interpreter.run import run
from camgeo_export.step.writer import WRITER as STEP_WRITER
from camgeo_export.verify.step import VERIFIER as STEP
from tests.draws.programs import compared, program
from tests.judges import cad, chromium, grbl, node, rs274
from tests.judges.__main__ import JUDGES, Extent, main
from tests.judges.chromium import measured
from tests.judges.files import (
    COMPENSATED,
    SIX,
    TOLERANCE,
    Given,
    files,
    random_contour,
    reports,
    scene_of,
    sheets,
)
from tests.judges.paths import Leg, difference
from tests.judges.programs_of_others import Program, Refusal
from tests.long_form import LONG, examples

linuxcnc = pytest.mark.skipif(bool(rs274.absent()), reason=rs274.absent() or "is there")


def there(program: Program) -> pytest.MarkDecorator:
    """Marks tests that a program of others is needed for."""
    return pytest.mark.skipif(bool(program.absent()), reason=program.absent() or "is there")


slicer, browser, freecad = there(cad.SLICER), there(chromium.CHROMIUM), there(cad.FREECAD)

ELSEWHERE = ("Grbl 1.1, its planner", "Chromium, the designer", "node, TypeScript")
"""Judges that have tests of their own, or that fetch packages."""


@pytest.mark.parametrize("name", [name for name in JUDGES if name not in ELSEWHERE])
def test_a_judge_that_is_there_agrees(name: str) -> None:
    absent, judge = JUDGES[name]
    if reason := absent():
        pytest.skip(reason)
    assert judge(Extent(everything=LONG, few=True))


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


@linuxcnc
@pytest.mark.parametrize("seed", range(examples(4, long=60)))
def test_linuxcnc_refuses_and_runs_short_programs_as_we_say(seed: int) -> None:
    assert compared(program(Random(seed), "linuxcnc"), "linuxcnc")[0] == ""


@there(grbl.PARSER)
@pytest.mark.parametrize("seed", range(examples(20, long=300)))
def test_grbl_refuses_and_runs_short_programs_as_we_say(seed: int) -> None:
    assert compared(program(Random(seed), "grbl"), "grbl")[0] == ""


def test_a_path_that_differs_is_told() -> None:
    """The comparison itself."""
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


def test_lib3mf_refuses_another_body(tmp_path: Path) -> None:
    (given,) = files(tmp_path, "3mf", [SIX[0]])
    with pytest.raises(Refusal, match="its volume is"):
        cad.judged_by_lib3mf(replace(given, volume=1.001 * given.volume))


@slicer
def test_a_slicer_refuses_an_open_body(tmp_path: Path) -> None:
    (given,) = files(tmp_path, "stl", [SIX[0]])
    data = given.path.read_bytes()
    count = int.from_bytes(data[80:84], "little") - 1
    given.path.write_bytes(data[:80] + count.to_bytes(4, "little") + data[84:-50])
    with pytest.raises(Refusal, match="is not one closed body"):
        cad.judged_by_slicer(given)


@slicer
def test_perimeters_of_another_part_are_refused(tmp_path: Path) -> None:
    (given,) = files(tmp_path, "stl", [SIX[0]])
    design = camgeo.load(scene_of(SIX[0]))
    larger = {"follower.base_radius": design.cam.follower.base_radius + 0.2}
    other = camgeo.Design(design.scene.with_values(larger)).disc.drawn.part
    with pytest.raises(Refusal, match=r"of the disc is 0\.2"):
        cad.slice_(replace(given, part=other))


@slicer
def test_perimeters_run_along_the_compensated_part(tmp_path: Path) -> None:
    """Foot and scale included."""
    (given,) = files(tmp_path, "3mf", [SIX[0]], COMPENSATED)
    assert cad.slice_(given) <= TOLERANCE + cad.RESOLUTION


def test_loops_of_a_sliced_body_are_read() -> None:
    text = (
        "G1 X9 Y9 E1\n;LAYER_CHANGE\n;Z:0.8\n;HEIGHT:0.8\nG1 X0 Y0 F100\nG1 X2 Y0 E.1\nG1 X2 Y1.5"
        " E.1 ; perimeter\nG1 X5 Y5 F100\nG1 X6 Y5 E.1\n;LAYER_CHANGE\n;Z:1.2\n;HEIGHT:0.4\n"
    )
    found = cad.perimeters(text)
    assert list(found) == pytest.approx([0.4, 1.0])
    first, second = found[0.4]
    assert (first.tolist(), second.tolist()) == ([0j, 2 + 0j, 2 + 1.5j], [5 + 5j, 6 + 5j])


PAGES = {
    "report": (
        reports,
        chromium.judge_report,
        {
            '"animation":': '"animations":',
            "<main>": "<main><script>1</script><figure></figure>",
        },
        ("the cam does not turn", "a figure is blank", "not its own"),
    ),
    "sheet": (
        sheets,
        chromium.judge,
        {
            "<!DOCTYPE html>": "",
            "<h2>Tools": "<h2></h2><h2>Tools",
            "<figure>": '<figure style="width: 90em">',
            "</style>": "svg { width: 20px }</style>",
            'viewBox="0 0': 'viewBox="100 0',
            "</body>": "<img src='https://camgeo.invalid/a.png'></body>",
        },
        (*chromium.FAULTS, "Content Security Policy"),
    ),
}
"""Of each page how it is made and judged, what is spoilt, and what is said of it then."""


@browser
@pytest.mark.parametrize("name", PAGES)
def test_a_browser_refuses_a_page_that_is_wrong(name: str, tmp_path: Path) -> None:
    made, judge, changes, faults = PAGES[name]
    (page,) = made(tmp_path, [SIX[0]])
    text = page.read_text("utf-8")
    for good, changed in changes.items():
        assert good in text
        text = text.replace(good, changed, 1)
    page.write_text(text, "utf-8")
    with pytest.raises(Refusal) as refused:
        judge(page)
    assert [fault for fault in faults if fault not in str(refused.value)] == []


def test_the_size_of_what_is_stroked_is_read_from_a_page() -> None:
    page = b"0.06 0 0 -0.06 0 842 cm\n0 0 m\n9999 0 l\nW* n\n100 200 m\n1300 200 l\n1300 700 l\nS\n"
    paper = b"%PDF-1.4\nstream\n" + zlib.compress(page) + b"endstream\n"
    point = 0.06 * 25.4 / 72.0
    assert cad.stroked(paper) == pytest.approx((1200.0 * point, 500.0 * point))


VALID = '"solids": 1, "shells": 1, "valid": true'

FREECAD, OCC = (cad.FREECAD, cad.judged_by_freecad), (cad.OCC, cad.judged_by_occ)


@pytest.mark.parametrize(
    ("judge", "says", "fault"),
    [
        (FREECAD, '"size": [100.0, 50.01]', ""),
        (FREECAD, '"size": [100.0, 50.1]', "mm large"),
        (FREECAD, '"solid": true, "faces": 7, "volume": 10.0', ""),
        (FREECAD, '"solid": false, "faces": 7, "volume": 10.0', "not one closed body"),
        (FREECAD, '"solid": true, "faces": 7, "volume": 10.1', "its volume is"),
        (FREECAD, '"error": "it has no curves"', "it has no curves"),
        (FREECAD, '"solid": true, "volume": 10.0', "has 0 faces, not 7"),
        (OCC, f'{VALID}, "faces": 7, "volume": 10.0', ""),
        (OCC, f'{VALID.replace("true", "false")}, "faces": 7, "volume": 10.0', "one valid"),
        (OCC, f'{VALID.replace("1", "2")}, "faces": 7, "volume": 10.0', "one valid"),
        (OCC, f'{VALID}, "faces": 8, "volume": 10.0', "has 8 faces"),
        (OCC, f'{VALID}, "faces": 7, "volume": 10.1', "its volume"),
        (OCC, '"error": "it is not read"', "it is not read"),
    ],
)
def test_what_a_program_says_is_judged(
    judge: tuple[Program, Callable[[Given], float]],
    says: str,
    fault: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """By a program that says it in FreeCAD's place, or in that of a Python with OpenCASCADE."""
    program = tmp_path / "program"
    program.write_text(f"#!/bin/sh\necho Banner\necho 'camgeo: {{{says}}}'\n")
    program.chmod(0o755)
    monkeypatch.setenv(judge[0].variable, str(program))
    given = Given(tmp_path / "a.step", (100.0, 50.0), 10.0, faces=7)
    with pytest.raises(Refusal, match=fault) if fault else nullcontext():
        judge[1](given)


def test_a_python_without_opencascade_is_told(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv(cad.OCC.variable, "")
    assert cad.occ_missing() == "CAMGEO_OCC names no Python that has OCP"
    monkeypatch.setenv(cad.OCC.variable, str(tmp_path / "gone"))
    assert cad.occ_missing().endswith("gone is not there")
    for code, said in ((1, "has no OCP"), (0, "")):
        (tmp_path / "python").write_text(f"#!/bin/sh\nexit {code}\n")
        (tmp_path / "python").chmod(0o755)
        monkeypatch.setenv(cad.OCC.variable, str(tmp_path / "python"))
        assert cad.occ_missing().endswith(said)


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
    monkeypatch.setenv(cad.SLICER.variable, str(tmp_path / "gone"))
    assert cad.SLICER.absent() == f"{tmp_path / 'gone'} is not there"


def test_the_table_fails_on_a_judge_that_is_absent_only_if_all_are_wanted(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    judges = {name: (lambda: "gone", judge) for name, (_, judge) in JUDGES.items()}
    monkeypatch.setattr("tests.judges.__main__.JUDGES", judges)
    assert (main([]), main(["--all"])) == (0, 1)
    assert capsys.readouterr().out.count("absent: gone") == 2 * len(JUDGES)


@freecad
def test_freecad_refuses_a_solid_without_one_of_its_faces(tmp_path: Path) -> None:
    given, *_ = files(tmp_path, "step", [SIX[0]])
    data = given.path.read_bytes()
    given.path.write_bytes(re.sub(rb"(=CLOSED_SHELL\('',\()#\d+,", rb"\1", data))
    with pytest.raises(Refusal, match=r"not one closed body|has \d+ faces|BRep"):
        cad.judged_by_freecad(given)


def verified_again(product: Product, tmp_path: Path) -> set[str]:
    """What is checked of a solid that FreeCAD has written again: it holds, and is not ours."""
    data = (tmp_path / "again.step").read_bytes()
    assert not STEP.origin(data).version
    checks = [*STEP.checks(product, data, ReadingOptions("again.step"), TOLERANCE)]
    assert [check for check in checks if check.ok is False] == []
    return {check.name for check in checks}


EDGES = {"outline": {"width": 0.5}, "bore": {"width": 1, "edges": "upper"}}


@freecad
@pytest.mark.parametrize(
    "feature",
    [
        {"chamfers": EDGES},
        {"chamfers": {"bore": {"width": 1}}, "keyway": {"width": 6, "depth": 2.8}},
        {"chamfers": {"bore": {"width": 1}}, "d_shaft": {"across": 18}},
    ],
)
def test_freecad_reads_chamfers(tmp_path: Path, feature: dict[str, Any]) -> None:
    """Cones, which meet planes along parabolas: one valid solid of as many faces, of the volume of
    its own arcs, and verified when it has been written again.
    """
    keys = {"part": {"thickness": 10, "bore": 20, **feature}}
    product = camgeo.Design(camgeo.load(scene_of(SIX[0])).scene.with_values(keys)).disc
    written = STEP_WRITER.write(product, TOLERANCE)
    path = tmp_path / "chamfers.step"
    path.write_bytes(written.data)
    volume, faces = (written.facts[key] for key in ("volume_mm3", "faces"))
    assert len(feature) > 1 or int(written.facts["cones"]) > 10
    given = Given(path, volume=float(volume), near=1e-11, faces=int(faces))
    cad.judged_by_freecad(given, tmp_path / "again.step")
    verified_again(product, tmp_path)


@freecad
def test_what_freecad_makes_of_a_solid_is_verified_too(tmp_path: Path) -> None:
    """Its file has another schema, seams, other entities, and is in no way ours."""
    given, *_ = files(tmp_path, "step", [SIX[0]])
    cad.judged_by_freecad(given, tmp_path / "again.step")
    found = verified_again(camgeo.load(scene_of(SIX[0])).disc, tmp_path)
    assert {"deviation", "volume", "uncertainty"} <= found


# What pages draw in place is what they draw anew, and is what the data say ------------------------


SIDE = 10.0
"""Of a figure [inch]; its panel, of side 1, fills it."""

POINT = 1.0 / (72.0 * SIDE)
"""The length of a point in such a panel."""

SEEN = 0.03
"""By how many points a written line may pass a point of its curve (course.ts)."""


def curves() -> list[FloatArray]:
    """Smooth, straight, with corners and steps, turning back, closed, at random."""
    t = np.linspace(0.0, 1.0, 1500)
    random = np.random.default_rng(1)
    return [
        over(t, 0.5 + 0.4 * np.sin(9.0 * t)),
        over(t, 0.2 + 0.5 * t),
        over(t, np.where(t < 0.5, 0.1, 0.9)),
        over(t, 0.5 + 0.3 * np.abs(np.sin(20.0 * t))),
        over(0.5 + 0.4 * np.sin(40.0 * t), np.full_like(t, 0.3)),
        over(0.5 + 0.4 * np.cos(2.0 * np.pi * t), 0.5 + 0.4 * np.sin(2.0 * np.pi * t)),
        over(random.random(300), random.random(300)),
        0.5 + np.cumsum(random.normal(0.0, 0.5 * POINT, (1500, 2)), axis=0),
        over(t, 0.5 + random.normal(0.0, SEEN * POINT, t.size)),
    ]


def figure(lines: list[FloatArray]) -> dict[str, Any]:
    marks = tuple(Line(points, Style("#000000")) for points in lines)
    panel = Panel((0.0, 0.0, 1.0, 1.0), Axis((0.0, 1.0)), Axis((0.0, 1.0)), marks, bare=True)
    return {"figure": figure_data(Figure((SIDE, SIDE), (panel,))), "sentence": "<img src=x>"}


def drawn(path: str) -> list[FloatArray]:
    """The strokes of a path, in the coordinates of the panel."""
    found = []
    for stroke in path.split("M")[1:]:
        points = np.array(re.findall(r"-?[\d.]+", stroke), np.float64).reshape(-1, 2)
        found.append(over(points[:, 0] * POINT, 1.0 - points[:, 1] * POINT))
    return found


@browser
def test_curves_are_drawn_as_the_data_say() -> None:
    lines = curves()
    gaps = over(np.linspace(0.0, 1.0, 9), [0.1, 0.2, np.nan, 0.3, 0.5, 0.1, np.nan, np.nan, 0.2])
    answer = shown([{"animation": None, "charts": [figure([*lines, gaps])]}])
    assert (answer["differing"], answer["images"]) == ([0, 0], 0)
    assert "<img src=x>" in answer["texts"]
    rounding = 0.5 * np.hypot(0.01, 0.01)
    *paths, last = answer["paths"]
    assert [stroke[0, 0] for stroke in drawn(last)] == pytest.approx([0.0, 0.375, 1.0])
    assert [stroke[-1, 0] for stroke in drawn(last)] == pytest.approx([0.125, 0.625, 1.0])
    for path, points in zip(paths, lines, strict=True):
        (stroke,) = drawn(path)
        apart = shapely.distance(shapely.LineString(stroke), shapely.points(points))
        assert apart.max() < (SEEN + 2.0 * rounding) * POINT
        ends = np.abs(stroke[[0, -1]] - points[[0, -1]])
        assert ends.max() < 0.0051 * POINT


@browser
def test_drawings_are_redrawn_in_place(tmp_path: Path) -> None:
    """Each mechanism and diagram after each other, as in a viewer of its own."""
    texts = [path.read_text("utf-8") for path in reports(tmp_path, ["setzhub", "groove"])]
    pattern = re.compile(r'id="data">(.*?)</script>', re.DOTALL)
    found = [json.loads(pattern.findall(text)[0]) for text in texts]
    datas = [
        {"animation": each["animation"], "charts": [chart]}
        for each in found
        for chart in each["charts"][:3]
    ]
    assert shown(datas)["differing"] == [0] * 2 * len(datas)


# -- chromium viewer -------------------------------------------------------------------------------
# Chromium runs the viewer of notebooks, which draws with the modules that all pages share.


PROBE: Final = """
const datas = JSON.parse(document.getElementById("data").textContent);
function shown(data) {
  const holder = document.body.appendChild(document.createElement("div"));
  const calls = new Map();
  const model = {
    get: (name) => (name === "data" ? data : 0),
    set: () => {},
    save_changes: () => {},
    on: (event, call) => calls.set(event, call),
    off: (event) => calls.delete(event),
  };
  const remove = viewer.render({ model, el: holder });
  return {
    redraw(other) { data = other; calls.get("change:data")(); },
    root: holder.firstChild.shadowRoot,
    ended() { remove(); return !calls.size && !holder.firstChild; },
  };
}
const tree = (e) => [e.tagName, [...e.attributes].map((a) => `${a.name}=${a.value}`).sort(),
  e.children.length ? [...e.children].map(tree) : e.textContent];
const picture = (view) => [...view.root.querySelectorAll("svg, figcaption")].map((e) =>
  JSON.stringify(tree(e)).replace(/clip-\\d+/g, "clip"));
const view = shown(datas[0]);
const differing = [];
for (const data of [...datas, ...datas]) {
  view.redraw(data);
  const fresh = shown(data);
  const [mine, other] = [picture(view), picture(fresh)];
  differing.push(mine.filter((each, k) => each !== other[k]).length);
  if (!fresh.ended()) differing.push(-1);
}
document.body.dataset.camgeo = JSON.stringify({
  differing,
  paths: [...view.root.querySelectorAll("path")].map((e) => e.getAttribute("d")),
  texts: view.root.textContent,
  images: view.root.querySelectorAll("img, script").length,
});
"""
"""Shows all data in one viewer, one after the other, and each in a viewer of its own."""


def shown(datas: Sequence[Any]) -> dict[str, Any]:
    """What the probe finds; of `paths`, `texts` and `images` those of the last of `datas`."""
    script, count = re.subn(
        r"export\{(\w+) as default\};\s*$", r"var viewer=\1;", bundle("viewer.js")
    )
    assert count == 1
    data = json.dumps(datas).replace("<", "\\u003c")
    page = (
        '<!DOCTYPE html><html><meta charset="utf-8"><body>'
        f'<script type="application/json" id="data">{data}</script>'
        f"<script>{script}</script><script>{PROBE}</script></body></html>"
    )
    answer, _ = measured("the viewer", page)
    return answer
