from __future__ import annotations

import mpmath
from hypothesis import given
from hypothesis import strategies as st

from camgeo.kinematics.mechanism.oscillating_roller import hypot_rest

lengths = st.floats(1e-12, 1e12)
signed = st.builds(lambda size, sign: sign * size, lengths, st.sampled_from([-1.0, 1.0]))


@given(signed, signed)
def test_the_rest_of_a_length_is_what_its_rounding_took(x: float, y: float) -> None:
    size = abs(complex(x, y))
    rest = hypot_rest(complex(x, y), size)
    with mpmath.workdps(80):
        exact = mpmath.hypot(x, y) - size
        # The rest is divided by 2 size instead of the sum of both, and is itself rounded.
        assert abs(exact - rest) <= 2.0**-100 * size
    assert abs(rest) <= 2.0**-51 * size


@given(signed)
def test_along_an_axis_nothing_is_lost(x: float) -> None:
    assert hypot_rest(complex(x, 0.0), abs(x)) == 0.0
    assert hypot_rest(complex(0.0, x), abs(x)) == 0.0


def test_a_vector_without_length_has_no_rest() -> None:
    assert hypot_rest(0j, 0.0) == 0.0
