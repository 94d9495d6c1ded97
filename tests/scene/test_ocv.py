"""Projects of opticurv: the layout of the thesis, every number checked, no digit lost."""

from __future__ import annotations

import math
import struct
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import camgeo
from camgeo.app.cli.import_ import FIELDS, RANGES, SIZE, import_project, project_numbers, scene_name
from camgeo.app.cli.main import main
from camgeo.errors import SceneError
from camgeo.scene.scene import parse_scene
from camgeo.scene.schema import schema, whole_schema
from tests.reference import THESIS_CAMS, reference
from tests.scene.scenes import refusal_by

FIXTURES = Path(__file__).parents[2] / "fixtures"

PROJECTS = FIXTURES / "reference" / "ocv"

SETZHUB = (PROJECTS / "setzhub.ocv").read_bytes()

ORDER = ("phi_H01", "phi_H12", "phi_H23", "phi_H34", "phi_H45", "l_3", "s_H", "alpha_sk", "l_sk",
         "l_4", "x_H", "y_H", "r_R", "x_A0", "y_A0", "beta", "r_G", "n")  # fmt: skip
"""The source's `wdaten` (lines 202 to 205) in the thesis's letters."""

FIRST = ("ja", "erster", "positiv")
"""Answers that the program writes as 1."""

Capture = pytest.CaptureFixture[str]


def packed(params: dict[str, Any]) -> bytes:
    """The project of a table of the thesis."""
    answers = [1.0 if params[f"q{k}"] in FIRST else 2.0 for k in range(21, 26)]
    return struct.pack("<24d", *(params[name] for name in ORDER), *answers, 0.0)


def changed(place: int, number: float, name: str = "setzhub") -> bytes:
    """The project `name` with another number at `place`, counted from 1."""
    data = bytearray((PROJECTS / f"{name}.ocv").read_bytes())
    data[8 * place - 8 : 8 * place] = struct.pack("<d", number)
    return bytes(data)


@pytest.mark.parametrize("name", THESIS_CAMS)
def test_the_fixtures_are_the_tables_of_the_thesis(name: str) -> None:
    params = reference("thesis_examples.toml")[THESIS_CAMS[name]]["params"]
    assert (PROJECTS / f"{name}.ocv").read_bytes() == packed(params)


@pytest.mark.parametrize("name", THESIS_CAMS)
def test_a_project_is_the_scene_that_was_made_from_its_table(name: str) -> None:
    text = import_project((PROJECTS / f"{name}.ocv").read_bytes(), name)
    made = parse_scene(text)
    written = camgeo.load(FIXTURES / "scenes" / f"{name}.toml").scene
    assert made.name == written.name
    assert made.rotation == written.rotation == -1
    assert made.linkage == written.linkage
    # The fixture states where the linkage moves the roller; it does not change the follower.
    assert made.follower == written.follower
    assert made.contact == written.contact
    phi = np.linspace(0.0, 2.0 * math.pi, 721)
    assert np.array_equal(made.plan.jet(phi), written.plan.jet(phi))


@given(
    st.lists(st.floats(0.1, 0.9), min_size=6, max_size=6),
    st.just(0.0) | st.floats(1e-3, 3.0) | st.floats(-3.0, -1e-3),
    st.floats(0.01, 9.0),
    st.lists(st.sampled_from((1.0, 2.0)), min_size=5, max_size=5),
)
def test_no_digit_is_lost(
    shares: list[float], stroke: float, step: float, answers: list[float]
) -> None:
    """Numbers of the scene, read by a TOML parser, are those of the project to the bit."""
    arm, crank, coupler, roller, x, y = shares
    numbers = dict(
        zip(
            ORDER,
            (
                *(10.25, 99.75, 0.0, 120.5, 129.5),
                *(80.0 + arm, stroke, 10.0 * crank, 60.0 + crank, 75.0 + coupler, 0.0, 0.0),
                *(8.0 + roller, -30.0 - x, 80.0 + y, 0.0, 45.0 + x, step),
            ),
            strict=True,
        )
    )
    data = struct.pack("<24d", *(numbers[name] for name in ORDER), *answers, 0.0)
    scene = tomllib.loads(import_project(data, "any"))
    assert scene["follower"]["pivot"] == [-numbers["x_A0"], -numbers["y_A0"]]
    assert scene["follower"]["arm"] == numbers["l_3"]
    assert scene["follower"]["base_radius"] == numbers["r_G"]
    assert scene["follower"]["roller_radius"] == numbers["r_R"]
    linkage = scene["linkage"]
    found = (linkage["crank"], linkage["coupler"], linkage["crank_deflection"])
    assert found == (numbers["l_sk"], numbers["l_4"], numbers["alpha_sk"])
    assert scene["motion"][1]["to"] == stroke
    assert [part.get("dwell", part.get("span")) for part in scene["motion"]] == [
        numbers[name] for name in ORDER[:5]
    ]
    assert scene["output"]["csv"]["step"] == step
    words = (linkage["crank_leans"], linkage["stroke_direction"], linkage["branch"])
    choices = (("away", "toward"), ("left", "right"), ("cw", "ccw"))
    assert words == tuple(
        pair[0 if answer == 1.0 else 1] for pair, answer in zip(choices, answers, strict=False)
    )
    assert linkage["mirrored"] == (answers[3] == 2.0)
    # The program uses the answer to question 25 only after "ja" to question 21.
    right = answers[4] == 2.0 and answers[0] == 1.0
    assert linkage["slider_side"] == ("right" if right else "left")


@pytest.mark.parametrize("place", range(1, 25))
@pytest.mark.parametrize("number", [math.nan, math.inf, -math.inf, -1e300])
def test_every_number_is_checked(place: int, number: float) -> None:
    (fault,) = refusal_by(project_numbers, changed(place, number)).faults
    name = FIELDS[place - 1].name
    assert fault.key == (f"number {place} ({name})" if name != "-" else f"number {place}")
    assert fault.value == repr(number)
    assert fault.message.startswith("must be ")


@pytest.mark.parametrize(
    ("place", "number", "message"),
    [
        (1, -1.0, "from 0 to 360"),
        (2, 0.0, "a move needs a span"),
        (6, 0.0, "a positive length"),
        (8, 90.1, "from -90 to 90"),
        (13, -7.0, "a positive length"),
        (18, 0.0, "from 0.001 to 90"),
        (19, 0.0, "1 for the first or 2 for the second"),
        (23, 1.5, "1 for the first or 2 for the second"),
        (24, 1.0, "another program wrote this"),
        (5, 59.0, "the spans add up to 359 degrees; they must add up to 360"),
    ],
)
def test_what_is_allowed_is_reported(place: int, number: float, message: str) -> None:
    with pytest.raises(SceneError, match=message):
        import_project(changed(place, number), "setzhub")


def test_all_faults_are_reported_at_once() -> None:
    data = bytearray(changed(1, -1.0))
    data[8 * 18 : 8 * 19] = struct.pack("<d", 3.0)
    refused = refusal_by(project_numbers, bytes(data), "my.ocv")
    assert [fault.key for fault in refused.faults] == [
        "number 1 (phi_H01)",
        "number 19 (Q21)",
    ]
    assert str(refused).startswith("my.ocv: 2 faults")


def test_what_the_program_makes_of_a_plan_that_does_not_add_up_is_reported() -> None:
    with pytest.raises(SceneError, match="ignores phi_H45 and rests for 60 degrees"):
        project_numbers(changed(5, 61.0))
    assert refusal_by(project_numbers, changed(1, 350.0)).faults[0].hint == ""


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", "the project is empty: opticurv empties a project"),
        (bytes(SIZE - 1), "192 bytes, 24 doubles; this file has 191"),
        (bytes(SIZE + 8), "192 bytes, 24 doubles; this file has 200"),
        (struct.pack(">24d", *struct.unpack("<24d", SETZHUB)), "big-endian"),
    ],
)
def test_another_size_or_order_of_bytes_is_refused(data: bytes, message: str) -> None:
    with pytest.raises(SceneError, match=message):
        project_numbers(data)


@pytest.mark.parametrize(
    ("place", "number", "key"),
    [(17, 500.0, "r_G"), (10, 9.0, "l_sk, l_4, alpha_sk, s_H"), (3, 1e-8, "phi_H23")],
)
def test_a_mechanism_that_does_not_exist_is_reported_in_terms_of_the_project(
    place: int, number: float, key: str
) -> None:
    data = changed(place, number)
    if place == 3:  # keep the sum
        data = data[:32] + struct.pack("<d", 80.0 - 1e-8) + data[40:]
    refused = refusal_by(import_project, data, "setzhub")
    assert key in [fault.key for fault in refused.faults]
    assert all(fault.line is None for fault in refused.faults)


def test_the_ranges_are_those_of_the_scene() -> None:
    known = schema()["$defs"]
    output = whole_schema()["properties"]["output"]["properties"]
    nodes = {
        "length": known["length"],
        "place": known["coordinate"],
        "rest": known["dwell"]["properties"]["dwell"],
        "move": known["span"],
        "deflection": known["slider-crank"]["properties"]["crank_deflection"],
        "step": output["csv"]["properties"]["step"],
    }
    for kind, (lowest, highest, _) in RANGES.items():
        if kind in nodes:
            assert (lowest, highest) == (nodes[kind]["minimum"], nodes[kind]["maximum"]), kind
    assert {field.kind for field in FIELDS} == {*nodes, "free", "choice", "unused"}
    keys = [field.key for field in FIELDS if field.key]
    assert len(keys) == len(set(keys)) == 20


@pytest.mark.parametrize(
    ("stem", "name"),
    [("setzhub", "setzhub"), ("Kurve 1.neu", "Kurve-1-neu"), ("§§", "opticurv"), ("", "opticurv"),
     ("a" * 200, "a" * 100)],
)  # fmt: skip
def test_names(stem: str, name: str) -> None:
    assert scene_name(stem) == name


def test_the_command_writes_a_scene_over_no_other_unless_it_is_told(
    tmp_path: Path, capsys: Capture
) -> None:
    project, scene = str(PROJECTS / "vorschub.ocv"), tmp_path / "v.toml"
    assert main(["import", project, "-o", str(scene)]) == 0
    assert "next: camgeo check" in capsys.readouterr().err
    first = scene.read_text(encoding="utf-8")
    assert camgeo.loads(first).findings
    scene.write_text("mine", encoding="utf-8")
    assert main(["import", project, "-o", str(scene)]) == 2
    assert scene.read_text(encoding="utf-8") == "mine"
    assert main(["import", project, "-o", str(scene), "--force"]) == 0
    assert scene.read_text(encoding="utf-8") == first


def test_an_answer_that_the_program_ignores_is_reported(tmp_path: Path, capsys: Capture) -> None:
    project = tmp_path / "v.ocv"
    project.write_bytes(changed(23, 2.0, "vorschub"))
    assert main(["import", str(project)]) == 0
    reported = capsys.readouterr()
    assert "question 25" in reported.err
    assert 'slider_side = "left"  # question 25: negativ; opticurv ignores it' in reported.out
    assert main(["import", str(PROJECTS / "setzhub.ocv")]) == 0
    assert "question 25" not in capsys.readouterr().err


@pytest.mark.parametrize("bad", [b"", bytes(SIZE), bytes(SIZE + 1)])
def test_the_command_writes_nothing_of_a_wrong_project(
    bad: bytes, tmp_path: Path, capsys: Capture
) -> None:
    project = tmp_path / "bad.ocv"
    project.write_bytes(bad)
    assert main(["import", str(project), "-o", str(tmp_path / "out" / "bad.toml")]) == 2
    assert "bad.ocv: " in capsys.readouterr().err
    assert main(["import", str(tmp_path / "none.ocv")]) == 2
    assert main(["import", str(tmp_path)]) == 2
    with pytest.raises(SystemExit):
        main(["import", str(project), "-o", str(project), "--force"])
    assert [path.name for path in tmp_path.iterdir()] == ["bad.ocv"]
