"""Whole discs as judged, listed, printed and milled: each figure by another way, each limit at both
sides.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest

import camgeo
from camgeo.check.finding import BROKEN, Finding
from camgeo.design.drawn import COMPENSATED
from camgeo.design.judged_part import (
    PartAssessment,
    broken_findings,
    part_findings,
    poor_findings,
    relation_findings,
)
from camgeo.design.machining import machining_time, plan_machining
from camgeo.design.milled import MilledDisc
from camgeo.design.plate import STEP, plate_pieces
from camgeo.design.product import Product, display_title, find_disc, solid_products, with_pair
from camgeo.errors import UnsafeError
from camgeo.milling import plan
from camgeo.numeric.arrays import FloatArray
from camgeo.part.mass import Solid, Web
from camgeo.studies.sweep.rows import parse_questions, read
from tests.contour.cams import SCENES
from tests.findings import known
from tests.part.parts import refused

FOUND = Path(__file__).parents[2] / "fixtures" / "found"

PAIR = Path(__file__).parents[2] / "fixtures" / "pairs" / "conjugate_pair.toml"

DENSE: dict[str, Any] = {"part.density": 7850}
"""[kg/m^3]."""


def design(scene: str, values: dict[str, Any] | None = None) -> camgeo.Design:
    path = PAIR if scene == "pair" else SCENES / f"{scene}.toml"
    return camgeo.Design(camgeo.load(path).scene.with_values(values or {}))


def by_name(found: tuple[Finding, ...]) -> dict[str, Finding]:
    return {each.name: each for each in found}


# The part, judged ---------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "scene", ["plate_translating", "hub_and_holes", "conjugate_carriage", "pair"]
)
def test_the_part_is_weighed_in_the_units_of_the_scene(scene: str) -> None:
    disc = design(scene, DENSE).disc
    found = PartAssessment.from_disc(disc)
    assert found.body is not None
    exact = Solid.from_part(disc.drawn.part)
    weight = 7850e-9  # kg/mm^3
    assert (found.body.stated_density, found.body.mass) == pytest.approx(
        (7850.0, weight * exact.volume), rel=1e-12
    )
    assert found.body.axial_inertia == pytest.approx(weight * exact.axial, rel=1e-12)
    assert np.allclose(known(found.body.inertia), weight * exact.inertia, rtol=1e-12, atol=0.0)
    volume = math.fsum(each.area * (each.z1 - each.z0) for each in found.layers)
    assert volume == pytest.approx(Solid.from_part(disc.drawn.part.sharp).volume, rel=1e-9)
    assert [each.name for each in found.layers] == [each.name for each in disc.drawn.part.layers]
    alike(disc, found)
    told = by_name(found.findings)
    assert (told["mass"].value, told["mass"].sentence) == (
        found.body.mass,
        f"mass {found.body.mass:.6g} kg",
    )
    assert told["largest-diameter"].value == found.diameter
    assert found.diameter == 2.0 * disc.drawn.part.outermost.farthest()[0]
    both = told.get("mass-of-both-discs")
    assert (both is not None) == (scene == "conjugate_carriage")
    assert not any(both in part_findings(other) for other in disc.others)
    if both is not None:
        mine, other = (Solid.from_part(each.drawn.part) for each in (disc, disc.others[0]))
        assert both.value == pytest.approx(weight * (mine.volume + other.volume), rel=1e-12)
        inertia = weight * (mine.axial + other.axial)
        assert f"moment of inertia about the cam axis {inertia:.6g} kg mm^2" in both.sentence
    bare = PartAssessment.from_disc(design(scene).disc).body
    if bare is not None and bare.density is None:
        nothing = (bare.mass, bare.axial_inertia, bare.inertia, bare.stated_density)
        assert nothing == (None,) * 4


def alike(disc: Product, found: PartAssessment) -> None:
    """What checks state, and what builds warn of, is what is found of the part."""
    assert part_findings(disc) == found.findings
    assert poor_findings(disc) == tuple(each for each in found.findings if each.severity != "ok")
    assert broken_findings(disc) == tuple(
        each for each in found.findings if each.severity in BROKEN
    )


@pytest.mark.parametrize(
    ("limit", "name", "least"),
    [
        ("limits.diameter", "largest-diameter", False),
        ("limits.mass", "mass", False),
        ("limits.wall", "smallest-wall", True),
    ],
)
def test_limits_of_a_part_hold_at_the_value_and_break_beyond_it(
    limit: str, name: str, least: bool
) -> None:
    plain = {**DENSE, "part.keyway": None}
    value = known(by_name(part_findings(design("plate_translating", plain).disc))[name].value)
    off = -1e-6 if least else 1e-6
    inside, beyond = 1.0 + off, 1.0 - off
    for share, severity in ((inside, "ok"), (beyond, "broken")):
        disc = design("plate_translating", {**plain, limit: share * value}).disc
        found = by_name(part_findings(disc))[name]
        assert found.severity == severity
        assert found.limit == pytest.approx(share * value, rel=1e-12)
        assert found.value == pytest.approx(value, rel=1e-9)
        alike(disc, PartAssessment.from_disc(disc))


def test_a_wall_without_a_limit_is_compared_with_what_is_usual() -> None:
    """A tenth of the diameter of the hole; at it a wall is not thin."""
    thin: dict[str, Any] = {"part.bore": 60}
    disc = design("plate_translating", {**thin, "part.keyway": None}).disc
    _, web = Web.thinnest_webs(disc.drawn.part)
    assert web is not None
    assert web.usual == pytest.approx(6.0, rel=1e-12)
    told = by_name(part_findings(disc))
    assert (told["smallest-wall"].value, told["smallest-wall"].limit) == (web.thickness, None)
    assert told["smallest-wall"].severity == "ok"
    found = told["wall-ratio"]
    assert found.value == pytest.approx(web.thickness / 60.0, rel=1e-12)
    assert (found.limit, found.unit) == (0.1, "")
    assert (found.severity == "warning") == (web.thickness < 6.0)
    verdict = "below" if web.thickness < 6.0 else "at least"
    assert f"of the diameter of the hole, {verdict} 10%, 6 mm" in found.sentence
    alike(disc, PartAssessment.from_disc(disc))


def test_the_smallest_wall_is_the_smallest_distance() -> None:
    """1.5 mm beside a bolt hole of 3 mm are half of its diameter, 17.5 mm beside a bore of 60 mm
    are less: the first is the smallest wall, by every door.
    """
    loaded = camgeo.load(FOUND / "smallest_wall.toml")
    told = by_name(part_findings(loaded.disc))
    assert told["smallest-wall"].value == pytest.approx(1.5, abs=1e-9)
    assert "between outline and bolt hole 1" in told["smallest-wall"].sentence
    assert told["wall-ratio"].value == pytest.approx(17.5 / 60.0, abs=1e-9)
    (asked,) = parse_questions(loaded, ["smallest-wall"])
    assert read(loaded, asked).value == told["smallest-wall"].value


def test_what_no_file_has_is_told() -> None:
    screw = {"diameter": 4, "height": 3, "angle": 90}
    values = {"part.hub": {"diameter": 40, "height": 8}, "part.set_screw": screw}
    disc = design("plate_translating", values).disc
    found = by_name(part_findings(disc))["set-screw"]
    assert found.severity == "warning"
    assert "4 mm in diameter, 3 mm above the face of the disc in the direction 90 deg" in (
        found.sentence
    )
    alike(disc, PartAssessment.from_disc(disc))


def test_a_part_that_is_impossible_is_told_as_such() -> None:
    disc = design("plate_translating", {"part.bore": 200, "part.keyway": None}).disc
    found = PartAssessment.from_disc(disc)
    assert (found.diameter, found.layers, found.body) == (None, (), None)
    assert [(each.name, each.severity) for each in found.findings] == [("part", "invalid")]
    assert part_findings(disc) == found.findings
    assert (poor_findings(disc), broken_findings(disc)) == ((), found.findings)


# Names --------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("stem", "place"),
    [
        ("conjugate_lever", 0), ("conjugate_lever-return", 1), ("other-return", 1),
        ("OTHER-RETURN", 1), ("conjugate_lever-return-drawing", 1), ("conjugate_lever-drawing", 0),
        ("conjugate_lever-return-2-t3", 1), ("conjugate_lever-2-t3", 0),
        ("conjugate_lever-return-second-side", 1), ("conjugate_lever-return-second-side-1-t12", 1),
        ("conjugate_lever-second-side-1-t12", 0), ("conjugate_lever-return-x", 0),
        ("return-conjugate_lever", 0),
        ("conjugate_pair", 0),  # although it ends like a pair
        ("conjugate_pair-drawing", 0), ("conjugate_pair-return", 1), ("conjugate_pair-pair", 2),
        ("CONJUGATE_PAIR-PAIR", 2),
    ],
)  # fmt: skip
def test_a_file_belongs_to_the_disc_that_its_name_ends_with(stem: str, place: int) -> None:
    discs = design("pair" if stem.lower().startswith("conjugate_pair") else "conjugate_lever").discs
    assert [each.position for each in discs] == [0, 1]
    assert find_disc(discs, stem) is with_pair(discs)[place]


def test_titles_tell_which_disc_it_is() -> None:
    titled = design("pair", {"drawing.title": "Scheibe 7"})
    assert [display_title(each) for each in with_pair(titled.discs)] == [
        "Scheibe 7", "Scheibe 7 (return)", "Scheibe 7 (pair)",
    ]  # fmt: skip
    plain = design("pair", {"drawing.title": None})
    names = [each.name for each in with_pair(plain.discs)]
    assert names == ["conjugate_pair", "conjugate_pair-return", "conjugate_pair-pair"]
    assert [display_title(each) for each in with_pair(plain.discs)] == names


# Milling ------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Told(MilledDisc):
    """A disc of whose programs something is found."""

    def findings(self, *_: Any) -> tuple[Finding, ...]:
        severities = ("ok", "warning", *(("broken", "broken") if self.program else ()))
        return tuple(Finding(str(k), each, f"sentence {k}") for k, each in enumerate(severities))


def test_a_program_that_is_broken_is_not_made() -> None:
    disc = design("plate_translating").disc
    found: Any = Told(disc.drawn, disc.scene)
    assert [each.name for each in found.safe(None, 0.01)] == ["1"]
    broken: Any = Told(disc.drawn, disc.scene, program=1)
    with pytest.raises(UnsafeError, match="must not be run: sentence 2; sentence 3") as caught:
        broken.safe(None, 0.01)
    assert caught.value.key == "output.gcode"


# The table ----------------------------------------------------------------------------------------

TABLE_STEP = 0.25
"""Of tables [deg]."""

TABLES: dict[str, tuple[str, dict[str, Any], str]] = {
    "inches and a speed": ("inch", {"cam.speed": 90}, "s"),
    "a rocker behind a slider": ("setzhub", {"cam.speed": 60}, "psi"),
    "a slider behind a crank": ("crank_slider", {"cam.speed": 30}, "theta"),
    "a flat face": ("tappet", {"cam.speed": 300}, "s"),
}


def rate(values: FloatArray) -> FloatArray:
    """By central differences over the cam angle."""
    return np.asarray((np.roll(values, -1) - np.roll(values, 1)) / (2.0 * math.radians(TABLE_STEP)))


def close(found: FloatArray, expected: FloatArray) -> None:
    """But for places where something jumps, which are few."""
    off = np.abs(found - expected) / np.max(np.abs(expected))
    assert np.quantile(off, 0.97) <= 2e-3


@pytest.mark.parametrize("name", TABLES)
def test_columns_are_derivatives_of_each_other_and_curves_parallels(name: str) -> None:
    scene, values, motion = TABLES[name]
    made = design(scene, values)
    columns = {heading.partition(" [")[0]: column
               for heading, column in made.tabulated.table(TABLE_STEP).columns.items()}  # fmt: skip
    phi = np.radians(columns["phi"])
    assert np.array_equal(columns["phi"], TABLE_STEP * np.arange(1440))
    turned = motion != "s"
    base = np.radians(columns[motion]) if turned else columns[motion]
    for mark in ("'", "''", "'''"):
        close(columns[f"{motion}{mark}"], rate(base))
        base = columns[f"{motion}{mark}"]
    omega = values["cam.speed"] * 2.0 * math.pi / 60.0
    assert columns["t"] == pytest.approx(phi / omega, rel=1e-12)
    for order, timed in enumerate(("omega", "alpha", "j") if turned else ("v", "a", "j"), 1):
        expected = columns[f"{motion}{order * chr(39)}"] * omega**order
        expected = np.degrees(expected) if turned else expected
        found = columns[f"{timed}_{motion}" if turned else timed]
        assert np.max(np.abs(found - expected)) <= 1e-12 * np.max(np.abs(expected))
    mm = 25.4 if scene == "inch" else 1.0
    curve = "contact" if scene == "tappet" else "pitch"
    z = columns[f"{curve} x"] + 1j * columns[f"{curve} y"]
    along = rate(z.real) + 1j * rate(z.imag)
    if curve == "pitch":
        inner, outer = (columns[f"{each} x"] + 1j * columns[f"{each} y"]
                        for each in ("inner", "outer"))  # fmt: skip
        radius = made.cam.follower.roller_radius / mm
        assert np.abs(inner - z) == pytest.approx(np.full(len(z), radius), rel=1e-12)
        assert np.max(np.abs(inner + outer - 2.0 * z)) <= 1e-12 * radius
        leaning = ((inner - z) * np.conj(along)).real / (np.abs(along) * radius)
        assert np.quantile(np.abs(leaning), 0.97) <= 1e-3
        assert np.mean(np.abs(inner)) < np.mean(np.abs(z)) < np.mean(np.abs(outer))
        assert not {"on face", "contact x"} & set(columns)
        bend = (np.conj(along) * (rate(along.real) + 1j * rate(along.imag))).imag
        kappa = bend / np.abs(along) ** 3
        close(np.abs(columns["kappa"]), np.abs(kappa))
    else:
        assert not {"pitch x", "inner x", "outer y"} & set(columns)
        # The contact lies beside the follower's axis by what the lift changes with the angle.
        assert np.abs(columns["on face"]) == pytest.approx(np.abs(columns["s'"]), abs=1e-9)
    finite = np.isfinite(columns["r_K"]) & (np.abs(columns["kappa"]) > 1e-9)
    assert columns["r_K"][finite] == pytest.approx(1.0 / columns["kappa"][finite], rel=1e-9)
    least = float(np.min(columns["mu"]))
    told = by_name(tuple(made.findings)).get("transmission-angle")
    assert told is None or told.value == pytest.approx(least, abs=0.05)
    assert 0.0 <= least <= float(np.max(columns["mu"])) <= 90.0


# How the discs of a conjugate pair stand to each other --------------------------------------------


KEYWAY = {"width": 8, "depth": 3.3}
BOLTS = {"count": 3, "circle": 50, "hole": 5}


@pytest.mark.parametrize(
    ("part", "severity", "said"),
    [
        ({"keyway": {**KEYWAY, "angle": 30}}, "ok", "in line on both discs: keyway at 30 deg"),
        ({"keyway": None}, "warning", "nothing on the discs shows it"),
        ({"keyway": None, "d_shaft": {"across": 20}}, "ok", "flat of the bore at 0 deg"),
        ({"keyway": None, "mark": {"radius": 30, "width": 2, "depth": 1}}, "ok", "timing mark at"),
        ({"keyway": None, "bolt_circle": BOLTS}, "warning", "fit in 3 positions, of which one is"),
        ({"keyway": None, "bolt_circle": {**BOLTS, "count": 1}}, "ok", "first bolt hole at 0 deg"),
        ({"bolt_circle": BOLTS}, "ok", "keyway at 0 deg and first bolt hole at 0 deg"),
    ],
)
def test_two_pieces_belong_at_0_degrees(part: dict[str, Any], severity: str, said: str) -> None:
    edits = {f"part.{key}": value for key, value in part.items()}
    main, other = design("conjugate_lever", edits).discs
    (found,) = relation_findings(main)
    assert (found.name, found.value, found.unit) == ("disc-angle", 0.0, "deg")
    assert found.severity == severity
    assert "the return disc must be mounted at 0 deg to the main disc" in found.sentence
    assert said in found.sentence
    assert relation_findings(other) == ()
    assert (found in poor_findings(main)) == (severity != "ok")
    assert found in part_findings(main)


def test_the_angle_that_may_be_off_is_that_of_the_closing_error() -> None:
    """Found again by turning the return disc, for which the lift is that of the angle ahead."""
    made = design("conjugate_lever")
    limit, reach = made.scene.limits.closing_error, abs(made.cam.follower.reach)
    sentence = relation_findings(made.disc)[0].sentence
    off = math.radians(float(sentence.split("off by ")[1].split()[0]))
    phi = np.linspace(0.0, 2.0 * math.pi, 20_001)
    lift = [made.drive.motion.jet(each)[0] for each in (phi, phi + off)]
    assert reach * np.max(np.abs(lift[1] - lift[0])) == pytest.approx(limit, rel=2e-3)


def test_the_pair_is_a_piece_of_its_own() -> None:
    """Discs stay what they are, without the hub; bodies are of the pair alone."""
    made = design("pair")
    main, other, pair = with_pair(made.discs)
    assert [each.name for each in (main, other, pair)] == [
        "conjugate_pair", "conjugate_pair-return", "conjugate_pair-pair",
    ]  # fmt: skip
    assert solid_products(main) == solid_products(pair) == (pair,)
    assert solid_products(other) == ()
    assert relation_findings(main) == ()
    assert [each.boundaries[0].name for each in main.drawn.part.layers] == ["outline", "outline"]
    told = by_name(relation_findings(pair))["disc-angle"]
    assert told.severity == "ok"
    assert (
        "the return disc at 0 deg to the main disc, below it, with a gap of 9 mm" in told.sentence
    )
    whole = known(PartAssessment.from_disc(pair).body)
    parts = [PartAssessment.from_disc(each).body for each in (main, other)]
    assert whole.solid.volume > sum(each.solid.volume for each in parts if each is not None)
    two = design("pair", {"part.pair": None})
    assert [solid_products(each) for each in two.discs] == [(each,) for each in two.discs]
    assert with_pair(two.discs) == two.discs


@pytest.mark.parametrize(
    ("width", "severity"), [(None, "ok"), (12, "ok"), (28, "ok"), (28.1, "broken")]
)
def test_rollers_need_room_beside_the_other_disc(width: float | None, severity: str) -> None:
    """Discs 10 mm thick, 9 mm apart: a roller in the middle of one is clear up to 28 mm."""
    sizes = {"gap": 9, "spacer": 54, **({"roller_width": width} if width else {})}
    made = design("pair", {"part.pair": sizes})
    pair = known(made.disc.pair)
    found = by_name(relation_findings(pair))["roller-width"]
    assert (found.severity, found.value) == (severity, (width or 28.0))
    assert (found in poor_findings(pair)) == (severity != "ok")


def test_rollers_beside_each_other_need_more_room() -> None:
    """On a short lever their circles overlap, seen along the shaft: then 19 mm is the most."""
    made = design("pair")
    one, two = (each.follower for each in made.cams)
    apart = abs(one.traced_point(0.0) - two.traced_point(0.0))
    assert apart > one.roller_radius + two.roller_radius
    radius = apart - one.roller_radius + 0.1
    wide = camgeo.Design(made.scene.with_values({"follower.return.roller_radius": radius}))
    found = by_name(relation_findings(known(wide.disc.pair)))["roller-width"]
    assert found.limit == pytest.approx(19.0)
    assert "the rollers reach each other" in found.sentence


# What is found of a disc that is to be printed: in checks, and of builds what is poor -------------


WALLED = {
    "part.bore": 22,
    "part.keyway": None,
    "print.nozzle": 0.24,
    "part.bolt_circle": {"count": 1, "circle": 42, "hole": 19.0, "angle": 200},
}
"""The wall is thinned on its side of the bore by half of the diametral clearance."""


@pytest.mark.parametrize(
    ("values", "severities"),
    [
        ({}, {}),
        ({"print.bore_clearance": 0.2}, {}),
        (
            {
                "part.mark": {"radius": 20, "width": 0.3, "depth": 0.5, "length": 4},
                "print.nozzle": 0.4,
            },
            {"print-wall": "ok", "print-radius": "ok", "print-stroke": "warning"},
        ),
        (WALLED, {"print-wall": "ok", "print-radius": "ok"}),
        ({**WALLED, "print.bore_clearance": 0.06}, {"print-wall": "warning", "print-radius": "ok"}),
        ({"print.nozzle": 0.4, "print.bore_clearance": 60}, {COMPENSATED: "broken"}),
        (
            {"print.nozzle": 0.4, "print.elephant_foot": {"inset": 50, "height": 1}},
            {COMPENSATED: "broken"},
        ),
    ],
)
def test_what_a_printer_cannot_make_is_found(
    values: dict[str, Any], severities: dict[str, str]
) -> None:
    """In checks, and of builds what is poor."""
    disc = design("plate_translating", values).disc
    every, poor = (
        {each.name: each.severity for each in found if each.name.startswith("print-")}
        for found in (part_findings(disc), poor_findings(disc))
    )
    assert every == severities
    assert poor == {name: each for name, each in severities.items() if each != "ok"}


@pytest.mark.parametrize("clearance", [6.0, 10.0, 60.0])
def test_why_there_is_no_room_is_said_once(clearance: float) -> None:
    """Of a keyway that the clearance eats, and of a bore that reaches the outline."""
    asked = design("hub_and_holes", {"print.bore_clearance": clearance})
    with refused("print.bore_clearance", "^((?!no room for it).)*no room for it((?!no room).)*$"):
        _ = asked.disc.drawn.printed.fitted


# Plates: what lies on them, apart, in a row of the positive quadrant ------------------------------


BODIES = ["cam", "return-cam", "roller", "return-roller", "test-ring"]


@pytest.mark.parametrize("gap", [0.1, 7.0])
def test_bodies_lie_apart(gap: float) -> None:
    plate = plate_pieces(
        design("conjugate_carriage", {"output.3mf.plate": BODIES, "output.3mf.gap": gap}).disc
    )
    assert [each.kind for each in plate] == BODIES
    assert [each.name for each in plate] == [
        "conjugate_carriage", "conjugate_carriage-return", "roller", "return roller", "test ring",
    ]  # fmt: skip
    assert len({each.colour for each in plate}) == len(plate)
    for each in plate:
        assert each.part.outermost.farthest()[0] == pytest.approx(each.reach, abs=1e-6)
        assert each.y - each.reach >= gap - 1e-6
        assert each.x * 1000.0 == pytest.approx(round(each.x * 1000.0), abs=1e-6)
    assert gap - 1e-6 <= plate[0].x - plate[0].reach <= gap + 2.0 * STEP
    for one, other in pairwise(plate):
        between = other.x - other.reach - (one.x + one.reach)
        assert gap - 1e-6 <= between <= gap + 2.0 * STEP


def test_sizes() -> None:
    """The rollers are those of the followers, as wide as the disc or as the scene says."""
    names = ["roller", "return-roller"]
    main, returning = plate_pieces(design("conjugate_carriage", {"output.3mf.plate": names}).disc)
    assert (main.reach, returning.reach) == (12.0, 10.0)
    assert main.part.thickness == returning.part.thickness == 14.0
    wide, _ = plate_pieces(
        design("conjugate_carriage", {"output.3mf.plate": names, "output.3mf.roller_width": 9}).disc
    )
    assert wide.part.thickness == 9.0


def test_all_are_compensated() -> None:
    values = {
        "print.bore_clearance": 0.2,
        "print.shrinkage": {"xy": 1.0},
        "print.elephant_foot": {"inset": 0.2, "height": 0.4},
        "output.3mf.plate": ["roller", "test-ring", "cam"],
        "output.3mf.roller_bore": 6,
    }
    roller, ring, cam = plate_pieces(design("conjugate_carriage", values).disc)
    assert roller.reach == pytest.approx(12.0 / 0.99, abs=1e-6)
    bores = [each.part.layers[-1].boundaries[-1].nearest() for each in (roller, ring, cam)]
    assert bores == pytest.approx([3.1 / 0.99, 12.6 / 0.99, 12.6 / 0.99])
    feet = [each.part.layers[0].boundaries[-1].nearest() for each in (roller, ring, cam)]
    assert feet == pytest.approx([each + 0.2 for each in bores])


def test_a_pair_in_one_piece() -> None:
    """It is the cam; its rollers are as wide as it states."""
    values = {
        "part.pair": {"gap": 8, "spacer": 40, "roller_width": 11},
        "output.3mf.plate": ["cam", "return-roller", "test-ring"],
    }
    pair = known(design("conjugate_carriage", values).disc.pair)
    cam, roller, ring = plate_pieces(pair)
    assert cam.part is pair.drawn.printed.target
    assert cam.part.thickness == 14.0 + 8.0 + 14.0
    assert roller.part.thickness == 11.0
    assert ring.part.layers[0].boundaries[1].nearest() == 12.5


def test_a_disc_without_another() -> None:
    assert plate_pieces(design("plate_translating").disc) == ()
    alone = design("conjugate_carriage", {"output.3mf.plate": ["return-cam"]}).discs[1]
    with refused("output.3mf.plate", "no return disc of its own"):
        plate_pieces(alone)


# Whoever asks for milling programs has the same plan ----------------------------------------------


def test_time_and_findings_come_from_one_plan(monkeypatch: pytest.MonkeyPatch) -> None:
    counted = Mock(wraps=plan.plan_toolpath)
    monkeypatch.setattr(plan, "plan_toolpath", counted)
    made = design("setzhub")
    seconds = machining_time(made.discs)
    assert plan_machining(made.discs).seconds == seconds
    assert counted.call_count == 1
    milled, tolerance = made.disc.milled, made.scene.output.tolerance
    assert milled.toolpath(0.5 * tolerance) != milled.toolpath(tolerance)  # each has its own
    assert counted.call_count == 3
