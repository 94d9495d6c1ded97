"""What holds for every law of every family and task: a family is swept in by being registered.

Two limits, both of the task of the laws and not of what they happen to reach:

- SCALED: an error of f, 1 - f, f' or f'' is at most 1e-15, of f''' 1e-14, of the largest value of
  that quantity over the law.
- LIMIT, POLYNOMIAL_LIMIT: where f never falls, f up to z = 1/2 and 1 - f from there on are right to
  so many ulp, however small they are.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from itertools import product
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mpmath import mp, mpf

from camgeo.errors import GeometryError
from camgeo.kinematics.laws import ALIASES, FAMILIES, find_family, make_law
from camgeo.kinematics.laws.law import Law, characteristic
from camgeo.kinematics.laws.pulse import x_minus_sin
from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.extremes import Extreme
from tests.long_form import examples
from tests.motion.exact_laws import (
    DIGITS,
    Number,
    Pieces,
    exact,
    exact_pieces,
    ulps,
    values_of,
    worst_ulps,
)
from tests.reference import law_cases, law_of
from tests.strategies import (
    FAMILY_TASKS,
    attack,
    family_laws,
    family_terms,
    inflections,
    places,
)

EPS = 2.0**-52

LIMIT = 8.0
"""ulp. A result takes about six roundings, the most in the cube of x - sin x: z / factor, times pi,
squared, times x, divided by 6, times the series, each half a unit, some of them doubled."""

POLYNOMIAL_LIMIT = 64.0
"""ulp, of polynomials with given boundary values: their terms may have either sign."""

SCALED = (1e-15, 1e-15, 1e-15, 1e-15, 1e-14)
"""Of f, 1 - f, f', f'', f''', over their largest magnitudes."""

SHARP = ("polynomial-345", "inclined-sine", "modified-trapezoid", "modified-sine", "simple-sine")
"""Families from rest to rest whose f' and f'' keep all digits near their zeros as well."""

CASES = law_cases()
by_task = pytest.mark.parametrize(
    ("name", "task"), FAMILY_TASKS, ids=[f"{name} {task}" for name, task in FAMILY_TASKS]
)
by_family = pytest.mark.parametrize("name", FAMILIES)
many = settings(attack, max_examples=examples(6, long=150))
few = settings(attack, max_examples=examples(4, long=60))
"""Of each of fifteen families: what they have in common is drawn sixty times."""


def ulp_limit(name: str) -> float:
    """The limit for f and 1 - f of a family, in ulp."""
    free = name in ("polynomial", "polynomial-5", "polynomial-7")
    return POLYNOMIAL_LIMIT if free else LIMIT


def pieces_of(law: Law) -> Pieces:
    """The law as the guideline has it."""
    return exact_pieces(law.name, law.task, law.parameters)


@cache
def scales(law: Pieces) -> tuple[float, ...]:
    """Largest |f|, |1 - f|, |f'|, |f''|, |f'''| over 5 places of each piece, 17 of a single one.

    Over a quarter of a sine all of them are monotonous, so the ends would do; of a polynomial it is
    at most the truth.
    """
    steps = 16 if len(law) == 1 else 4
    values = [
        values_of(piece, piece.start + (piece.end - piece.start) * share / steps)
        for piece in law
        for share in range(steps + 1)
    ]
    return tuple(float(max(map(abs, column))) for column in zip(*values, strict=True))


def values_at(law: Law, z: float) -> tuple[float, ...]:
    """f, 1 - f, f', f'', f''' of camgeo."""
    place = np.array([z])
    f, *derivatives = law(place)
    return (f[0], law.complement(place)[0], *(value[0] for value in derivatives))


def candidates(law: Pieces, z: float) -> list[tuple[Number, ...]]:
    """The true values at z, of the piece it is in and of any that begins or ends 2^-52 away: there
    the border itself is rounded, and either formula may hold beyond it."""
    with mp.workdps(DIGITS):
        close = [
            piece for piece in law if piece.start - mpf(EPS) <= z and z <= piece.end + mpf(EPS)
        ]
        return [values_of(piece, z) for piece in close]


def errors(found: tuple[float, ...], true: tuple[Number, ...]) -> list[float]:
    """Absolute errors of the five values."""
    with mp.workdps(DIGITS):
        return [float(abs(mpf(a) - b)) for a, b in zip(found, true, strict=True)]


def excess(found: tuple[float, ...], law: Pieces, z: float) -> float:
    """The largest of the errors of the values at z in units of SCALED; at most 1 if all is well."""
    sizes = scales(law)
    return min(
        max(
            error / (unit * size) if error else 0.0
            for error, unit, size in zip(errors(found, true), SCALED, sizes, strict=True)
        )
        for true in candidates(law, z)
    )


# Against the values of the reference -----------------------------------------------------------


@pytest.mark.parametrize("case", CASES, ids=[case["id"] for case in CASES])
def test_borders_are_where_the_formula_changes_and_have_all_jumps(case: dict[str, Any]) -> None:
    """All jumps of f'' and f''' are borders; further ones are where the next derivative jumps."""
    law = law_of(case)
    inner = case["borders"][1:-1]
    jumps = [
        float(border["z"])
        for border in inner
        if any(border[f"f{order}_left"] != border[f"f{order}_right"] for order in (2, 3))
    ]
    for z in jumps:
        assert min(abs(z - border) for border in law.borders) <= 2.0 * EPS
    for border in law.borders:
        assert min(abs(float(entry["z"]) - border) for entry in inner) <= 2.0 * EPS


# Against the printed formulas at 100 digits ---------------------------------------------------


@by_family
@many
@given(data=st.data())
def test_values_anywhere(name: str, data: st.DataObject) -> None:
    """Any parameters, lambda and c as near as 1e-6 to their limits, z as near as 1e-16 to an end.

    f and 1 - f are each right to 1e-15 of their largest values, so they also add up to 1.
    """
    law = data.draw(family_laws(name))
    true = pieces_of(law)
    never_falls = characteristic(law).least_velocity.value >= 0.0
    for z in data.draw(st.lists(places(law), min_size=6, max_size=6)):
        found = values_at(law, z)
        assert excess(found, true, z) <= 1.0
        if never_falls:
            f, g, *_ = exact(law.name, law.task, law.parameters, z)
            if z <= 0.5:
                assert ulps(found[0], f) <= ulp_limit(name)
            if z >= 0.5:
                assert ulps(found[1], g) <= ulp_limit(name)


HARD: list[tuple[str, str, dict[str, float], float]] = [
    # Just before a short plateau of constant velocity: a small share of a cosine ends there.
    (
        "scca",
        "R-R",
        {
            "inflection": 0.8540297476028484,
            "sine": 0.875,
            "cosine": 0.015625,
            "curved": 0.8621133708569956,
        },
        0.8741570936611013,
    ),
    (
        "scca",
        "R-R",
        {
            "inflection": 0.00021049194689834786,
            "sine": 0.484375,
            "cosine": 0.0625,
            "curved": 0.0034762972397502858,
        },
        7.317324505017924e-07,
    ),
    # The law has run far back, or far beyond, where the two parts meet.
    (
        "modified-sine",
        "G-G",
        {"inflection": 0.9997548472126293, "v0": -3.707536314376234, "v1": 0.0},
        0.9997094157511304,
    ),
    (
        "modified-sine",
        "G-G",
        {"inflection": 0.005260188356298677, "v0": 2.1631229748557903, "v1": -4.589011083624136},
        0.005260188356299077,
    ),
    (
        "modified-sine",
        "R-G",
        {"inflection": 4.201299309127681e-06, "v1": -2.3931639064146215},
        4.201299309127681e-06,
    ),
    (
        "modified-sine",
        "G-R",
        {"inflection": 0.9999280045190038, "v0": -4.237643856659851},
        0.9998995064606597,
    ),
    (
        "harmonic-combination",
        "G-U",
        {"inflection": 0.951468987922536, "v0": -4.051467479328829},
        0.9514689879114984,
    ),
    (
        "harmonic-combination",
        "U-G",
        {"inflection": 0.999998328894372, "v1": -3.768667447563291},
        1.6711279098944114e-06,
    ),
    (
        "harmonic-combination",
        "U-G",
        {"inflection": 0.9999867828355511, "v1": -4.694586510910814},
        1.3217164448908747e-05,
    ),
    # A polynomial in the middle, where its powers cancel.
    ("polynomial-4567", "R-R", {"inflection": 0.9995653762727443}, 0.9995653762181855),
    ("polynomial-4567", "R-R", {"inflection": 0.00018686468642630763}, 0.0001868648644068763),
    ("polynomial-4567", "R-R", {"inflection": 0.5}, 0.5000135336815926),
    ("polynomial-5", "U-U", {"a0": -1.2286395033603936, "a1": 3.7132628841286603}, 0.5),
    ("polynomial-5", "B-U", {"v0": 0.0, "a0": 0.0, "a1": 1.8345918569477968}, 0.5),
    ("polynomial-7", "R-R", {"j0": 0.0, "j1": 1.5811127740785906}, 0.375),
    (
        "polynomial-7",
        "B-B",
        {
            "v0": -4.726154252652234,
            "a0": -1.6399230883148528,
            "j0": 0.0,
            "v1": 0.0,
            "a1": 0.0,
            "j1": -49.65616001866062,
        },
        0.49999999999999895,
    ),
    (
        "polynomial-7",
        "B-B",
        {
            "v0": 0.0,
            "a0": -3.4733114897369735,
            "j0": -39.09003376277843,
            "v1": 0.0,
            "a1": 0.0,
            "j1": -37.07730976467324,
        },
        0.49999999994229993,
    ),
    (
        "polynomial",
        "B-B",
        {
            "v0": -4.534503564690464,
            "a0": -3.4263674881906923,
            "j0": -41.948403545621794,
            "v1": -0.8806783721961562,
            "j1": -12.650138371386632,
            "a1": 0.0,
        },
        0.5167758170613886,
    ),
]
"""Laws and places at which errors were found to be large."""


@pytest.mark.parametrize(("name", "task", "terms", "z"), HARD)
def test_values_at_hard_places(name: str, task: str, terms: dict[str, float], z: float) -> None:
    law = make_law(name, task, **terms)
    assert excess(values_at(law, z), exact_pieces(name, task, terms), z) <= 1.0


@pytest.mark.parametrize("name", SHARP)
@few
@given(data=st.data())
def test_derivatives_from_rest_to_rest_keep_all_digits(name: str, data: st.DataObject) -> None:
    law = make_law(name, inflection=data.draw(inflections()))
    for z in data.draw(st.lists(places(law), min_size=4, max_size=4)):
        found = values_at(law, z)
        worst = [
            max(ulps(a, b) for a, b in zip(found[:4], true[:4], strict=True))
            for true in candidates(pieces_of(law), z)
        ]
        assert min(worst) <= LIMIT


@pytest.mark.parametrize(
    ("name", "inflection", "z"), [("modified-sine", 0.23837298011057467, 0.8094203856992939)]
)
def test_derivatives_at_hard_places(name: str, inflection: float, z: float) -> None:
    """Beside the border of a slow and a quick sine."""
    law = make_law(name, inflection=inflection)
    for value, true in zip(
        values_at(law, z)[:4], exact(name, "R-R", law.parameters, z), strict=False
    ):
        assert ulps(value, true) <= LIMIT


# What holds for every law ---------------------------------------------------------------------


@by_family
@few
@given(data=st.data())
def test_a_law_meets_its_ends(name: str, data: st.DataObject) -> None:
    """f(0) = 0 and f(1) = 1 and the boundary values given exactly, and zero what its task says."""
    task, given = data.draw(family_terms(name))
    try:
        law = make_law(name, task, **given)
    except GeometryError:
        assert name == "polynomial"
        return
    z = np.array([0.0, 1.0])
    f, f1, f2, f3 = law(z)
    assert f.tolist() == [0.0, 1.0]
    assert law.complement(z).tolist() == [1.0, 0.0]
    assert (law.name, law.task) == (name, task)
    assert {**law.parameters, **given} == dict(law.parameters)
    for k, (end, kind) in enumerate(((law.start, task[0]), (law.end, task[-1]))):
        assert end.velocity == f1[k]
        assert end.acceleration == f2[k]
        assert end.jerk == pytest.approx(f3[k], rel=2.0 * EPS, abs=0.0)
        for value, key in ((f1[k], f"v{k}"), (f2[k], f"a{k}"), (f3[k], f"j{k}")):
            if key in given:
                assert value == pytest.approx(given[key], rel=EPS, abs=0.0)
        # Laws with a shock or a jerk at a rest are registered for it all the same.
        jerks = name in ("straight-line", "quadratic-parabola", "simple-sine", "scca")
        if kind in "RU" and name != "straight-line":
            assert f1[k] == 0.0
        if kind in "RG" and not jerks:
            assert f2[k] == 0.0


def mirrored_parameters(task: str, parameters: dict[str, float]) -> dict[str, float]:
    """Those of the mirror image 1 - f(1 - z): f' and f''' keep their signs, f'' changes it."""
    swapped = {}
    for key, value in parameters.items():
        if key == "inflection":
            # Counted from the rest or the G end for U-R and U-G, so that it stays the same.
            swapped[key] = value if task in ("R-U", "U-R", "G-U", "U-G") else 1.0 - value
        elif key[-1] in "01":
            other = key[0] + ("1" if key[-1] == "0" else "0")
            swapped[other] = -value if key[0] == "a" else value
        else:
            swapped[key] = value
    return swapped


@by_family
@few
@given(data=st.data())
def test_the_mirror_image_of_a_law_is_one(name: str, data: st.DataObject) -> None:
    """In 30 and 20 bits 1 - z and 1 - lambda are exact; and so is the mirror image, to an ulp."""
    task, given = data.draw(family_terms(name))
    if "inflection" in given:
        given["inflection"] = round(given["inflection"] * 2**20) / 2**20
    try:
        law = make_law(name, task, **given)
    except GeometryError:
        assert name == "polynomial"
        return
    image = make_law(name, task[::-1], **mirrored_parameters(task, given))
    z = np.array(data.draw(st.lists(st.integers(1, 2**30 - 1), min_size=8, max_size=8))) / 2**30
    inner = np.array([0.0, 0.5, *(region.start for region in law.regions)])
    z = z[np.min(np.abs(z[:, None] - inner), axis=1) > 4.0 * EPS]  # either side may come there
    f, f1, f2, f3 = law(z)
    _, m1, m2, m3 = image(1.0 - z)
    for here, there in (
        (f, image.complement(1.0 - z)),
        (law.complement(z), image(1.0 - z)[0]),
        (f1, m1),
        (f2, -m2),
        (f3, m3),
    ):
        assert np.all(np.abs(here - there) <= np.spacing(np.abs(here)))


@by_family
@few
@given(data=st.data())
def test_the_jerk_bound_bounds_f3_in_each_region(name: str, data: st.DataObject) -> None:
    law = data.draw(family_laws(name))
    steps = np.concatenate((np.linspace(0.0, 1.0, 301), np.logspace(-15, -3, 13)))
    for region in law.regions:
        for share in (steps, 1.0 - steps):
            z = region.start + share * (region.end - region.start)
            f3 = region.values(z)[3]
            assert np.max(np.abs(f3)) <= region.jerk_bound * (1.0 + LIMIT * EPS)


@by_family
@few
@given(data=st.data())
def test_regions_fill_the_law_without_gaps(name: str, data: st.DataObject) -> None:
    law = data.draw(family_laws(name))
    assert law.regions[0].start == 0.0
    assert law.regions[-1].end == 1.0
    for before, after in zip(law.regions[:-1], law.regions[1:], strict=True):
        # Both are the same border, rounded on the way from one end of the law or from the other.
        assert abs(before.end - after.start) <= 2.0 * EPS
        assert before.start < before.end
    assert list(law.borders) == sorted(law.borders)
    assert all(0.0 < border < 1.0 for border in law.borders)
    assert set(law.borders) <= {region.start for region in law.regions}


@by_family
@few
@given(data=st.data())
def test_no_value_exceeds_the_characteristic_ones_and_some_come_near(
    name: str, data: st.DataObject
) -> None:
    """At 200 places of each region: a quantity that turns by at most pi there comes within
    (pi/200)^2/8 of its extreme, relative to its amplitude; a polynomial of degree 11, as f' f'' of
    a septic is, turns faster, but not so fast that 1e-3 would not do."""
    law = data.draw(family_laws(name))
    found = characteristic(law)
    velocity, acceleration, jerk = mesh(law)
    power = velocity * acceleration
    checks = [
        (found.velocity.value, velocity, True),
        (found.least_velocity.value, velocity, False),
        (found.largest_acceleration.value, acceleration, True),
        (found.least_acceleration.value, acceleration, False),
        (found.largest_jerk.value, jerk, True),
        (found.least_jerk.value, jerk, False),
        (found.largest_moment.value, power, True),
        (found.least_moment.value, power, False),
    ]
    if law.inflection is not None:
        second = np.concatenate([np.full(201, region.from_end) for region in law.regions])
        checks += [
            (abs(extreme.value), np.abs(values[part]), True)
            for extreme, values, part in (
                (found.acceleration, acceleration, ~second),
                (found.deceleration, acceleration, second),
                (found.jerk, jerk, ~second),
                (found.braking_jerk, jerk, second),
                (found.moment, power, ~second),
                (found.braking_moment, power, second),
            )
        ]
    for value, dense, largest in checks:
        size = float(np.max(np.abs(dense)))
        best = float(np.max(dense) if largest else np.min(dense))
        beyond = best - value if largest else value - best
        assert beyond <= 64.0 * EPS * size
        assert -beyond <= 1e-3 * max(size, abs(value))


def mesh(law: Law) -> tuple[FloatArray, FloatArray, FloatArray]:
    """f', f'', f''' at both ends of every region and at 199 places between."""
    shares = np.linspace(0.0, 1.0, 201)
    parts = []
    for region in law.regions:
        z = region.start + shares * (region.end - region.start)
        parts.append(region.values(z)[1:])
    velocity, acceleration, jerk = (np.concatenate(part) for part in zip(*parts, strict=True))
    return velocity, acceleration, jerk


@by_family
@few
@given(data=st.data())
def test_characteristic_values_are_taken_at_their_stated_places(
    name: str, data: st.DataObject
) -> None:
    """At the place itself, or, at a border, on one side of it. Of several places at which the value
    is the same to 1e-13 the first is named, so it is taken there to 1e-13."""
    law = data.draw(family_laws(name))
    found = characteristic(law)
    true = pieces_of(law)
    sizes = scales(true)
    power = sizes[2] * sizes[3]
    checks: list[tuple[Extreme, Callable[[tuple[Number, ...]], Number], float]] = [
        (found.velocity, lambda v: v[2], sizes[2]),
        (found.least_velocity, lambda v: v[2], sizes[2]),
        (found.acceleration, lambda v: v[3], sizes[3]),
        (found.deceleration, lambda v: v[3], sizes[3]),
        (found.largest_acceleration, lambda v: v[3], sizes[3]),
        (found.least_acceleration, lambda v: v[3], sizes[3]),
        (found.largest_jerk, lambda v: v[4], sizes[4]),
        (found.least_jerk, lambda v: v[4], sizes[4]),
        (found.moment, lambda v: v[2] * v[3], power),
        (found.braking_moment, lambda v: v[2] * v[3], power),
        (found.largest_moment, lambda v: v[2] * v[3], power),
        (found.least_moment, lambda v: v[2] * v[3], power),
    ]
    for extreme, value_of, size in checks:
        with mp.workdps(DIGITS):
            off = [abs(mpf(extreme.value) - value_of(v)) for v in candidates(true, extreme.place)]
        # f''' has its extremes at borders, of which the place is rounded: 2^-52 by the length.
        lengths = [float(piece.end - piece.start) for piece in true]
        # Where the quantity is zero everywhere the oracle leaves the rounding of its 100 digits.
        assert float(min(off)) <= (1.2e-13 + 4.0 * EPS / min(lengths)) * size + 1e-40


# Families and names ---------------------------------------------------------------------------


@by_task
def test_what_is_not_given_is_the_default_of_its_option(name: str, task: str) -> None:
    """A law with the stated defaults is the law without them, each option by itself."""
    family = FAMILIES[name]
    z = np.linspace(0.0, 1.0, 33)
    given_values = {
        key: 0.6 for key in family.parameters[task] if key in ("v0", "v1", "inflection")
    }
    own = make_law(name, task, **given_values)
    for option in family.options:
        if option.name in family.parameters[task]:
            stated = make_law(name, task, **given_values, **{option.name: option.default})
            assert np.array_equal(own(z), stated(z)), option.name
            assert own.parameters[option.name] == option.default
            lower = make_law(name, task, **given_values, **{option.name: 0.5 * option.default})
            assert not np.array_equal(own(z), lower(z)), option.name


def test_aliases() -> None:
    for alias, name in ALIASES.items():
        assert find_family(alias) is FAMILIES[name]
        assert make_law(alias).name == name


def test_an_unknown_law_task_or_parameter_is_refused() -> None:
    with pytest.raises(GeometryError, match="is not a motion law") as caught:
        make_law("cycloid")
    assert caught.value.key == "law"
    with pytest.raises(GeometryError, match="is made for R-R"):
        make_law("inclined-sine", "G-G")
    with pytest.raises(GeometryError, match="takes no v0"):
        make_law("modified-sine", "R-R", v0=1.0)


@by_task
def test_a_parameter_that_is_no_number_is_refused(name: str, task: str) -> None:
    for key, value in product(FAMILIES[name].parameters[task], (math.nan, math.inf, -math.inf)):
        with pytest.raises(GeometryError) as caught:
            make_law(name, task, **{key: value})
        assert caught.value.key == key


@pytest.mark.parametrize(
    ("name", "task"),
    [each for each in FAMILY_TASKS if "inflection" in FAMILIES[each[0]].parameters[each[1]]],
)
def test_the_inflection_must_lie_inside(name: str, task: str) -> None:
    for value in (0.0, 1.0, -0.25, 1.5):
        with pytest.raises(GeometryError, match="strictly between 0 and 1") as caught:
            make_law(name, task, inflection=value)
        assert caught.value.key == "inflection"


PUBLISHED = {
    # C_v, C_a, C_j, C_Mdyn to three digits: VDI 2143-1, section 6.1.1
    "straight-line": (1.0, None, None, None),
    "quadratic-parabola": (2.0, 4.0, None, 8.0),
    "simple-sine": (1.57, 4.93, None, 3.88),
    "polynomial-345": (1.875, 5.77, 60.0, 6.69),
    "inclined-sine": (2.0, 6.28, 39.5, 8.16),
    "modified-trapezoid": (2.0, 4.89, 61.4, 8.09),
    "modified-sine": (1.76, 5.53, 69.5, 5.46),
}


@pytest.mark.parametrize("name", PUBLISHED)
def test_published_characteristic_values(name: str) -> None:
    found = characteristic(make_law(name))
    extremes = (found.velocity, found.acceleration, found.jerk, found.moment)
    for extreme, published in zip(extremes, PUBLISHED[name], strict=True):
        if published is not None:  # else infinite: f' or f'' jumps at the ends
            # Half a unit of the third digit.
            half = 0.5 * 10.0 ** (math.floor(math.log10(extreme.value)) - 2)
            assert extreme.value == pytest.approx(published, abs=half, rel=0)


# x - sin x -------------------------------------------------------------------------------------

X = np.concatenate((np.logspace(-16, -1, 61), np.linspace(0.1, 0.5 * math.pi, 60)))


def exact_difference(x: float) -> Number:
    with mp.workdps(DIGITS):  # at 1e-16 the difference has lost 32 digits
        return mpf(x) - mp.sin(mpf(x))


def test_the_difference_keeps_all_digits() -> None:
    # The cube of x by 6 rounds three times, the series about once, the product once more.
    assert worst_ulps(x_minus_sin(X), [exact_difference(float(x)) for x in X]) <= 4.0
