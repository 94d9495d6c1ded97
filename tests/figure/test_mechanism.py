"""Pictures of a cam and its mechanism: the real disc, lengths to be read, what turns."""

from __future__ import annotations

import itertools
import math
from decimal import Decimal
from pathlib import Path
from typing import Any, Final

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.axes import Axes

import camgeo
from camgeo.design.design import Design
from camgeo.kinematics.mechanism.sketch import Dimension, MechanismSketch
from camgeo.numeric.arrays import ComplexArray
from camgeo.pictures import cam, mechanism
from camgeo.pictures.mechanism import animation
from camgeo.pictures.model import Area, Line, Text
from camgeo.scene.scene import load_scene
from camgeo.units import TURN
from tests import kept
from tests.export.stub_product import StubProduct
from tests.figure import drawing
from tests.measuring import DensePath, polygon
from tests.reference import hard_case
from tests.strategies import attack

SCENES = sorted((Path(__file__).parents[2] / "fixtures" / "scenes").glob("*.toml"))


@pytest.mark.parametrize("scene", SCENES, ids=lambda path: path.stem)
def test_each_number_of_a_length_stands_in_the_list(scene: Path) -> None:
    product = camgeo.load(scene).disc
    figure = mechanism.figure(product)
    first, second = figure.panels
    numbers = [mark for mark in first.marks if isinstance(mark, Text)]
    assert not any(isinstance(mark, Text) for mark in second.marks)
    _, *listed = figure.texts
    assert [mark.text for mark in numbers] == [text.text.split()[0] for text in listed]
    dimensions = product.pictured.mechanism_sketch(0.0).dimensions
    for each, text in zip(dimensions, listed, strict=True):
        assert f"  {each.key} = " in text.text
        assert text.text.endswith(f" {product.unit}")
    # They lie in the panel, and on the page below it.
    (left, right), (low, high) = first.x.limits, first.y.limits
    for mark in numbers:
        assert left <= mark.at[0] <= right
        assert low <= mark.at[1] <= high
    assert all(0.0 < text.at[1] < first.frame[1] for text in listed)
    scale = (first.frame[2] - first.frame[0]) * figure.size[0] / (right - left)
    for one, other in itertools.combinations(numbers, 2):
        assert math.dist(one.at, other.at) * scale >= 0.5 * mechanism.NUMBER_GAP


def test_a_length_of_nothing_has_its_number_beside_it() -> None:
    """As that of a pivot so near to the cam axis that a picture shows them as one."""
    places = [0j, 1e-300 + 0j, 1.0 + 0.0j]
    dimensions = [Dimension("arm", 0j, each) for each in places]
    scale = 0.05
    marks = mechanism._measures(dimensions, MechanismSketch(), scale)
    numbers = [mark for mark in marks if isinstance(mark, Text)]
    assert [mark.text for mark in numbers] == ["1", "2", "3"]
    for mark, place in zip(numbers, places, strict=True):
        away = abs(complex(*mark.at) - place) * scale
        assert mechanism.BEYOND * (1.0 - 1e-9) <= away <= 4.0 * mechanism.BEYOND * (1.0 + 1e-9)


FIXTURES: Final = Path(__file__).parents[2] / "fixtures"

WHOLE: Final = ("groove", "conjugate_lever", "swallow_tail")

WITHOUT_DISC: Final = sorted((FIXTURES / "refused").glob("*.toml"))


@pytest.mark.parametrize(
    "path",
    [*(FIXTURES / "scenes" / f"{name}.toml" for name in WHOLE), *WITHOUT_DISC],
    ids=lambda path: path.stem,
)
def test_what_turns_stays_in_the_window(path: Path) -> None:
    """So do flanks that are undercut, with the signs on them, and the pitch curve around a disc."""
    turn = animation(camgeo.load(path).disc)
    areas = [mark for mark in turn.turning if isinstance(mark, Area)]
    lines = [mark for mark in turn.turning if isinstance(mark, Line)]
    points = np.concatenate(
        [*(ring for mark in areas for ring in mark.rings), *(mark.points for mark in lines)]
    )
    reach = float(np.hypot(*points.T).max())
    assert bool(turn.note) == (path in WITHOUT_DISC)
    assert max(turn.low.real, turn.low.imag, -turn.high.real, -turn.high.imag) <= -reach


TURNS: Final = ("scenes/setzhub", "scenes/groove", "scenes/conjugate_lever", "scenes/tappet",
                "effects/yoke", "refused/global_undercut")  # fmt: skip


def test_turns_are_as_kept() -> None:
    """What turns, slides and rocks, mark by mark and place by place, and in a drag."""
    kept.compare(
        "figure/turns.txt",
        (
            (f"{name}{', moving' if moving else ''}", kept.marks(animation(disc, moving=moving)))
            for name in TURNS
            for disc in [camgeo.load(FIXTURES / f"{name}.toml").disc]
            for moving in (False, True)
        ),
    )


# Cut off ------------------------------------------------------------------------------------------
# The picture of a cam shows the real disc, with what is cut off or would be.


CORNERS = {"swallow_tail": 1, "cut_lobe": 1, "trimmed_ring": 2, "straight_moves": 2}
TRIMMED = sorted(CORNERS)


def edited(scene: str, **edits: Any) -> Design:
    """The design of a scene with other values."""
    return Design(load_scene(FIXTURES / "scenes" / f"{scene}.toml").with_values(edits))


def drawn(design: Any) -> Axes:
    """The picture's axes."""
    (axes,) = drawing.drawn(cam.figure(design)).axes
    return axes


def labels(axes: Axes) -> set[str]:
    legend = axes.get_legend()
    assert legend is not None
    return {text.get_text() for text in legend.get_texts()}


def inset(axes: Axes) -> Axes | None:
    found = [child for child in axes.child_axes if isinstance(child, Axes)]
    assert len(found) <= 1
    return found[0] if found else None


def dashed(axes: Axes) -> list[ComplexArray]:
    """The lines drawn as cut off."""
    lines = [line for line in axes.lines if line.get_color() == cam.CUT]
    rows = [np.asarray(line.get_xydata()) for line in lines if line.get_marker() == "None"]
    return [row[:, 0] + 1j * row[:, 1] for row in rows]


@pytest.mark.parametrize("scene", TRIMMED)
def test_what_is_cut_off_begins_and_ends_in_the_corner(scene: str) -> None:
    design = camgeo.load(FIXTURES / "scenes" / f"{scene}.toml")
    found = design.disc.pictured.trimmed_stretches
    assert len(found) == CORNERS[scene]
    for each in found:
        assert each.course[0] == each.course[-1] == each.corner
        # The flank continues from the corner without a jump: no step is much longer than others.
        steps = np.abs(np.diff(each.course))
        assert np.max(steps) < 0.02 * np.sum(steps)
        for phi in (each.start, each.end):
            (x, y), *_ = design.disc.pictured.curve(each.flank, np.array([phi]))
            assert abs(complex(x, y) - each.corner) < 1e-9
    for each in found:
        assert 0.0 <= each.start < TURN
        assert each.start < each.end < each.start + TURN


def test_the_corner_is_that_of_the_hard_case() -> None:
    (found,) = camgeo.load(
        FIXTURES / "scenes" / "swallow_tail.toml"
    ).disc.pictured.trimmed_stretches
    _, expected = hard_case("HC21c")
    x, y = map(float, expected["crossing_point"])
    assert abs(found.corner - complex(x, y)) < 1e-12
    assert np.degrees(found.start) == pytest.approx(float(expected["crossing_phi1_deg"]), abs=1e-9)
    assert np.degrees(found.end) == pytest.approx(float(expected["crossing_phi2_deg"]), abs=1e-9)


@pytest.mark.parametrize("scene", ["swallow_tail", "trimmed_ring", "straight_moves"])
def test_none_of_a_tail_is_farther_from_the_pitch_curve_than_the_roller(scene: str) -> None:
    design = camgeo.load(FIXTURES / "scenes" / f"{scene}.toml")
    rows = design.disc.pictured.curve("pitch", np.linspace(0.0, TURN, 100_000, endpoint=False))
    pitch = DensePath(rows[:, 0] + 1j * rows[:, 1])
    for each in design.disc.pictured.trimmed_stretches:
        away = pitch.distances(each.course) - design.cam.follower.roller_radius
        # The chord that bridges a corner of the pitch curve is 7e-3 mm long, and less is it off;
        # elsewhere chords are 1e-6 mm off.
        assert np.max(away) < 7e-3 * (scene == "straight_moves") + 1e-6
        assert np.min(away) < -1e-4


@pytest.mark.parametrize("scene", TRIMMED)
def test_a_refused_cam_shows_what_would_be_cut_off(scene: str) -> None:
    design = edited(scene, **{"limits.undercut": "refuse"})
    axes = drawn(design.disc)
    assert {"flanks", "would be cut off", "corner"} <= labels(axes)
    assert "edges of the disc" not in labels(axes)
    assert "no outline: undercut" in {text.get_text() for text in axes.texts}
    assert len(dashed(axes)) == CORNERS[scene]


@pytest.mark.parametrize(
    ("radius", "label"),
    [("26", "undercut"), ("14.1365177403931773714700629489", "cusp")],
    ids=["over-the-axis", "cusp"],
)
def test_undercut_of_which_nothing_can_be_cut_off(radius: str, label: str) -> None:
    """A roller larger than the base circle leaves no disc; a cusp has no loop."""
    edits = {"limits.undercut": "refuse", "follower.roller_radius": Decimal(radius)}
    design = edited("swallow_tail", **edits)
    assert design.disc.pictured.trimmed_stretches == ()
    axes = drawn(design.disc)
    assert label in labels(axes)
    assert inset(axes) is None


def test_a_tail_below_all_digits_is_only_marked() -> None:
    """HC21b: 1.5e-8 mm wide."""
    radius = Decimal("14.136531876910917764647434419")
    axes = drawn(edited("swallow_tail", **{"follower.roller_radius": radius}).disc)
    assert "corner" in labels(axes)
    assert inset(axes) is None


def test_a_whole_disc_has_no_such_entries() -> None:
    assert labels(drawn(StubProduct())) == {
        "edges of the disc",
        "pitch curve",
        "base circle",
        "roller at φ = 0",
    }


@attack
@given(
    radii=st.lists(st.floats(0.2, 3.0), min_size=3, max_size=24),
    x=st.floats(-2.0, 2.0),
    y=st.floats(-2.0, 2.0),
    width=st.floats(0.1, 5.0),
)
def test_clipping_keeps_the_area_within(
    radii: list[float], x: float, y: float, width: float
) -> None:
    """Of stars, against shapely; also where the star falls apart."""
    ring = np.array(radii) * np.exp(1j * TURN * np.arange(len(radii)) / len(radii))
    half = 0.5 * width
    wanted = polygon(ring).intersection(shapely.box(x - half, y - half, x + half, y + half)).area
    found = cam.clipped(ring, complex(x, y), width)
    area = 0.5 * float(np.sum((found.conj() * np.roll(found, -1)).imag)) if len(found) else 0.0
    assert area == pytest.approx(wanted, abs=1e-12 * 30.0)
