"""Solids of random parts: closed, oriented, and of the volume of their layers."""

from __future__ import annotations

import math
from dataclasses import fields, replace

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from camgeo.cam.contact import Contact
from camgeo.contour.contour import Contour
from camgeo.errors import GeometryError
from camgeo.numeric.arrays import FloatArray
from camgeo.part.bevels import bevelled
from camgeo.part.chamfers import Chamfers
from camgeo.part.mass import solid as exact
from camgeo.part.part import Part
from camgeo.part.spec import PartSpec
from camgeo_export.solid.measure import measure
from camgeo_export.solid.prism import body
from camgeo_export.step.writer import WRITER as STEP
from camgeo_export.verify.mesh import solid_checks
from tests.export.test_solids import PartProduct
from tests.part.parts import FLANKS, chamfers, made_or_refused, specs
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


@given(st.sampled_from(list(FLANKS)), specs(), chamfers())
@attack
def test_random_chamfers_are_refused_or_in_the_solid(
    contact: Contact, spec: PartSpec, edges: Chamfers
) -> None:
    """Only those that the part has room for; the rest of the edges is sharp."""
    sharp = made_or_refused(contact, replace(spec, keyway=None, d_shaft=None))
    assume(sharp is not None)
    assert sharp is not None
    kept, refused = Chamfers(), []
    for field in fields(edges):
        tried = replace(kept, **{field.name: getattr(edges, field.name)})
        try:
            part = bevelled(sharp, tried, 0.01)
        except GeometryError as error:
            refused.append(error.key or "")
        else:
            kept = tried
    assert all(key.startswith("part.chamfers.") for key in refused), refused
    part = bevelled(sharp, kept, 0.01)
    solid = body(part, TOLERANCE, _same)
    for check in solid_checks(solid.vertices, solid.triangles):
        assert check.ok, check
    _, off = _volume(sharp)
    assert solid.volume == pytest.approx(exact(part).volume, abs=off)
    product = PartProduct(given=part, effort="fast")
    assert measure(part, solid.vertices, solid.triangles) <= TOLERANCE
    written = STEP.write(product, TOLERANCE)
    assert STEP.measure(product, written.data) <= TOLERANCE
    assert written.facts["volume_mm3"] == pytest.approx(exact(part).volume, abs=off)


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
