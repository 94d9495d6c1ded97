"""A conjugate pair in one piece: layers of two discs and a spacer, and what has no room."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any, Final

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgeo.cam.cam import Contact
from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.outline.path import Path, whole
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.geometry.working_curve import WorkingCurve
from camgeo.kinematics.mechanism.conjugate import return_on_carriage
from camgeo.kinematics.mechanism.translating_roller import TranslatingRoller
from camgeo.part.assembly import bore_outline, build_pair, build_part
from camgeo.part.boundaries import CurveBoundary, ExactBoundary
from camgeo.part.mass import solid
from camgeo.part.part import Part
from camgeo.part.spec import (
    DISCS,
    Chamfer,
    Chamfers,
    Counterbore,
    Engraving,
    Holes,
    Hub,
    Keyway,
    Mark,
    Pair,
    PartSpec,
    SetScrew,
)
from tests.long_form import examples
from tests.part.parts import PITCH, ROLLER, refused, walls_of

assert isinstance(PITCH.follower, TranslatingRoller)
OTHER: Final = PitchCurve(PITCH.motion, return_on_carriage(PITCH.follower, 100.0), PITCH.rotation)
"""From 45 to 60 mm, its flank from 37 to 52 mm."""

PATHS: Final = (whole(WorkingCurve(PITCH, -ROLLER)), whole(WorkingCurve(OTHER, -ROLLER)))

PLAIN: Final = PartSpec(thickness=10.0, bore=20.0, pair=Pair(gap=7.0, spacer=36.0))


def paired(spec: PartSpec) -> Part:
    return build_pair(PATHS, spec, 0.01)


def test_two_discs_on_a_spacer_share_their_bore() -> None:
    part = paired(PLAIN)
    assert walls_of(part) == [
        ("return outline", -27.0, -17.0),
        ("bore", -27.0, 0.0),
        ("spacer", -17.0, -10.0),
        ("outline", -10.0, 0.0),
    ]
    assert [each.name for each in part.layers] == ["return disc", "spacer", "disc"]
    assert [each.name for each in part.levels] == [
        "lower face", "upper face of the return disc", "lower face of the disc", "upper face",
    ]  # fmt: skip


def test_either_disc_may_be_above() -> None:
    assert PLAIN.pair is not None
    part = paired(replace(PLAIN, pair=replace(PLAIN.pair, upper="return")))
    assert [each.name for each in part.layers] == ["disc", "spacer", "return disc"]
    assert [each.name for each in part.levels] == [
        "lower face", "upper face of the disc", "lower face of the return disc", "upper face",
    ]  # fmt: skip
    volume = solid(part).volume
    assert volume == pytest.approx(solid(paired(PLAIN)).volume, rel=1e-14)


@pytest.mark.parametrize("side", ["upper", "lower", "both"])
def test_the_hub_stands_on_the_outer_faces(side: str) -> None:
    """It is the pair's: none stands in the gap. The set screw is where the first hub is."""
    screw = SetScrew(4.0, 3.0)
    part = paired(replace(PLAIN, hub=Hub(30.0, 6.0, side), set_screw=screw))
    low, high = (-33.0 if side != "upper" else -27.0), (6.0 if side != "lower" else 0.0)
    assert (part.layers[0].z0, part.layers[-1].z1) == (low, high)
    assert ("bore", low, high) in walls_of(part)
    names = {"upper": {"hub"}, "lower": {"lower hub"}, "both": {"hub", "lower hub"}}[side]
    assert {name for name, *_ in walls_of(part) if "hub" in name} == names


def test_volume_and_moments_are_those_of_its_bodies() -> None:
    """Of the discs alone, and of spacer and hub as rings around bore and holes."""
    spec = replace(
        PLAIN, keyway=Keyway(6.0, 2.8, 0.7), mark=Mark(25.0, 2.0, 0.5), hub=Hub(28.0, 6.0, "lower"),
        bolt_circle=Holes(3, 31.0, 2.0),
    )  # fmt: skip
    discs = [
        solid(build_part(Contact.INNER, path, path, spec.alone(name), 0.01))
        for name, path in zip(DISCS, PATHS, strict=True)
    ]
    pair = solid(paired(spec))
    bore = bore_outline(20.0, spec.keyway)
    holes = [Contour.circle(1.0, middle) for middle in Holes(3, 31.0, 2.0).middles]
    spacer = _ring(18.0, [bore, *holes])
    hub = _ring(14.0, [bore])
    bodies = [  # volume, axial moment, height of the middle
        (discs[0].volume, discs[0].axial, discs[0].centre[2]),
        (discs[1].volume, discs[1].axial, discs[1].centre[2] - 17.0),
        (7.0 * spacer[0], 7.0 * spacer[1], -13.5),
        (6.0 * hub[0], 6.0 * hub[1], -30.0),
    ]
    assert pair.volume == pytest.approx(math.fsum(each[0] for each in bodies), rel=1e-12)
    assert pair.axial == pytest.approx(math.fsum(each[1] for each in bodies), rel=1e-12)
    first = math.fsum(volume * z for volume, _, z in bodies)
    assert pair.centre[2] == pytest.approx(first / pair.volume, rel=1e-12)


def _ring(radius: float, holes: list[Contour]) -> tuple[float, float]:
    """Area and polar moment about the cam axis of a disc with holes."""
    area, polar = math.pi * radius**2, 0.5 * math.pi * radius**4
    for each in holes:
        boundary = ExactBoundary("hole", hole=True, exact=each)
        area -= boundary.moments(1e-10).area
        polar -= boundary.second_moments(1e-10).polar
    return area, polar


def test_bolts_go_in_from_above_and_texts_can_be_read() -> None:
    """Only the upper disc has counterbores and texts, alone and in the pair."""
    bolts = Holes(2, 29.0, 2.5, counterbore=Counterbore(4.0, 3.0))
    spec = replace(PLAIN, bolt_circle=bolts)
    for upper, other in (DISCS, DISCS[::-1]):
        pair = replace(spec, pair=Pair(7.0, 36.0, upper))
        walls = walls_of(paired(pair))
        assert ("counterbore 1", -3.0, 0.0) in walls
        assert ("bolt hole 1", -27.0, -3.0) in walls
        kept = [pair.alone(each).bolt_circle for each in (upper, other)]
        assert kept == [bolts, replace(bolts, counterbore=None)]
    written = replace(PLAIN, engraving=(Engraving("I", 3.0, 0.5, radius=24.0),))
    texts = [(name, z0, z1) for name, z0, z1 in walls_of(paired(written)) if "engraving" in name]
    assert [heights for _, *heights in texts] == [[-0.5, 0.0]]


@pytest.mark.parametrize(
    ("changes", "spacer", "key", "message"),
    [
        ({}, 63.99, "spacer", r"31\.995 mm .* of the main disc comes as near as 32 mm at cam"),
        ({"bolt_circle": Holes(2, 36.0, 3.0)}, 36.0, "spacer", "clear of the bolt hole 1"),
        ({"keyway": Keyway(6.0, 9.0)}, 36.0, "spacer", "clear of the bore, which it touches"),
        ({"bore": None, "bolt_circle": Holes(1, 4.0, 20.0)}, 6.0, "spacer", "around the spacer"),
        ({"mark": Mark(14.0, 2.0, 0.5)}, 36.0, "spacer", "the mark ends under the spacer"),
        ({"mark": Mark(18.0, 2.0, 0.5)}, 36.0, "spacer", "clear of the mark, which it touches"),
        ({"mark": Mark(35.0, 6.0, 0.5, angle=1.2)}, 36.0, "mark", "main disc: the mark must lie"),
    ],
)  # fmt: skip
def test_what_has_no_room(changes: dict[str, Any], spacer: float, key: str, message: str) -> None:
    spec = replace(PLAIN, pair=Pair(7.0, spacer), **changes)
    with refused(f"part.{'pair.' if key == 'spacer' else ''}{key}", message):
        paired(spec)


@settings(max_examples=examples(20, long=200))
@given(
    st.floats(20.5, 70.0), st.floats(0.1, 40.0), st.floats(10.0, 60.0), st.floats(1.0, 12.0),
    st.sampled_from(["upper", "lower", "both"]), st.sampled_from(["main", "return"]),
)  # fmt: skip
def test_it_is_refused_or_its_sections_are_the_discs(
    spacer: float, gap: float, circle: float, hole: float, side: str, upper: str
) -> None:
    """Areas of the layers are those of discs, spacer and hub less what goes through them."""
    spec = replace(
        PLAIN, pair=Pair(gap, spacer, upper), hub=Hub(28.0, 5.0, side),
        bolt_circle=Holes(3, circle, hole),
    )  # fmt: skip
    try:
        part = paired(spec)
    except GeometryError as error:
        if not error.key.startswith("part."):
            raise
        return
    heights = np.array([(each.z0, each.z1) for each in part.layers])
    assert np.all(heights[:-1, 1] == heights[1:, 0])
    assert part.thickness == pytest.approx(
        20.0 + gap + (10.0 if side == "both" else 5.0), rel=1e-12
    )
    inside = 0.5 * (circle + hole) < 0.5 * spacer
    (between,) = (each for each in part.layers if each.name == "spacer")
    assert len(between.boundaries) == (5 if inside else 2)
    names = [each.name for each in part.boundaries]
    assert len(set(names)) == len(names)


def test_a_pair_has_chamfers_as_a_whole() -> None:
    """Along both flanks, at the ends of the bore, and on the hub; discs alone have their share."""
    half = Chamfer(0.5)
    edges = Chamfers(outline=half, bore=half, hub=Chamfer(1.0))
    spec = replace(PLAIN, hub=Hub(34.0, 8.0, "lower"), chamfers=edges)
    part = paired(spec)
    assert sorted((each.boundary.name, each.z) for each in part.bevels) == [
        ("bore", -35.0), ("bore", 0.0), ("lower hub", -35.0), ("outline", -10.0), ("outline", 0.0),
        ("return outline", -27.0), ("return outline", -17.0),
    ]  # fmt: skip
    assert spec.alone("main").chamfers == Chamfers(half, bore=Chamfer(0.5, "upper"))
    assert spec.alone("return").chamfers == Chamfers(half)
    sharp = solid(paired(replace(spec, chamfers=None))).volume
    bore = 2.0 * math.pi * (0.25 * 10.0 + 0.125 / 3.0)  # twice the ring of a triangle
    hub = math.pi * (17.0 - 1.0 / 3.0)
    lengths = [path_length(path) for path in PATHS]
    # Of a convex edge: half the square of the width along it, less a part of a cone.
    flanks = 2.0 * sum(0.125 * length - math.pi * 0.125 / 3.0 for length in lengths)
    assert sharp - solid(part).volume == pytest.approx(bore + hub + flanks, rel=1e-3)


def path_length(path: Path) -> float:
    return CurveBoundary("outline", False, path).polyline(1e-3, "fast").contour.length
