"""`camgeo replay` on files of others: those on which earlier versions failed, and splines."""

from __future__ import annotations

import math
from decimal import Decimal
from pathlib import Path

import ezdxf
import numpy as np
import pytest

import camgeo
from camgeo.app.answers.replay import ARCS, FollowerReplay, Reading, replay
from camgeo.app.cli.main import main
from camgeo.design.design import Design
from camgeo.errors import CamgeoError, SceneError
from camgeo.geometry.contour.spline import SplineContour
from camgeo.geometry.outline.path import Flank
from camgeo.geometry.outline.replay import replay_spline
from camgeo_export.dxf.reader import READER
from camgeo_export.dxf.writer import WRITER
from tests.answers.documents import FIXTURES, document

FOUND = FIXTURES / "found" / "drawings"

PLATE = FIXTURES / "scenes" / "plate_translating.toml"

PHI = np.radians(np.arange(0.0, 360.0, 7.5))


def replayed(scene: Path, file: Path, origin: complex = 0j) -> FollowerReplay:
    return replay(camgeo.load(scene), [file], step=Decimal(1), reading=Reading(origin=origin))


@pytest.mark.parametrize("name", ["hidden_off", "hidden_frozen", "hidden_invisible"])
def test_what_is_not_shown_is_not_read(name: str) -> None:
    """The circle of 20 mm inside of the cam was taken for its bore."""
    (disc,) = replayed(PLATE, FOUND / f"{name}.dxf").discs
    assert disc.note == ""
    (told,) = disc.notes
    assert "1 entity not read that the drawing does not show" in told


def test_a_foreign_contour_is_at_fault_and_not_the_scene(tmp_path: Path) -> None:
    drawing = tmp_path / "shaft2.dxf"
    drawing.write_bytes((FOUND / "shaft2.dxf").read_bytes())
    assert main(["verify", str(drawing), "--scene", str(PLATE)]) == 1
    text = (tmp_path / "verification.json").read_text()
    assert "the contour cannot be compared with the exact curve near X" in text
    assert "span" not in text
    aside = tmp_path / "aside.csv"
    aside.write_text("x;y\n3;-1\n5;-1\n5;1\n3;1\n")
    with pytest.raises(SceneError, match=r"CONTOUR = .*aside.csv: does not go round the cam axis"):
        replayed(PLATE, aside)


def test_rows_of_x_y_z_are_no_bulges() -> None:
    with pytest.raises(CamgeoError, match=r"line 1: .* 3 columns; without a heading 2 are allowed"):
        replayed(PLATE, FOUND / "xyz_as_bulge.csv")


@pytest.mark.parametrize(
    ("name", "axis", "within"), [("c22_cv", 0j, 2e-5), ("c22_shift", 100 + 50j, 3e-3)]
)
def test_a_flat_face_lies_on_the_hull_of_any_drawing(
    name: str, axis: complex, within: float
) -> None:
    """Points of the outline by ezdxf, whose paths replace arcs by cubics up to 3e-4 of the radius
    off; of all the farthest along the face's normal holds it.
    """
    (disc,) = replayed(FOUND / "flat_dwell.toml", FOUND / f"{name}.dxf", axis).discs
    document = ezdxf.readfile(FOUND / f"{name}.dxf")  # type: ignore[attr-defined]  # not declared
    paths = [ezdxf.path.make_path(each) for each in document.modelspace()]
    places = (place for path in paths for place in path.flattening(1e-5))
    points = [complex(each.x, each.y) - axis for each in places]
    lift = disc.replay.lift.displacement(PHI)
    # The cam turns clockwise under a face whose normal stays: seen from the cam it turns the other
    # way, from the direction that it has at cam angle 0.
    base = camgeo.load(FOUND / "flat_dwell.toml").cam.follower.base_radius
    normals = [1j * np.exp(1j * PHI), np.exp(1j * PHI)]
    held = [np.max((np.conj(n)[:, None] * np.array(points)).real, axis=1) - base for n in normals]
    assert min(np.max(np.abs(each - lift)) for each in held) <= within


def test_an_axis_elsewhere_is_proposed_by_the_bore(capsys: pytest.CaptureFixture[str]) -> None:
    words = ["replay", str(FOUND / "flat_dwell.toml"), str(FOUND / "c22_shift.dxf")]
    assert main(words) == 2
    assert "its bore is centred on (100, 50) mm: --origin 100 50" in capsys.readouterr().err
    assert main([*words, "--origin", "100", "50"]) == 0
    assert main([*words, "--origin", "99.5", "-50"]) == 2
    assert main([*words, "--origin", "99.5", "50"]) == 0
    told = capsys.readouterr().err.splitlines()[-1]
    assert told.startswith("c22_shift.dxf: its bore is centred on (0.5, 0) mm: --origin")


@pytest.fixture(scope="module")
def splined(tmp_path_factory: pytest.TempPathFactory) -> tuple[Design, Path, SplineContour]:
    """A plate cam, its drawing of splines, and the outline in it."""
    scene = camgeo.load(PLATE).scene.with_values({"output.dxf.entity": "spline"})
    design = Design(scene)
    data = WRITER.write(design.disc, 1e-3).data
    drawing = tmp_path_factory.mktemp("drawings") / "plate.dxf"
    drawing.write_bytes(data)
    outline = READER.read(data, "a.dxf", layer=None, unit=None, gap=0.0).contours[0]
    assert isinstance(outline, SplineContour)
    return design, drawing, outline


def test_splines_that_camgeo_writes_are_replayed_exactly(
    splined: tuple[Design, Path, SplineContour],
) -> None:
    design, drawing, outline = splined
    found = replay(design, [drawing], step=Decimal(1))
    exact = replay_spline(design.cam.disc.pitch_curve, outline, Flank.INNER)
    (disc,) = found.discs
    assert np.array_equal(disc.replay.lift.jet(PHI), exact.lift.jet(PHI))
    assert disc.notes == ()
    assert abs(disc.lift_error.value) <= 1.5e-3
    assert document(found)["discs"][0]["notes"] == []


def test_splines_where_the_roller_does_not_fit_are_followed_by_arcs(tmp_path: Path) -> None:
    """A hollow of radius 8 under a roller of 10: the roller rests on its edges."""
    drawing = tmp_path / "hollow.dxf"
    sheet = ezdxf.new(units=4)  # type: ignore[attr-defined]  # not declared
    space = sheet.modelspace()
    edge = math.asin(8.0 / 50.0)
    ends = [(50.0 * math.cos(t), 50.0 * math.sin(t)) for t in (edge, -edge)]
    space.add_arc((0, 0), 50.0, math.degrees(edge), -math.degrees(edge))
    (x, y), below = ends
    space.add_open_spline([(x, y), (x - 11.0, y), (x - 11.0, -y), below])
    sheet.saveas(drawing)
    (disc,) = replayed(PLATE, drawing).discs
    assert disc.notes[-1] == f"hollow.dxf: splines are approximated by arcs within {ARCS:g} mm"
    # The centre of the roller, 10 mm from both edges, on the path at 12 mm from the axis.
    centre = 50.0 * math.cos(edge) + math.sqrt(10.0**2 - 8.0**2)
    lowest = math.sqrt(centre**2 - 12.0**2) - math.sqrt(50.0**2 - 12.0**2)
    lift = disc.replay.lift.displacement(np.radians(np.arange(0.0, 360.0, 0.01)))
    assert lift.min() == pytest.approx(lowest, abs=2e-3)
