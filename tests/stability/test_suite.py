"""The suite: every case is as accurate as doubles allow, and a bad algorithm is detected."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from mpmath import mp

from camgeo.app.cli.main import COMMANDS
from camgeo.app.cli.main import main as camgeo
from camgeo.errors import GeometryError
from camgeo.kinematics.laws import make_law
from camgeo.kinematics.mechanism.linkages import SliderCrank, SliderDrivenCrank
from camgeo.kinematics.mechanism.rollers import OscillatingRoller, TranslatingRoller
from camgeo.numeric.arrays import ComplexArray, FloatArray
from tests.long_form import examples
from tests.mechanism.flat_faces import oscillating_flats, translating_flats
from tests.motion.exact_laws import HALVES
from tests.reference import reference
from tests.stability import cams, faces, suite
from tests.stability.__main__ import known_names, main
from tests.stability.cams import CamSpec, cases_of
from tests.stability.exact_cam import AnyLinkage
from tests.stability.measure import Case, Reading, measure
from tests.stability.quick import CASES, quick
from tests.stability.suite import GROUPS, LIMIT, table
from tests.strategies import (
    attack,
    four_bars,
    oscillating_rollers,
    signs,
    slider_cranks,
    slider_driven_cranks,
    translating_rollers,
)


def spec(name: str) -> CamSpec:
    return next(each for each in cams.specs() if each.name == name)


@pytest.mark.parametrize("group", GROUPS)
def test_no_digits_are_lost_that_the_inputs_have(group: str) -> None:
    readings = [each for each in quick() if each.group == group]
    assert readings
    assert [each for each in readings if each.ratio > LIMIT] == []


@pytest.mark.parametrize("name", ["HC01", "HC02", "HC03", "HC04", "HC05", "HC06", "HC11", "HC12",
                                  "HC13", "HC14", "HC15", "HC17", "HC18", "HC19", "HC20b", "HC21b",
                                  "HC21c", "HC22", "HC22b", "HC23", "HC26", "HC27",
                                  "HC28"])  # fmt: skip
def test_the_hard_cases_are_among_them(name: str) -> None:
    assert any(case.name.startswith(name) for case in CASES)
    assert name in {case["id"] for case in reference("hard_cases.json")}


# A bad algorithm is seen --------------------------------------------------------------------------


def largest_ratio(name: str, quantity: str, bad: FloatArray | ComplexArray) -> float:
    """Of a quantity of a cam's rise with other values for it."""
    (case, *_) = cases_of(spec(name))
    index = case.quantities.index(quantity)

    def found(phi: FloatArray) -> tuple[FloatArray | ComplexArray, ...]:
        columns = list(case.found(phi))
        columns[index] = bad
        return tuple(columns)

    worsened = measure(replace(case, found=found))
    return max(each.ratio for each in worsened if each.quantity == quantity)


def test_an_angle_by_its_cosine_is_seen() -> None:
    """HC12: acos of the scalar product is off by 1e-8 near 90 degrees less mu = 0."""
    name, quantity = "HC12 huge base circle", "pressure angle"
    curve, phi = spec(name).curve, np.array(cases_of(spec(name))[0].places)
    relative = curve.relative_jet(phi, order=1)
    bad = np.arccos(np.minimum(np.abs(relative.u) / curve.speed(relative), 1.0))
    assert largest_ratio(name, quantity, curve.pressure_angle(phi)) <= LIMIT
    assert largest_ratio(name, quantity, bad) > 1e3 * LIMIT


# What is run and reported -------------------------------------------------------------------------


def made_up(quantity: str, case: str, error: float, conditioning: float) -> Reading:
    return Reading(quantity, "cams", case, 1.0, 1.0, error, conditioning)


def test_the_table_has_the_largest_ratio_first() -> None:
    readings = [
        made_up("a", "x", 100.0, 200.0),
        made_up("a", "y", 3.0, 0.1),
        made_up("b", "x", math.inf, 1.0),
        made_up("c", "x", 0.0, 0.0),
    ]
    b, a, c = table(readings)
    assert (b.quantity, b.within_limit) == ("b", False)
    assert (a.largest_error.case, a.largest_ratio.case) == ("x", "y")
    assert (a.count, a.within_limit) == (2, True)
    assert c.largest_ratio.ratio == 0.0


# The measure itself, on numbers whose error and conditioning are known -------------------------

Found = Callable[[FloatArray], FloatArray | ComplexArray]


def reading(found: Found, exact: Callable[..., Any], place: float, *parameters: float) -> Reading:
    def both(places: FloatArray) -> tuple[FloatArray | ComplexArray]:
        return (found(places),)

    case = Case("laws", "known", ("value",), (place,), parameters, both, lambda *x: (exact(*x),))
    (only,) = measure(case)
    return only


def up_to_one(x: Any) -> Any:
    if x > 1:
        raise GeometryError("beyond 1")
    return x


@pytest.mark.parametrize(
    ("found", "exact", "inputs", "error", "conditioning"),
    [
        # A double off by whole steps between neighbours: half an ulp moves it by half an ulp.
        *(
            (lambda x, k=k: x + k * np.spacing(x), lambda x: x, (place,), k, 0.5)
            for k in (0, 1, 3)
            for place in (1.0, 1.9, 3e-300, 1e200)
        ),
        # x - 1 beside 1: half of 2^-52 against 2^-20 * 2^-52, twice: 2^20 ulp for x and 1.
        (lambda x: x - 1.0, lambda x, one: x - one, ((1.0 + 2.0**-20), 1.0), 0.0, 2.0**20),
        # A vector is measured by its length, 5.
        (
            lambda _: np.array([(3.0 + 4.0j + 2.0j * math.ulp(5.0))]),
            lambda x: x * (3 + 4j),
            (1.0,),
            2.0,
            0.625,
        ),
        (lambda x: up_to_one(x + 1.0), lambda x: x, (1.0,), math.inf, 0.5),
        # At an end of its range an input moves the other way.
        (lambda x: x, up_to_one, (1.0,), 0.0, 0.5),
    ],
)
def test_errors_and_conditioning_that_are_known(
    found: Found, exact: Any, inputs: tuple[float, ...], error: float, conditioning: float
) -> None:
    known = reading(found, exact, *inputs)
    assert (known.error, known.conditioning) == (error, conditioning)
    assert known.ratio == error / max(1.0, conditioning)
    assert known.value == float(abs(exact(*inputs)))


def test_where_a_value_passes_zero_the_yardstick_is_what_the_inputs_leave() -> None:
    """sin at the double next to pi: no ulp of 1.2e-16 is meant, but none of 2.2e-16 either."""
    known = reading(lambda x: np.zeros(1), mp.sin, math.pi)
    left = math.ulp(math.pi) / 2.0
    assert known.error == pytest.approx(math.sin(math.pi) / math.ulp(left))
    assert known.ratio == pytest.approx(math.sin(math.pi) / left, rel=1e-9)
    assert known.ratio < 1.0


def test_an_input_without_room_is_reported() -> None:
    def only_one(x: Any) -> Any:
        if x != 1:
            raise GeometryError("not 1")
        return x

    with pytest.raises(GeometryError, match=r"known: no value of input 0 near 1\.0"):
        reading(lambda x: x, only_one, 1.0)


# The suite as a program: table, JSON, picture and exit code ---------------------------------------

Capture = pytest.CaptureFixture[str]

FEW = ["--only", "scca, b 0.3, d 0.2", "place of a cusp", "--quick"]
"""A law and the cusps: what is quick to run, with places of both kinds."""


def of_curvature(error: float, conditioning: float = 1.0, quantity: str = "curvature") -> Reading:
    return Reading(quantity, "cams", "made up", math.pi, 0.25, error, conditioning)


@pytest.fixture
def found(monkeypatch: pytest.MonkeyPatch) -> list[Reading]:
    """The readings of the suite in a test that runs none of it; filled by the test."""
    readings: list[Reading] = []
    monkeypatch.setattr(suite, "run", lambda *_, **__: tuple(readings))
    monkeypatch.setattr(suite, "all_cases", tuple)
    return readings


@pytest.fixture(autouse=True)
def _cases_made_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Those of the suite, which take longer to make than commands to look through."""
    monkeypatch.setattr(suite, "all_cases", lambda: CASES)


def test_the_command_says_where_it_is(capsys: Capture) -> None:
    assert "stability" not in COMMANDS
    assert camgeo(["stability", "--quick"]) == 2
    assert "python -m tests.stability" in capsys.readouterr().err


def test_the_table(capsys: Capture) -> None:
    assert main(FEW) == 0
    captured = capsys.readouterr()
    assert captured.err == ""
    lines = captured.out.splitlines()
    assert lines[0].split() == ["quantity", "values", "error", "conditioning", "at", "ratio"]
    quantities = {line.split("  ")[0] for line in lines[1 : lines.index("")]}
    assert quantities == {"f", "1 - f", "f'", "f''", "f'''", "place of a cusp"}
    assert lines[-1] == "limit of the ratio 64: kept"
    cusp = next(line for line in lines if line.startswith("place of a cusp"))
    assert "too large" in cusp
    assert " deg " in cusp


def test_json_has_the_same(capsys: Capture) -> None:
    assert main(["--only", FEW[1], "--quick", "--json"]) == 0
    document: dict[str, Any] = json.loads(capsys.readouterr().out, parse_constant=pytest.fail)
    assert (document["kept"], document["quick"], document["limit"]) == (True, True, suite.LIMIT)
    by_name = {row["quantity"]: row for row in document["quantities"]}
    assert by_name["f"]["values"] == 2
    assert by_name["f"]["largest_error"]["case"] == FEW[1]
    assert 0.0 < by_name["f"]["largest_error"]["at"]["z"] < 1.0


def test_a_broken_limit_is_reported(found: list[Reading], capsys: Capture) -> None:
    found += [
        of_curvature(65.0),
        of_curvature(100.0, 2.0),
        of_curvature(3.0, quantity="pitch curve Z"),
    ]
    assert main([]) == 1
    out = capsys.readouterr().out
    assert "limit of the ratio 64: broken" in out
    assert "  curvature: ratio 65 at made up, 180 deg, error 65, conditioning 1" in out


@pytest.mark.parametrize(
    ("name", "found"),
    [
        ("HC14", {f"HC14 return in 1e-6 degrees, {way}" for way in ("rise", "return")}),
        ("curvature", {"curvature"}),
        ("extremes", {"extremes"}),
    ],
)
def test_names_and_beginnings_of_cases(name: str, found: set[str]) -> None:
    assert known_names([name], suite.names(CASES)) == found


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--only", "curvatur e"], "there is no 'curvatur e'; did you mean \"curvature\"?"),
        (["-o", "stability.bmp"], "'stability.bmp' must end in one of .png, .svg, .pdf"),
    ],
)
def test_wrong_words(words: list[str], message: str, capsys: Capture) -> None:
    with pytest.raises(SystemExit) as end:
        main(words)
    assert end.value.code == 2
    assert message in capsys.readouterr().err


# The picture --------------------------------------------------------------------------------------


def test_the_picture_is_written_next_to_the_table(
    found: list[Reading], tmp_path: Path, capsys: Capture
) -> None:
    found += [
        of_curvature(0.0, 0.0),
        of_curvature(3.0, 0.5),
        of_curvature(2e15, 8e15, "curvature slope"),
        of_curvature(math.inf, 1.0, "Z'"),
    ]
    target = tmp_path / "stability.svg"
    assert main(["-o", str(target)]) == 1
    captured = capsys.readouterr()
    assert captured.out.startswith("quantity")
    assert captured.err == f"{target}: 2 points\n"
    assert target.read_bytes().startswith(b"<?xml")


# Cams that are not in the suite -------------------------------------------------------------------
few = settings(attack, max_examples=examples(4, long=6))

SPANS = (
    ("30", "100", "40", "120", "70"),
    ("0", "20", "0", "330", "10"),
    ("90", "90", "1", "1", "178"),
)


@st.composite
def specs(draw: st.DrawFn) -> CamSpec:
    """A cam with a stroke from next to nothing to 20 mm or 0.3 rad, and two places in each move."""
    share = 10.0 ** -draw(st.floats(0.0, 8.0))
    sliding = draw(st.booleans())
    name = draw(st.sampled_from(tuple(HALVES)))
    # Behind lambda the lift is the stroke less what is left: it keeps the stroke's digits only.
    inflection = draw(st.floats(0.1, 0.9))
    borders = np.array([inflection, *make_law(name, "R-R", inflection=inflection).borders])
    shares = [draw(places()) for _ in range(4)]
    # At a border itself a rounded place may lie on either side of the jump.
    assume(all(np.min(np.abs(borders - share)) > 1e-9 for share in shares))
    return CamSpec(
        name="random",
        spans=draw(st.sampled_from(SPANS)),
        stroke=share * (20.0 if sliding else 0.3),
        follower=draw(translating_rollers(20.0)) if sliding else draw(oscillating_rollers(0.3)),
        rotation=draw(signs()),
        law=name,
        inflection=inflection,
        rise=tuple(shares[:2]),
        back=tuple(shares[2:]),
    )


def places() -> st.SearchStrategy[float]:
    """A share of a move; 1e-6 rad off its ends at least."""
    near = st.floats(1.0, 5.0).map(lambda exponent: 10.0**-exponent)
    return st.one_of(st.floats(0.01, 0.99), near, near.map(lambda share: 1.0 - share))


@settings(attack, max_examples=examples(8, long=60))
@given(spec=specs())
def test_random_cams_are_as_good_as_doubles_allow(spec: CamSpec) -> None:
    for case in cases_of(spec):
        poor = [each for each in measure(case) if each.ratio > LIMIT]
        assert poor == []


@st.composite
def flat_specs(draw: st.DrawFn) -> CamSpec:
    """A cam under a flat face, convex or not."""
    share = 10.0 ** -draw(st.floats(0.0, 8.0))
    sliding = draw(st.booleans())
    return CamSpec(
        name="random",
        spans=draw(st.sampled_from(SPANS[:2])),
        stroke=share * (20.0 if sliding else 0.3),
        follower=draw(translating_flats()) if sliding else draw(oscillating_flats()),
        rotation=draw(signs()),
        rise=(draw(places()), draw(places())),
    )


@few
@given(spec=flat_specs())
def test_random_flat_faces_are_as_good_as_doubles_allow(spec: CamSpec) -> None:
    for case in faces.cases_of(spec):
        poor = [each for each in measure(case) if each.ratio > LIMIT]
        assert poor == []


@settings(attack, max_examples=examples(6, long=12))
@given(
    linkage=st.one_of(slider_cranks(), four_bars(), slider_driven_cranks()),
    share=st.floats(0.0, 8.0),
    rise=st.tuples(places(), places()),
    rotation=signs(),
)
@example(
    linkage=SliderCrank(109.4, 62.0, 0.0349, False, 1, -1, -1, mirrored=True),
    share=0.57, rise=(0.99999, 0.5), rotation=1,
)  # fmt: skip
def test_random_linkages_are_as_good_as_doubles_allow(
    linkage: AnyLinkage, share: float, rise: tuple[float, float], rotation: int
) -> None:
    """Behind a guide that is long enough, or a rocker."""
    follower = (
        TranslatingRoller(400.0, 10.0, 12.0)
        if isinstance(linkage, SliderDrivenCrank)
        else OscillatingRoller(-100.0 + 0j, 80.0, 120.0, 5.0, 1, None)
    )
    spec = CamSpec("random", SPANS[0], 0.6 * 10.0**-share, follower, linkage, rotation, rise=rise)
    try:
        (case,) = cases_of(spec)
    except GeometryError:
        assume(False)
    poor = [each for each in measure(case) if each.ratio > LIMIT]
    assert poor == []
