"""Solids of random parts: closed, oriented, and of the volume of their layers."""

from __future__ import annotations

import math

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from camgeo.cam.contact import Contact
from camgeo.contour.contour import Contour
from camgeo.numeric.arrays import FloatArray
from camgeo.part.part import Part
from camgeo.part.spec import PartSpec
from camgeo_export.solid.prism import body
from camgeo_export.verify.mesh import solid_checks
from tests.part.parts import FLANKS, made_or_refused, specs
from tests.strategies import attack

TOLERANCE = 0.05


def _same(values: FloatArray) -> FloatArray:
    return values


@given(st.sampled_from(list(FLANKS)), specs())
@attack
def test_random_parts_are_solids(contact: Contact, spec: PartSpec) -> None:
    part = made_or_refused(contact, spec)
    assume(part is not None)
    assert part is not None
    solid = body(part, TOLERANCE, _same)
    for check in solid_checks(solid.vertices, solid.triangles):
        assert check.ok, check
    volume, off = _volume(part)
    assert solid.volume == pytest.approx(volume, abs=off)


def _volume(part: Part) -> tuple[float, float]:
    """Of all layers [mm^3], and by how much chords within the tolerance may change it."""
    volume, off = 0.0, 0.0
    for layer in part.layers:
        height = layer.z1 - layer.z0
        for boundary in layer.boundaries:
            fit = boundary.arcs(1e-4, "fast")
            contour: Contour = fit.contour
            volume += (-1.0 if boundary.hole else 1.0) * height * abs(contour.area)
            off += height * (TOLERANCE + fit.deviation) * (contour.length + math.pi * TOLERANCE)
    return volume, off
