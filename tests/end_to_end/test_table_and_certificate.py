"""CSV, pictures and certificate of each fixture scene."""

from __future__ import annotations

import csv
import hashlib
from functools import partial
from xml.etree import ElementTree as ET

import numpy as np

from camgeo.design.design import Design
from camgeo.kinematics.mechanism.flat import OscillatingFlat, TranslatingFlat
from camgeo.numeric.arrays import ComplexArray, FloatArray, phase
from camgeo.scene.formats.csv import FORMAT
from camgeo.scene.scene import load_scene
from camgeo.units import MM_PER
from tests.end_to_end.built import SCENES, Built

PNG = b"\x89PNG\r\n\x1a\n"


BROKEN = {
    "swallow_tail": {"radius-ratio-inner", "undercut-inner", "lost-stroke-inner"},
    "cut_lobe": {"global-undercut-inner", "lobe-inner", "lost-stroke-inner"},
    "trimmed_ring": {"radius-ratio-outer", "undercut-outer", "lost-stroke-outer"},
    "straight_moves": {"lost-stroke-inner", "tangent-closure", "shock"},
    "knife_edge": {"tangent-closure", "shock"},
}
"""The limits that only trimmed scenes break."""


def test_table_holds_the_values_of_the_design(built: Built) -> None:
    with built.file(".csv").open(newline="") as file:
        rows = list(csv.reader(file))
    names, values = rows[0], np.array(rows[1:], dtype=np.float64)
    columns = dict(zip(names, values.T, strict=True))
    degrees = columns["phi [deg]"]
    step = float(built.design.scene.output.options[FORMAT].step)
    assert np.array_equal(degrees, step * np.arange(round(360.0 / step)))
    phi = np.radians(degrees)
    design, unit, mm = built.design, built.design.scene.unit, MM_PER[built.design.scene.unit]
    curves = {
        name: partial(design.disc.pictured.curve, name) for name in ("pitch", "inner", "outer")
    }
    if not design.cam.follower.has_pitch_curve:
        curves = {"contact": curves["pitch"]}
        # The contact lies where the face does, turned back by the cam angle.
        contact = (
            design.disc.pictured.curve("pitch", phi)
            @ [1.0, 1j]
            * np.exp(1j * design.cam.rotation * phi)
        )
        foot = _foot_and_direction(design, phi)
        placed = foot[0] + foot[1] * columns[f"on face [{unit}]"] * mm
        assert np.max(np.abs(contact - placed)) <= 1e-12 * design.cam.follower.base_radius
    for name, curve in curves.items():
        points = curve(phi)
        assert np.array_equal(columns[f"{name} x [{unit}]"] * 1.0, points[:, 0] / mm)
        assert np.array_equal(columns[f"{name} y [{unit}]"] * 1.0, points[:, 1] / mm)
    assert np.array_equal(
        columns["mu [deg]"], np.degrees(design.cam.disc.pitch_curve.transmission_angle(phi))
    )
    assert np.array_equal(
        columns[f"kappa [1/{unit}]"], design.cam.disc.pitch_curve.curvature(phi) * mm
    )
    rates = ("", "/rad", "/rad^2", "/rad^3")
    if f"s [{unit}]" in columns:
        for order, rate in enumerate(rates):
            mark = "'" * order
            # Behind a linkage whose crank is turned, the slider is the follower.
            motion = (
                design.drive.plan.jet(phi)
                if design.drive.unit == "mm"
                else design.drive.motion.jet(phi)
            )
            assert np.array_equal(columns[f"s{mark} [{unit}{rate}]"], motion[order] / mm)
    assert ("psi [deg]" in columns) == (design.cam.lift_unit == "rad")
    if design.cam.lift_unit == "rad":
        assert np.array_equal(columns["psi [deg]"], np.degrees(design.drive.motion.jet(phi)[0]))


def _foot_and_direction(design: Design, phi: FloatArray) -> tuple[ComplexArray, ComplexArray]:
    """From where a flat face counts, and its direction, both in the fixed frame."""
    follower, lift = design.cam.follower, design.drive.motion.jet(phi)[0]
    if isinstance(follower, TranslatingFlat):
        out = np.exp(1j * follower.guide_angle)
        return out * (follower.base_radius + follower.direction * lift), -1j * out + 0.0 * phi
    assert isinstance(follower, OscillatingFlat)
    along = np.exp(1j * (phase(-follower.pivot) + follower.arm_side * follower.face_angle(lift)))
    return follower.pivot + 1j * follower.arm_side * follower.face_offset * along, along


def test_table_has_the_motion_in_time(built: Built) -> None:
    """Of a disc that turns unevenly differences of the columns themselves over time must agree,
    h^2/6 of the next but one derivative apart.
    """
    with built.file(".csv").open(newline="") as file:
        rows = list(csv.reader(file))
    columns = dict(zip(rows[0], np.array(rows[1:], dtype=np.float64).T, strict=True))
    course = built.design.drive.time_course
    assert ("t [s]" in columns) == (course is not None)
    if built.design.scene.speed_curve is None:
        return  # tests/product/test_whole_discs.py has the columns of an even speed
    unit = built.design.scene.unit
    time = columns["t [s]"]
    assert np.all(np.diff(time) > 0.0)
    lift, velocity = columns[f"s [{unit}]"], columns[f"v [{unit}/s]"]
    mean = (lift[2:] - lift[:-2]) / (time[2:] - time[:-2])
    step = float(np.max(np.diff(time)))
    jerk = float(np.max(np.abs(columns[f"j [{unit}/s^3]"])))
    acceleration = float(np.max(np.abs(columns[f"a [{unit}/s^2]"])))
    uneven = float(np.max(np.abs(np.diff(time, 2))))
    assert np.max(np.abs(velocity[1:-1] - mean)) <= jerk * step**2 + acceleration * uneven


def test_certificate(built: Built) -> None:
    certificate = built.certificate
    scene = next(path for path in SCENES if path.stem == built.design.name)
    assert certificate["scene"]["sha256"] == load_scene(scene).made
    assert certificate["camgeo"] == built.design.disc.version
    named = set()
    for record in certificate["files"]:
        data = (built.folder / record["file"]).read_bytes()
        assert record["sha256"] == hashlib.sha256(data).hexdigest()
        assert record["bytes"] == len(data)
        assert record["tolerance_mm"] == built.tolerance
        if record["format"] in ("svg", "png"):
            assert record["deviation_mm"] is None
        else:
            assert 0.0 <= record["deviation_mm"] <= built.tolerance
        named.add(record["file"])
    assert {path.name for path in built.folder.iterdir()} == named | {"certificate.json"}
    assert {record["format"] for record in certificate["files"]} == {
        "dxf", "gcode", "stl", "3mf", "step", "csv", "svg", "png",
    }  # fmt: skip
    bad = {f["name"] for f in certificate["findings"] if f["severity"] in ("broken", "no-disc")}
    assert bad == BROKEN.get(built.design.name, set())


def test_pictures_open(built: Built) -> None:
    assert built.file(".png").read_bytes().startswith(PNG)
    assert ET.fromstring(built.file(".svg").read_bytes()).tag.endswith("svg")
