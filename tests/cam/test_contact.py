"""What a contact says of the disc, by its name."""

from __future__ import annotations

import pytest

from camgeo.cam.cam import Contact, contact_of
from camgeo.errors import GeometryError
from camgeo.geometry.outline.path import Flank

INNER, OUTER = Flank.INNER, Flank.OUTER


@pytest.mark.parametrize(
    ("name", "flanks", "by_form", "inside", "plate", "push", "distances"),
    [
        ("inner", (INNER,), False, True, True, 1, {INNER: -3.0}),
        ("outer", (OUTER,), False, False, False, -1, {OUTER: 3.0}),
        ("groove", (INNER, OUTER), True, True, False, 1, {INNER: -3.0, OUTER: 3.0}),
    ],
)
def test_each_contact_by_its_flanks(
    name: str,
    flanks: tuple[Flank, ...],
    by_form: bool,
    inside: bool,
    plate: bool,
    push: int,
    distances: dict[Flank, float],
) -> None:
    """The inner flank lies within the pitch curve and pushes the follower outward."""
    contact = contact_of("follower.contact", name)
    assert contact.value == name
    assert contact.flanks == flanks
    assert contact.closed_by_form is by_form
    assert contact.runs_inside is inside
    assert contact.is_plate is plate
    assert contact.main is flanks[0]
    assert contact.push == push
    assert contact.distances(3.0) == distances
    assert list(contact.distances(3.0)) == list(flanks)


@pytest.mark.parametrize("value", ["Inner", "ring", "", None, 1, True])
def test_another_contact_is_refused_with_those_there_are(value: object) -> None:
    with pytest.raises(GeometryError, match='must be one of "inner", "outer", "groove"') as caught:
        contact_of("follower.contact", value)
    assert caught.value.key == "follower.contact"
    assert len(Contact) == 3
