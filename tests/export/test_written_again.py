"""Files that name the running version are written again: what differs is told with its place."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import camgeo
from camgeo.app.answers.verify import Against, Verdict, Wanted, first_difference, verify_files
from camgeo.design.design import Design
from camgeo.design.verify import Check, Verifier
from camgeo.design.writing import CERTIFICATE, make_files
from camgeo_export.reading import TOKEN
from camgeo_export.verify.dxf import VERIFIER as DXF
from camgeo_export.verify.gcode import VERIFIER as GCODE
from camgeo_export.verify.step import VERIFIER as STEP
from camgeo_export.verify.stl import FACET, PREFIX
from camgeo_export.verify.stl import VERIFIER as STL
from camgeo_export.verify.svg import VERIFIER as SVG
from camgeo_export.verify.threemf import MODEL_PATH
from camgeo_export.verify.threemf import VERIFIER as THREEMF
from tests.long_form import examples
from tests.packages import repacked

SCENES = Path(__file__).resolve().parents[2] / "fixtures" / "scenes"

TOLERANCE = 0.05

VERIFIERS: dict[str, Verifier] = {
    "vorschub.dxf": DXF,
    "vorschub-drawing.dxf": DXF,
    "vorschub.ngc": GCODE,
    "vorschub.stl": STL,
    "vorschub.3mf": THREEMF,
    "vorschub.step": STEP,
    "vorschub.cut.svg": SVG,
}

TEXTS = [name for name in VERIFIERS if not name.endswith(("stl", "3mf"))]


@cache
def design(name: str = "vorschub") -> Design:
    return camgeo.load(SCENES / f"{name}.toml").with_output({"fit": "fast"})


@cache
def files(tolerance: float = TOLERANCE) -> dict[str, bytes]:
    formats = ("dxf", "gcode", "stl", "3mf", "step", "cut-svg", "drawing")
    contents, _ = make_files(design().discs, formats, tolerance)
    return contents


def verdict_on(path: Path, data: bytes, of: Design | None = None) -> Verdict:
    """Of a file with these bytes; its scene states another tolerance than files do."""
    path.write_bytes(data)
    against = Against((of or design()).discs, 0.5 * TOLERANCE)
    (verdict,) = verify_files((path,), lambda *_: against, Wanted(TOLERANCE))
    return verdict


def again(verdict: Verdict) -> Check:
    (check,) = (each for each in verdict.checks if each.name == "written again")
    return check


def certify(folder: Path, name: str, data: bytes) -> None:
    """A certificate for these bytes."""
    document = json.loads(files()[CERTIFICATE])
    (record,) = (each for each in document["files"] if each["file"] == name)
    record["sha256"] = hashlib.sha256(data).hexdigest()
    (folder / CERTIFICATE).write_text(json.dumps(document))


# Tokens -------------------------------------------------------------------------------------------


def in_text(text: str, number: int) -> tuple[str, int]:
    """A text with one of its tokens changed, and the line of that."""
    found = list(TOKEN.finditer(text))
    token = found[number % len(found)]
    start, end = token.span()
    try:
        new = repr(1.01 * float(token[0]) + 0.03)
    except ValueError:
        new = f"{token[0]}x"
    return text[:start] + new + text[end:], text[:start].count("\n") + 1


@pytest.mark.parametrize("name", TEXTS)
@given(number=st.integers(0, 10**9))
@settings(max_examples=examples(12, long=200))
def test_a_changed_token_is_told_with_its_line(name: str, number: int) -> None:
    good = files()[name]
    text, line = in_text(good.decode(), number)
    difference = first_difference(VERIFIERS[name], text.encode(), good)
    assert difference is not None
    assert difference.place == f"line {line}"


@given(number=st.integers(0, 10**9))
@settings(max_examples=examples(12, long=200))
def test_a_changed_token_of_a_package_is_told_with_its_element(number: int) -> None:
    good = files()["vorschub.3mf"]
    line = 0

    def change(path: str, content: str) -> str:
        nonlocal line
        if path != MODEL_PATH:
            return content
        text, line = in_text(content.replace("<", "\n<"), number)
        return text

    changed = repacked(good, change)
    if THREEMF.origin(changed).damage:
        return
    difference = first_difference(THREEMF, changed, good)
    assert difference is not None
    # Elements begin on lines of their own here, the first two on the third of them.
    assert difference.place in {f"{MODEL_PATH}, element {line - k}" for k in (1, 2)}


@given(number=st.integers(0, 10**9), place=st.integers(0, 12))
@settings(max_examples=examples(12, long=200))
def test_a_changed_field_of_a_facet_is_told_with_its_number(number: int, place: int) -> None:
    """Its normal, its corners, its attribute."""
    good = files()["vorschub.stl"]
    facets: Any = np.frombuffer(good, FACET, offset=PREFIX).copy()
    facet = facets[number % len(facets)]
    if place == 12:
        facet["attribute"] += 1
    else:
        field = facet["normal"] if place < 3 else facet["corners"].reshape(-1)
        field[place % 3 if place < 3 else place - 3] += 0.01
    difference = first_difference(STL, good[:PREFIX] + facets.tobytes(), good)
    assert difference is not None
    assert difference.place == f"facet {number % len(facets) + 1}"


def last_bit_of_a_normal(data: bytes) -> bytes:
    """Single precision has no more."""
    return data[:PREFIX] + bytes([data[PREFIX] ^ 1]) + data[PREFIX + 1 :]


def test_a_signalling_nan_is_a_difference() -> None:
    """Its conversion to double precision raises the processor's flag of an invalid operation."""
    good = files()["vorschub.stl"]
    changed = good[: PREFIX + 12] + b"\x01\x00\xa0\x7f" + good[PREFIX + 16 :]
    difference = first_difference(STL, changed, good)
    assert difference is not None
    assert difference.place == "facet 1"


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("vorschub.dxf", lambda data: data.replace(b"\n", b"\r\n")),
        ("vorschub.ngc", lambda data: data.replace(b" ", b"  ").replace(b"\nG1", b"\n\nG1")),
        ("vorschub.3mf", partial(repacked, change=lambda _, content: content)),
        ("vorschub.step", lambda data: data.replace(b",", b" , ")),
        # The last bit of a normal: single precision has no more.
        ("vorschub.stl", last_bit_of_a_normal),
    ],
)
def test_blanks_and_last_digits_are_no_difference(
    name: str, change: Callable[[bytes], bytes]
) -> None:
    changed = change(files()[name])
    assert changed != files()[name]
    assert first_difference(VERIFIERS[name], changed, files()[name]) is None


def test_a_long_number_is_read_once() -> None:
    """With a square of its length this would not end."""
    assert first_difference(DXF, b"9" * 10**6 + b"x", b"8" * 10**6 + b"x") is not None


@pytest.mark.parametrize(
    ("one", "other", "same"),
    [
        (b"1000.000001", b"1000.0", True),
        (b"1000.000002", b"1000.0", False),
        (b"0.0000000009", b"0", True),
        (b"0.0000000011", b"0", False),
        (b"X2.5", b"Y2.5", False),
        (b"X2.50", b"X2.5", True),
        (b"1e999", b"2e999", False),
        (b"G1 X2", b"G1", False),
        (b"G1", b"G1 X2", False),
    ],
)
def test_numbers_agree_within_a_share_of_their_size(one: bytes, other: bytes, same: bool) -> None:
    assert (first_difference(DXF, one, other) is None) == same


# Verdicts -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", VERIFIERS)
def test_what_is_built_is_the_same_and_is_measured(name: str, tmp_path: Path) -> None:
    """By whatever name, though a mesh states its tolerance in its certificate alone."""
    data = files()[name]
    certify(tmp_path, name, data)
    verdict = verdict_on(tmp_path / name, data)
    assert (again(verdict).value, again(verdict).ok) == ("the same", True)
    assert verdict.passed
    assert verdict.deviation is not None
    renamed = again(verdict_on(tmp_path / f"other-{name}", data))
    assert renamed.ok == (None if name.endswith("stl") else True)


def test_a_difference_fails_unless_the_certificate_vouches_for_it(tmp_path: Path) -> None:
    """A feed, which nothing measures."""
    path = tmp_path / "vorschub.ngc"
    data = files()[path.name]
    changed = data.replace(b"F100", b"F101", 1)
    line = data[: data.index(b"F100")].count(b"\n") + 1
    verdict = verdict_on(path, changed)
    assert again(verdict).ok is False
    assert again(verdict).note == f"line {line}: 'F101' where camgeo writes 'F100'"
    assert [each.name for each in verdict.checks if each.ok is False] == ["written again"]
    certify(tmp_path, path.name, changed)
    verdict = verdict_on(path, changed)
    assert verdict.passed
    assert again(verdict).note.endswith("'F100'; certificate.json vouches for the file")
    certify(tmp_path, path.name, data)
    assert again(verdict_on(path, changed)).ok is False
    assert again(verdict_on(path, data[: data.rindex(b"M2")])).note.endswith(
        "the end where camgeo writes 'M2'"
    )


def test_a_mesh_of_unknown_tolerance_may_be_another_one(tmp_path: Path) -> None:
    path = tmp_path / "vorschub.stl"
    check = again(verdict_on(path, files()[path.name]))
    assert check.ok is None
    assert check.note.endswith("its tolerance is not known")
    assert again(verdict_on(path, files(0.5 * TOLERANCE)[path.name])).ok is True


def test_files_of_other_versions_and_scenes_are_only_measured(tmp_path: Path) -> None:
    path = tmp_path / "vorschub.dxf"
    data = files()[path.name]
    version = design().disc.version
    verdict = verdict_on(path, data.replace(f"\n{version}\n".encode(), b"\n0.0.9\n", 1))
    assert again(verdict).note == "it is of camgeo 0.0.9: only measured"
    assert verdict.passed
    verdict = verdict_on(path, data, design("setzhub"))
    assert again(verdict).note == "it is not of this scene: only measured"
    assert not verdict.passed
    foreign = data.replace(b"\ncamgeo\n", b"\nother\n", 1)
    assert "written again" not in {each.name for each in verdict_on(path, foreign).checks}


def test_a_scene_that_cannot_be_written_is_a_difference(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refused(*_: object) -> None:
        raise camgeo.GeometryError("there is no room")

    monkeypatch.setattr("camgeo_export.dxf.writer.DxfWriter.write", refused)
    check = again(verdict_on(tmp_path / "vorschub.dxf", files()["vorschub.dxf"]))
    assert check.ok is False
    assert check.note == "the scene cannot be written: there is no room"


def test_each_file_of_a_set_is_compared_with_its_own(tmp_path: Path) -> None:
    """Both discs of a pair, under other names too: the nearest of those that there are."""
    pair = design("conjugate_lever")
    contents, _ = make_files(pair.discs, ("dxf",), TOLERANCE)
    del contents[CERTIFICATE]
    assert len(contents) == 2
    for number, (name, data) in enumerate(contents.items()):
        for path in (tmp_path / name, tmp_path / f"{number}.dxf"):
            assert again(verdict_on(path, data, pair)).value == "the same"
        changed = data.replace(b"\nEOF", b"\nEOFF")
        assert "'EOFF' where" in again(verdict_on(tmp_path / name, changed + b"EOF", pair)).note
