"""CSV, pictures and certificate of each fixture scene."""

from __future__ import annotations

import csv
import hashlib
from xml.etree import ElementTree as ET

import numpy as np

from tests.end_to_end.built import SCENES, Built

PNG = b"\x89PNG\r\n\x1a\n"


def test_table_holds_the_values_of_the_design(built: Built) -> None:
    with built.file(".csv").open(newline="") as file:
        rows = list(csv.reader(file))
    names, values = rows[0], np.array(rows[1:], dtype=np.float64)
    columns = dict(zip(names, values.T, strict=True))
    degrees = columns["phi [deg]"]
    step = float(built.design.specification.output.table_step)
    assert np.array_equal(degrees, step * np.arange(round(360.0 / step)))
    phi = np.radians(degrees)
    design, unit, mm = built.design, built.design.unit, built.design.millimetres
    for name, points in (
        ("pitch", design.pitch(phi)),
        ("inner", design.inner(phi)),
        ("outer", design.outer(phi)),
    ):
        assert np.array_equal(columns[f"{name} x [{unit}]"] * 1.0, points[:, 0] / mm)
        assert np.array_equal(columns[f"{name} y [{unit}]"] * 1.0, points[:, 1] / mm)
    assert np.array_equal(columns["mu [deg]"], np.degrees(design.transmission_angle(phi)))
    assert np.array_equal(columns[f"kappa [1/{unit}]"], design.curvature(phi) * mm)
    rates = ("", "/rad", "/rad^2", "/rad^3")
    if f"s [{unit}]" in columns:
        for order, rate in enumerate(rates):
            mark = "'" * order
            stroke = design.stroke(phi)[order] / mm
            assert np.array_equal(columns[f"s{mark} [{unit}{rate}]"], stroke)
    assert ("psi [deg]" in columns) == (design.lift_unit == "rad")
    if design.lift_unit == "rad":
        assert np.array_equal(columns["psi [deg]"], np.degrees(design.lift(phi)[0]))


def test_certificate(built: Built) -> None:
    certificate = built.certificate
    scene = next(path for path in SCENES if path.stem == built.design.name)
    assert certificate["scene"]["sha256"] == hashlib.sha256(scene.read_bytes()).hexdigest()
    assert certificate["camgeo"] == built.design.version
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
        "dxf", "gcode", "stl", "3mf", "csv", "svg", "png",
    }  # fmt: skip
    assert not any(f["severity"] in ("broken", "fatal") for f in certificate["findings"])


def test_pictures_open(built: Built) -> None:
    assert built.file(".png").read_bytes().startswith(PNG)
    assert ET.fromstring(built.file(".svg").read_bytes()).tag.endswith("svg")
