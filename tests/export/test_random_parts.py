"""Random parts: a clear refusal, or a solid that is closed, oriented, and of its layers' volume."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import fields, replace
from functools import partial
from typing import TypeVar

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from camgeo.cam.cam import Contact
from camgeo.design.writing import Writer
from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import Contour
from camgeo.numeric.arrays import FloatArray
from camgeo.part.bevels import bevelled
from camgeo.part.mass import solid as exact
from camgeo.part.part import Part
from camgeo.part.spec import Chamfers, Counterbore, Holes, Hub, PartSpec
from camgeo_export.solid.measure import measure
from camgeo_export.solid.prism import body
from camgeo_export.step.writer import WRITER as STEP
from camgeo_export.stl import WRITER as STL
from camgeo_export.threemf.writer import WRITER as THREEMF
from camgeo_export.verify.body import solid_checks
from tests.export.test_solids import PartProduct
from tests.long_form import examples
from tests.part.parts import FLANKS, chamfers, made, made_or_refused, specs, tight_specs
from tests.strategies import attack

TOLERANCE = 0.05

Found = TypeVar("Found")


def _same(values: FloatArray) -> FloatArray:
    return values


def _made(contact: Contact, spec: PartSpec) -> Part:
    part = made_or_refused(contact, spec)
    assume(part is not None)
    assert part is not None
    return part


def _or_refused(make: Callable[[], Found]) -> Found | None:
    """What is made; None if the part is refused as it is."""
    try:
        return make()
    except GeometryError as error:
        if error.key == "part":
            return None
        raise


@given(st.sampled_from(list(FLANKS)), specs() | tight_specs())
@settings(attack, max_examples=examples(8, long=60))
def test_random_parts_are_solids(contact: Contact, spec: PartSpec) -> None:
    part = _made(contact, spec)
    solid = _or_refused(lambda: body(part, TOLERANCE, _same))
    if solid is None:
        return
    for check in solid_checks(solid.vertices, solid.triangles):
        assert check.ok, check
    volume, off = _volume(part)
    assert solid.volume == pytest.approx(volume, abs=off)


@given(st.sampled_from(list(FLANKS)), specs(), chamfers())
@settings(attack, max_examples=examples(6, long=60))
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
    solid = _or_refused(lambda: body(part, TOLERANCE, _same))
    assume(solid is not None)
    assert solid is not None
    for check in solid_checks(solid.vertices, solid.triangles):
        assert check.ok, check
    _, off = _volume(sharp)
    assert solid.volume == pytest.approx(exact(part).volume, abs=off)
    product = PartProduct(given=part, effort="fast")
    assert measure(part, solid.vertices, solid.triangles) <= TOLERANCE
    written = STEP.write(product, TOLERANCE)
    assert STEP.measure(product, written.data) <= TOLERANCE
    assert written.facts["volume_mm3"] == pytest.approx(exact(part).volume, abs=off)


@given(st.sampled_from(list(FLANKS)), specs() | tight_specs(), st.sampled_from([1e-3, 0.05]))
@settings(attack, max_examples=examples(6, long=60))
def test_what_is_written_of_random_parts_is_read_back(
    contact: Contact, spec: PartSpec, tolerance: float
) -> None:
    product = PartProduct(given=_made(contact, spec), effort="fast")
    for writer in (STL, THREEMF, STEP):
        written = _or_refused(partial(writer.write, product, tolerance))
        if written is not None:
            measured = writer.measure(product, written.data)
            assert measured is not None
            assert measured <= tolerance


HUB = PartSpec(thickness=10.0, bore=20.0, hub=Hub(20.002, 5.0))

BOLTS = Holes(2, 40.0, 5.0, counterbore=Counterbore(5.003, 3.0))


@pytest.mark.parametrize("writer", [STL, THREEMF, STEP], ids=["stl", "3mf", "step"])
@pytest.mark.parametrize(
    ("spec", "names", "apart"),
    [
        (HUB, ("hub", "bore"), 0.001),
        (PartSpec(thickness=10.0, bolt_circle=BOLTS), ("bolt hole 1", "counterbore 1"), 0.0015),
    ],
    ids=["hub", "counterbore"],
)
def test_walls_that_a_tolerance_does_not_keep_apart_are_refused(
    writer: Writer, spec: PartSpec, names: tuple[str, str], apart: float
) -> None:
    """Such bodies failed when they were read back, or one wall was taken for the other."""
    product = PartProduct(given=made(Contact.INNER, spec))
    with pytest.raises(GeometryError, match=r"a solid within 0\.01 mm does not keep") as refused:
        writer.write(product, 0.01)
    assert refused.value.key == "part"
    assert all(name in str(refused.value) for name in names)
    tighter = 0.1 * apart
    measured = THREEMF.measure(product, THREEMF.write(product, tighter).data)
    assert measured <= tighter


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
