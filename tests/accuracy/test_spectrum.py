"""Harmonics of the ripple, against the transform of dense samples of the motion."""

from __future__ import annotations

import math

import numpy as np
import pytest

from camgeo.accuracy.spectrum import ripple_spectrum
from camgeo.contour.contour import Form
from camgeo.design import Design
from camgeo.state.written import Writing
from tests.effects.scenes import design

SPEED, MOST = 10.0, 40


@pytest.mark.parametrize("form", ["polyline", "arcs", "spline"])
def test_the_harmonics_are_those_of_dense_samples(form: Form) -> None:
    """Of the lift, whose transform falls fast; the second derivative gives the factor k^2."""
    setzhub = design("setzhub", "")
    found = ripple_spectrum(setzhub, Writing(form, 1e-2), SPEED, MOST)
    edits = {"state.motion": "written", "state.contour": form, "output.tolerance": 1e-2}
    state = Design(setzhub.scene.with_values(edits)).effects.subject.state
    count = 2**15
    phi = np.linspace(0.0, 2.0 * math.pi, count, endpoint=False)
    off = state.output.jet(phi)[0] - setzhub.drive.plan.jet(phi)[0]
    lift = 2.0 * np.abs(np.fft.rfft(off))[1 : MOST + 1] / count
    wanted = SPEED**2 * np.arange(1, MOST + 1) ** 2 * lift
    # Aliases of a lift whose slope has kinks fall with the square of the number of samples.
    assert found.amplitudes == pytest.approx(wanted, abs=2e-4 * float(np.max(wanted)))
    assert found.error <= 1e-6 * float(np.max(wanted))
    assert found.numbers.tolist() == list(range(1, MOST + 1))
