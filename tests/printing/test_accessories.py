"""Rollers and test rings: cylinders and rings of the sizes that the scene gives."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from camgeo.cam.cam import Contact
from camgeo.design.plate import ring_part, roller_part
from camgeo.part.compensation import with_clearance
from camgeo.part.mass import solid
from camgeo.part.printing import PrintSpec
from camgeo.part.spec import Keyway, PartSpec
from tests.part.parts import made, refused

DISC = PartSpec(thickness=10.0, bore=20.0, rim=140.0, keyway=Keyway(6.0, 2.8, 0.4))


@pytest.mark.parametrize("bore", [None, 6.0])
def test_a_roller(bore: float | None) -> None:
    for spec, clearance in ((None, 0.0), (PrintSpec(bore_clearance=0.2), 0.2)):
        part = roller_part(8.0, 5.0, bore, spec)
        hole = 0.0 if bore is None else 0.5 * (bore + clearance)
        assert solid(part).volume == pytest.approx(math.pi * (64.0 - hole**2) * 5.0, rel=1e-12)
        assert part.outermost.farthest()[0] == 8.0


def test_a_roller_with_too_large_a_bore() -> None:
    with refused("output.3mf.roller_bore", r"less than 15\.8 mm"):
        roller_part(8.0, 5.0, 15.9, PrintSpec(bore_clearance=0.2))


def test_a_ring_has_the_bore_of_the_part() -> None:
    spec = with_clearance(DISC, PrintSpec(bore_clearance=0.2, key_clearance=0.1))
    fitted = made(Contact.INNER, spec)
    ring = ring_part(fitted)
    outer, bore = ring.layers[0].boundaries
    assert bore in fitted.boundaries
    assert outer.nearest() == pytest.approx(abs(complex(12.85, 3.05)) + 3.0, abs=1e-9)
    assert ring.thickness == 6.0
    thin = ring_part(made(Contact.INNER, replace(DISC, thickness=4.0)))
    assert thin.thickness == 4.0
    large = ring_part(made(Contact.INNER, replace(DISC, bore=40.0, keyway=None)))
    assert large.layers[0].boundaries[0].nearest() == pytest.approx(24.0)


def test_a_ring_needs_a_bore() -> None:
    with refused("output.3mf.plate", "needs the bore"):
        ring_part(made(Contact.INNER, replace(DISC, bore=None, keyway=None)))
