"""The feed at the contact of a cutter with a wall."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.milling.moves import centre_feed


@given(st.floats(0.01, 1e3), st.floats(0.1, 50.0), st.floats(1.0, 1e4))
def test_the_contact_takes_as_long_as_the_centre(radius: float, tool: float, feed: float) -> None:
    """Both go around in the same time: the wall's circumference at `feed`, the centre's slower."""
    slowed = centre_feed(feed, radius, tool, inside=True)
    around = 2.0 * math.pi
    assert around * radius / slowed == pytest.approx(around * (radius + tool) / feed, rel=1e-12)
    assert centre_feed(feed, radius, tool, inside=False) == feed
