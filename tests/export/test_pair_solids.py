"""The solids of a conjugate pair in one piece: closed, of the exact volume, and in time."""

from __future__ import annotations

import io
import math
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import shapely
import trimesh

import camgeo
from camgeo.design.product import Product
from camgeo.design.verify import Reading
from camgeo.design.writing import Writer
from camgeo.part.mass import solid
from camgeo_export.step.writer import WRITER as STEP
from camgeo_export.stl import WRITER as STL
from camgeo_export.threemf.writer import WRITER as THREEMF
from camgeo_export.verify.step import StepVerifier

PAIR = Path(__file__).parents[2] / "fixtures" / "pairs" / "conjugate_pair.toml"

TOLERANCE = 0.01


@cache
def made(upper: str = "main") -> tuple[camgeo.Design, Product]:
    scene = camgeo.load(PAIR).scene.with_values({"part.pair.upper": upper})
    design = camgeo.Design(scene)
    assert design.disc.pair is not None
    return design, design.disc.pair


@pytest.mark.parametrize("upper", ["main", "return"])
@pytest.mark.parametrize("writer", [STL, THREEMF, STEP], ids=["stl", "3mf", "step"])
def test_it_is_one_solid_of_the_exact_volume(writer: Writer, upper: str) -> None:
    _, pair = made(upper)
    exact = solid(pair.drawn.part)
    written = writer.write(pair, TOLERANCE)
    deviation = writer.measure(pair, written.data)
    assert deviation is not None
    assert deviation <= TOLERANCE
    # all faces are within the tolerance, and none is larger than 4 discs of 60 mm are
    slack = TOLERANCE * 4.0 * math.pi * 60.0 * (60.0 + 10.0)
    assert float(written.facts["volume_mm3"]) == pytest.approx(exact.volume, abs=slack)


def test_the_step_file_has_the_faces_that_are_counted() -> None:
    """A face for each piece of a wall; of flat ones, one at each of eight heights and the floors of
    two marks; the faces between discs and spacer name their disc."""
    _, pair = made()
    written = STEP.write(pair, TOLERANCE)
    text = written.data.decode()
    names = [line.split("'")[1] for line in text.splitlines() if "ADVANCED_FACE(" in line]
    assert len(names) == written.facts["faces"]
    for name in ("upper face of the return disc", "lower face of the disc", "spacer", "lower hub"):
        assert name in names
    assert names.count("mark") == 8  # two slots with two sides and two ends
    checks = StepVerifier().checks(pair, written.data, Reading("x.step"), TOLERANCE)
    assert all(check.ok is not False for check in checks)


@pytest.mark.parametrize("upper", ["main", "return"])
def test_both_rollers_touch_their_discs_at_every_cam_angle(upper: str) -> None:
    """Sections of the mesh at the middle of each disc, turned with the shaft: the rollers of the
    rigid lever touch both at once. A return disc that is 0.5 degrees off would miss by 0.1 mm."""
    design, pair = made(upper)
    written = STL.write(pair, TOLERANCE)
    mesh = trimesh.load_mesh(io.BytesIO(written.data), file_type="stl")
    assert mesh.is_watertight
    assert mesh.body_count == 1
    low = {"main": (36.0, 17.0), "return": (17.0, 36.0)}[upper]
    phi = np.linspace(0.0, 2.0 * math.pi, 41)[:-1] + 0.01
    lift = design.drive.motion.jet(phi)[0]
    for cam, z in zip(design.cams, low, strict=True):
        section = mesh.section(plane_origin=[0.0, 0.0, z], plane_normal=[0.0, 0.0, 1.0])
        assert section is not None
        rings = [shapely.Polygon(ring[:, :2]) for ring in section.discrete]
        outline = max(rings, key=lambda ring: ring.area)
        centres = [cam.follower.traced_point(each) for each in lift.tolist()]
        turned = np.array(centres) * np.exp(-1j * cam.rotation * phi)
        apart = [outline.exterior.distance(shapely.Point(p.real, p.imag)) for p in turned.tolist()]
        assert np.max(np.abs(np.array(apart) - cam.follower.roller_radius)) <= TOLERANCE
        off = turned * np.exp(1j * math.radians(0.5))
        wrong = [outline.exterior.distance(shapely.Point(p.real, p.imag)) for p in off.tolist()]
        assert np.max(np.abs(np.array(wrong) - cam.follower.roller_radius)) > 0.1
