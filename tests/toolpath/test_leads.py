"""Leads in narrow places: as large as there is room, never into the part."""

from __future__ import annotations

import numpy as np
import pytest

from camgeo.contour.contour import Contour
from camgeo.errors import GeometryError
from camgeo.toolpath.leads import SMALLEST_SHARE, quarter_circle_lead, start_tangent, started
from tests.contour.cams import outline

HALF_WIDTH = 1.0

SLOT = Contour(
    np.array([-10 - 1j, 10 - 1j, 10 + 1j, -10 + 1j]),
    np.array([0.0, np.pi, 0.0, np.pi]),
    np.array([0j, 10.0, 0j, -10.0]),
)
"""A slot of width 2, counter-clockwise: the cutter's centre runs round its inside."""


def test_start_in_the_middle_of_a_piece() -> None:
    for index in range(4):
        contour = started(SLOT, index)
        assert contour.area == pytest.approx(SLOT.area, rel=1e-14)
        assert contour.length == pytest.approx(SLOT.length, rel=1e-14)
        middle = contour.vertices[0]
        half = SLOT.lengths[index] / 2.0
        assert contour.lengths[0] == pytest.approx(half)
        assert contour.lengths[-1] == pytest.approx(half)
        assert outline(SLOT).distances(np.array([middle]))[0] < 1e-14
    assert started(SLOT, 0).vertices[0] == pytest.approx(-1j)
    assert start_tangent(started(SLOT, 0)) == pytest.approx(1.0)
    assert start_tangent(started(SLOT, 1)) == pytest.approx(1j)


@pytest.mark.parametrize("room", [0.5, 1.2, 5.0, 30.0])
def test_lead_stays_in_the_slot(room: float) -> None:
    contour = started(SLOT, 0)
    point, tangent = complex(contour.vertices[0]), start_tangent(contour)
    lead = quarter_circle_lead(contour, room)
    radius = abs(lead.centre - point)
    # Halved until it fits: a quarter circle on either side rises by its radius, up to 2.
    assert radius <= 2.0 * HALF_WIDTH
    assert radius > min(room, 2.0 * HALF_WIDTH) / 2.0 - 1e-12
    assert abs(lead.start - lead.centre) == pytest.approx(radius)
    assert abs(lead.end - lead.centre) == pytest.approx(radius)
    for end in (lead.start, lead.end):
        assert abs(end.imag) <= HALF_WIDTH
    # It runs along the path where it meets it.
    turned = (point - lead.centre) * 1j / radius
    assert turned == pytest.approx(tangent)


def test_no_room_is_refused() -> None:
    contour = started(SLOT, 0)
    room = 2.1 * HALF_WIDTH / SMALLEST_SHARE
    with pytest.raises(GeometryError, match="no room for a tangential lead-in"):
        quarter_circle_lead(contour, room)
