"""Texts of scenes in inches: the same words as in mm, and the same lengths."""

from __future__ import annotations

import io
import re
from collections.abc import Iterator
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from typing import Any

import pytest

import camgeo
from camgeo.app.cli.main import main
from camgeo.app.designing.children import Job
from camgeo.app.designing.work import run
from camgeo.design.judged_part import PartAssessment
from camgeo.errors import GeometryError, SceneError
from camgeo.scene.scene import load_scene
from tests.answers.documents import FIXTURES
from tests.inches import in_inches
from tests.long_form import LONG

NUMBER = r"[-+]?\d+(?:,\d{3})*(?:\.\d+)?(?:e[-+]?\d+)?"

MEASURE = re.compile(
    rf"(?<![\w.])({NUMBER}(?:(?:, | to | and | x |, [XYZ] ){NUMBER})*\)?) ((?:g |kg )?)(mm|inch)"
    r"(?:\^(\d))?"
)

STATES_MM = re.compile(r"(?<!/)\bmm\b(?!\")")

NO_SENTENCES = ("unit", "text", "bytes", "certificate")

SCENES = [
    "scenes/plate_translating", "effects/lever",
    *(["scenes/tappet", "scenes/setzhub", "scenes/conjugate_lever",
       "effects/valve_train", "effects/yoke", "refused/global_undercut",
       "refused/undercut_tappet", "milling/bolt_circle", "scenes/constant_breadth",
       "scenes/feed", "effects/press"]
      if LONG else []),
]  # fmt: skip


def printed(*words: str) -> str:
    """What a command prints."""
    found = io.StringIO()
    with redirect_stdout(found), redirect_stderr(found):
        assert main(words) in (0, 1)
    return found.getvalue()


def both(scene: Path, folder: Path) -> Path:
    """The scene in inches, in a file of the same name in another folder."""
    made = folder / scene.name
    made.write_text(in_inches(load_scene(scene)), encoding="utf-8")
    return made


def in_words(text: str) -> list[str]:
    """The lines without their numbers and units, and without the blanks between columns."""
    return [
        re.sub(r"[ -]+", " ", re.sub(NUMBER, "#", re.sub(r"\b(mm|inch)\b", "@", line)))
        for line in text.splitlines()
    ]


def unit_in_last_place(number: str) -> float:
    mantissa, _, exponent = number.replace(",", "").partition("e")
    return 10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2]))


def compare(mm: str, inch: str) -> None:
    """Every length of `inch` is that of `mm`, to the digits of both."""
    assert len(mm.splitlines()) == len(inch.splitlines())
    for one, other in zip(mm.splitlines(), inch.splitlines(), strict=True):
        pairs = list(zip(MEASURE.finditer(one), MEASURE.finditer(other), strict=True))
        for a, b in pairs:
            assert (a[2], a[3], b[2], b[3], a[4]) == (a[2], "mm", a[2], "inch", b[4])
            scale = 25.4 ** int(a[4] or 1)
            numbers = zip(re.findall(NUMBER, a[1]), re.findall(NUMBER, b[1]), strict=True)
            for x, y in numbers:
                off = 0.6 * unit_in_last_place(x) / scale + 1.1 * unit_in_last_place(y)
                # What is 0 but for rounding is not the same after a conversion.
                off += 1e-12
                right = float(x.replace(",", "")) / scale
                assert float(y.replace(",", "")) == pytest.approx(right, abs=off), (one, other)


@pytest.mark.parametrize("name", SCENES)
def test_a_check_in_inches_says_the_same(name: str, tmp_path: Path) -> None:
    scene = FIXTURES / f"{name}.toml"
    mm, inch = printed("check", str(scene)), printed("check", str(both(scene, tmp_path)))
    assert re.search(r"(?<!/)\bmm\b", inch) is None
    assert in_words(mm) == in_words(inch)
    compare(mm, inch)


def told(document: Any) -> Iterator[str]:
    """The texts of a document, but for units of its numbers and names of keys."""
    if isinstance(document, dict):
        for key, value in document.items():
            yield from told(value) if key not in NO_SENTENCES else ()
    elif isinstance(document, list):
        for value in document:
            yield from told(value)
    elif isinstance(document, str) and document != "mm":
        yield document


@pytest.mark.parametrize(
    ("kind", "arguments"),
    [
        ("findings", {}), ("build", {"formats": ["csv"]}), ("curves", {}),
        ("size", {}), ("size", {"transmission_angle": 89.0}),
        ("change", {"edits": {"part.bore": 50.0}}), ("change", {"edits": {"output.tolerance": 5}}),
    ],
)  # fmt: skip
def test_the_designer_tells_inches(kind: str, arguments: dict[str, Any], tmp_path: Path) -> None:
    made = both(FIXTURES / "scenes/plate_translating.toml", tmp_path)
    found = run(Job(kind, made.read_text("utf-8"), arguments=arguments))
    assert [each for each in told(found) if STATES_MM.search(each)] == []


def test_errors_are_in_inches_and_tell_the_key_as_it_is_stated(tmp_path: Path) -> None:
    made = both(FIXTURES / "scenes/plate_translating.toml", tmp_path)
    scene = load_scene(made)
    wide = camgeo.Design(scene.with_values({"part.bore": 4.0, "part.keyway": None}))
    (refused,) = PartAssessment.from_disc(wide.disc).findings
    assert "part.bore = 4" in refused.sentence
    assert "reaches 2 inch" in refused.sentence
    assert " mm" not in refused.sentence
    with pytest.raises(SceneError, match=r"output.tolerance = 1: must be .* inch") as caught:
        scene.with_values({"output.tolerance": 1})
    assert " mm" not in str(caught.value)
    with pytest.raises(GeometryError, match="inch") as raised:
        wide.write(tmp_path, ["stl"])
    assert " mm" not in str(raised.value)
