"""Moments and radii of paths and contours: closed forms, invariants, dense points of the same
curves; and whether paths go round the cam axis."""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import camgeo
from camgeo.design.design import Design
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.outline.outline import find_crossings, real_outline
from camgeo.geometry.outline.path import (
    ROUNDING,
    Path,
    Pivot,
    SecondMoments,
    area,
    radii,
    whole,
)
from camgeo.geometry.pitch_curve import PitchCurve, WorkingCurve
from camgeo.kinematics.mechanism.rollers import TranslatingRoller
from camgeo.kinematics.motion import Jet, MergedDwell
from camgeo.kinematics.plan import MotionPlan
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side
from camgeo.scene.scene import parse_scene
from tests.contour.cams import SCENES, dwell, move
from tests.contour.paths import PATHS, dense_path, hard_curve
from tests.effects.scenes import design
from tests.outline.clearing import dense


@dataclass(frozen=True, slots=True)
class EccentricCircle:
    """The lift over an eccentric disc: q = e cos phi + sqrt(R^2 - e^2 sin^2 phi) - (e + R)."""

    eccentricity: float
    radius: float
    breaks: FloatArray
    dwells: tuple[MergedDwell, ...] = ()

    @property
    def borders(self) -> FloatArray:
        return self.breaks

    def jet(self, phi: FloatArray, side: Side = "right", order: int = 3) -> Jet:
        e, sine, cosine = self.eccentricity, np.sin(phi), np.cos(phi)
        w = np.sqrt(self.radius**2 - (e * sine) ** 2)
        # w w' = -e^2 s c, and this once and twice more by phi
        w1 = -e * e * sine * cosine / w
        w2 = (-e * e * (cosine**2 - sine**2) - w1 * w1) / w
        w3 = (4.0 * e * e * sine * cosine - 3.0 * w1 * w2) / w
        return np.stack(
            (
                e * cosine + w - (e + self.radius),
                w1 - e * sine,
                w2 - e * cosine,
                w3 + e * sine,
            )
        )

    def jet_and_bounds(self, low: FloatArray, high: FloatArray) -> tuple[Jet, Jet]:
        raise NotImplementedError


def eccentric(
    eccentricity: float, radius: float, rotation: int = 1, guide: float = 0.0, roller: float = 8.0
) -> Path:
    """The inner outline of an eccentric disc."""
    motion = EccentricCircle(eccentricity, radius + roller, np.array([0.3, 2.0]))
    follower = TranslatingRoller(eccentricity + radius + roller, roller, guide_angle=guide)
    return whole(WorkingCurve(PitchCurve(motion, follower, rotation), -roller))


@pytest.mark.parametrize("rotation", [1, -1])
@pytest.mark.parametrize("eccentricity", [0.0, 1e-6, 5.0, 30.0])
def test_an_eccentric_disc_has_the_moments_of_its_circle(
    eccentricity: float, rotation: int
) -> None:
    path, away = eccentric(eccentricity, 40.0, rotation, guide=0.7), cmath.rect(eccentricity, 0.7)
    found = path.moments(1e-13).counter_clockwise()
    exact = math.pi * 40.0**2
    assert abs(found.area - exact) <= found.area_error
    assert abs(found.first - exact * away) <= found.first_error
    assert found.area_error < 2e-13 * exact + ROUNDING * 3.0 * exact
    assert found.first_error < 1e-12 * exact * (40.0 + eccentricity)
    # Steiner: the area times the square of the distance, in its direction twice.
    second = path.second_moments(1e-12).counter_clockwise()
    polar = 0.5 * exact * 40.0**2 + exact * eccentricity**2
    assert abs(second.polar - polar) <= second.polar_error < 1e-11 * polar
    assert abs(second.square - exact * away * away) <= second.square_error + 1e-12 * polar
    assert second.square_error < 1e-11 * polar
    turned = path.second_moments(1e-12).scaled(-2.0).counter_clockwise()
    assert turned.polar == pytest.approx(2.0 * second.polar, rel=1e-14)
    assert turned.square == pytest.approx(2.0 * second.square, rel=1e-13, abs=1e-9 * polar)
    assert turned.polar_error == pytest.approx(2.0 * second.polar_error)
    assert turned.square_error == pytest.approx(2.0 * second.square_error)


def test_the_error_estimate_holds_at_every_tolerance() -> None:
    """A disc that hardly holds the axis: the lift turns round fast, so that parts are halved."""
    path = eccentric(39.9, 40.0, roller=0.01)
    exact = -math.pi * 40.0**2
    reported = []
    for tolerance in (1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12):
        found = path.moments(tolerance)
        assert abs(found.area - exact) <= found.area_error
        assert abs(found.first - exact * 39.9) <= found.first_error
        reported.append(found.first_error / (abs(exact) * 80.0))
        assert reported[-1] <= 3.0 * tolerance + 10.0 * ROUNDING
    assert reported[-1] < 1e-4 * reported[0]


STEEP = """
camgeo = 1
name = "steep"
cam = { rotation = "cw" }
follower = { kind = "translating-roller", base_radius = 30.0, roller_radius = 3.0 }
motion = [
    { law = "polynomial-345", span = 0.12, to = 10.0 },
    { law = "polynomial-345", span = 359.88, to = 0.0 },
]
limits = { undercut = "trim" }
"""
"""The tangent turns nearly round and back within thousandths of a degree of the cam angle."""


@pytest.mark.parametrize(
    "scene",
    [
        "plate_translating",
        "groove",
        "cut_lobe",
        "swallow_tail",
        "trimmed_ring",
        "straight_moves",
        "steep",
    ],
)
def test_a_polygon_within_a_tolerance_has_moments_within_what_it_allows(scene: str) -> None:
    """Two outlines within t of each other enclose areas that differ by length * t at most, and
    first moments by that times the largest radius."""
    import shapely

    tolerance = 1e-3
    made = Design(parse_scene(STEEP)) if scene == "steep" else design(scene, "")
    for boundary in made.disc.drawn.part.boundaries:
        if not hasattr(boundary, "path"):
            continue
        found = boundary.path.moments(1e-10).counter_clockwise()
        assert abs(area(boundary.path)) == pytest.approx(found.area, rel=1e-9)
        fit = boundary.polyline(tolerance, "fast")
        chords = shapely.Polygon(
            np.column_stack((fit.contour.vertices.real, fit.contour.vertices.imag))
        )
        room = 2.0 * fit.contour.length * tolerance
        largest = float(np.max(np.abs(fit.contour.vertices))) + tolerance
        assert abs(chords.area - found.area) <= room
        centre = complex(chords.centroid.x, chords.centroid.y)
        assert abs(centre * chords.area - found.first) <= room * largest
        arcs = boundary.arcs(tolerance, "fast").contour.moments.counter_clockwise()
        assert abs(arcs.first - found.first) <= room * largest


def test_a_half_disc_has_its_centroid_at_four_thirds_of_the_radius_over_pi() -> None:
    half = Contour(np.array([3.0 + 0j, -3.0 + 0j]), np.array([math.pi, 0.0]), np.array([0j, 0j]))
    found = half.moments
    assert found.area == pytest.approx(4.5 * math.pi, rel=1e-15)
    assert found.first / found.area == pytest.approx(4.0j / math.pi, rel=1e-15)


places = st.complex_numbers(max_magnitude=100.0, allow_nan=False, allow_infinity=False)


@settings(max_examples=50, deadline=None)
@given(
    centre=places,
    radius=st.floats(0.1, 50.0),
    cuts=st.lists(st.floats(0.05, 6.2), min_size=1, max_size=6, unique=True),
)
def test_a_circle_in_any_arcs_is_a_circle(
    centre: complex, radius: float, cuts: list[float]
) -> None:
    angles = np.array([0.0, *sorted(cuts)])
    vertices = np.asarray(centre + radius * np.exp(1j * angles), dtype=np.complex128)
    sweeps = np.diff(angles, append=2.0 * math.pi)
    found = Contour(vertices, sweeps, np.full(len(angles), complex(centre))).moments
    size = math.pi * radius * radius
    # vertices are rounded to the size of the circle and its place
    room = 1e-14 * (radius + abs(centre)) ** 2
    assert abs(found.area - size) <= 10.0 * room
    assert abs(found.first - size * centre) <= 10.0 * room * (radius + abs(centre))


@pytest.mark.parametrize("sweep", [1e-12, 1e-9, 1e-6, 1e-4, 1e-2, 0.09, 0.11, 1.0])
def test_moments_of_flat_arcs_are_within_their_errors(sweep: float) -> None:
    """A square with bent sides: its centroid stays, and the circles may be huge."""
    middle = 50.5 + 0.5j
    corners = [-1.0 - 1.0j, 1.0 - 1.0j, 1.0 + 1.0j, -1.0 + 1.0j]
    vertices: ComplexArray = middle + 0.5 * np.array(corners, dtype=np.complex128)
    sides = np.roll(vertices, -1) - vertices
    centres = vertices + 0.5 * sides * (1.0 + 1.0j / math.tan(0.5 * sweep))
    found = Contour(vertices, np.full(4, sweep), centres)
    with mpmath.workdps(60):
        a = mpmath.mpf(sweep)
        area = float(1 + (a - mpmath.sin(a)) / (1 - mpmath.cos(a)))
    assert abs(found.moments.area - area) <= found.moments.area_error
    assert abs(found.moments.first - area * middle) <= found.moments.first_error
    assert found.area == pytest.approx(area, rel=1e-15)


def test_run_the_other_way_everything_changes_its_sign() -> None:
    vertices = np.array([2.0, -1.0 + 1.0j, 1.0j], dtype=np.complex128)
    contour = Contour(vertices, np.array([math.pi, 0.0, 0.0]),
                      np.array([0.5 + 0.5j, 0.0, 0.0]))  # fmt: skip
    one, other = contour.moments, contour.reversed().moments
    assert other.area == pytest.approx(-one.area, rel=1e-15)
    assert other.first == pytest.approx(-one.first, rel=1e-15)
    assert other.counter_clockwise().first == pytest.approx(one.first, rel=1e-15)


def test_second_moments_of_lines_and_arcs_are_those_of_fine_triangles() -> None:
    """A D of half a circle of 3 mm about 2 + 1j and its chord, and three quarters of a turn."""
    for sweep in (math.pi, 1.5 * math.pi, -0.5 * math.pi):
        centre, first = 2.0 + 1.0j, 3.0 * cmath.exp(0.4j)
        start, end = centre + first, centre + first * cmath.exp(1j * sweep)
        found = SecondMoments.of_pieces(
            np.array([start, end]), np.array([end, start]), np.array([sweep, 0.0]),
            np.array([centre, 0j]),
        )  # fmt: skip
        along = start + (centre + first * np.exp(1j * sweep * np.linspace(0, 1, 40_001)) - start)
        one, two = along[:-1] - start, along[1:] - start
        signed = 0.5 * (np.conj(one) * two).imag
        a, b, c = start, along[:-1], along[1:]
        polar = np.sum(
            signed / 12.0 * (abs(a) ** 2 + np.abs(b) ** 2 + np.abs(c) ** 2 + np.abs(a + b + c) ** 2)
        )
        square = np.sum(signed / 12.0 * (a * a + b * b + c * c + (a + b + c) ** 2))
        assert found.polar == pytest.approx(float(polar), rel=1e-7)
        assert found.square == pytest.approx(complex(square), rel=1e-7)


def scene_paths() -> dict[str, Path]:
    """Outlines of guides and rockers, with pieces that are cut off, and parallels outside them."""
    found: dict[str, Path] = {}
    for scene in ("schnitt", "cut_lobe", "straight_moves", "points", "crank_slider"):
        path = camgeo.load(SCENES / f"{scene}.toml").cam.disc.outline("inner").path
        found |= {scene: path, f"{scene} by 3 mm": path.offset(3.0)}
    return found


@pytest.mark.parametrize("path", [*PATHS.values(), *scene_paths().values()],
                         ids=[*PATHS, *scene_paths()])  # fmt: skip
def test_no_point_is_nearer_or_farther(path: Path) -> None:
    made = path() if callable(path) else path
    found, points = radii(made), np.abs(dense_path(made, 20_000))
    # Dense points are 0.02 mm apart: of a bend of 10 mm at an extreme 5e-6 mm are left out.
    assert found.lowest.value == pytest.approx(float(np.min(points)), abs=2e-5)
    assert found.highest.value == pytest.approx(float(np.max(points)), abs=2e-5)
    assert found.lowest.value <= np.min(points) + 1e-9
    assert found.highest.value >= np.max(points) - 1e-9
    assert made.encloses_axis
    for end in (found.lowest, found.highest):
        assert 0.0 <= end.place < 2.0 * math.pi


@pytest.mark.parametrize("centre", [0j, 30.0 - 12.0j, 3.0 + 1.0j, 9.999j, 10.001j])
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_a_ring_of_arcs(centre: complex, sense: float) -> None:
    """Three arcs of a circle of 10 mm: round the axis if that is nearer to its centre, however near
    it is to the circle.
    """
    sweeps = sense * np.array([1.0, 2.5, 2.0 * math.pi - 3.5])
    starts = 0.4 + np.concatenate(([0.0], np.cumsum(sweeps)[:-1]))
    path = Path(
        tuple(
            Pivot(centre, 10.0, cmath.exp(1j * float(start)), float(sweep), 0.0, 0.0)
            for start, sweep in zip(starts, sweeps, strict=True)
        )
    )
    found = radii(path)
    away = abs(centre)
    assert found.lowest.value == pytest.approx(abs(10.0 - away), abs=1e-12)
    assert found.highest.value == pytest.approx(10.0 + away, abs=1e-12)
    assert path.encloses_axis == (away < 10.0)


def test_an_arc_that_does_not_reach_the_line_through_its_centre_is_extreme_at_its_ends() -> None:
    for start, sweep in ((0.3, 1.0), (2.0, -0.9), (-2.0, 1.2)):
        arc = Pivot(20.0 + 0j, 5.0, cmath.exp(1j * start), sweep, 0.0, 0.0)
        ends = sorted((abs(arc.start), abs(arc.end)))
        found = radii(Path((arc,)))
        assert [found.lowest.value, found.highest.value] == pytest.approx(ends, abs=1e-12)


def test_a_lobe_that_falls_away_does_not_go_round_the_axis() -> None:
    outline = real_outline(hard_curve("HC22"))
    assert outline.path.encloses_axis
    (lobe,) = outline.lobes
    assert not lobe.encloses_axis
    points = np.abs(dense(lobe, 4001))
    assert radii(lobe).highest.value == pytest.approx(float(np.max(points)), abs=1e-3)


def test_a_flank_that_lies_on_itself_is_not_decided() -> None:
    """Rests at 40 and 60 mm half a turn apart: 50 mm inside of both lies the same arc of 10 mm."""
    plan = MotionPlan((dwell(60), move(120, 20.0), dwell(60), move(120, 0.0)))
    pitch = PitchCurve(plan, TranslatingRoller(40.0, 5.0), 1)
    with pytest.raises(camgeo.CamgeoError, match=r"lie on each other|too close to be separated"):
        find_crossings(WorkingCurve(pitch, -50.0))
    found = find_crossings(WorkingCurve(pitch, -49.0))
    assert found
    for crossing in found:
        ends = WorkingCurve(pitch, -49.0).point(np.array([crossing.first, crossing.second]))
        assert np.max(np.abs(ends - crossing.point)) <= 1e-10


def test_a_parallel_that_runs_back_all_round_does_not_cross_itself() -> None:
    pitch = PitchCurve(MotionPlan((dwell(360),)), TranslatingRoller(10.0, 5.0), 1)
    assert find_crossings(WorkingCurve(pitch, -12.0)) == ()
