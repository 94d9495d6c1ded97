"""Harmonics of the ripple, against the transform of dense samples of the motion."""

from __future__ import annotations

import math

import numpy as np
import pytest

from camgeo.design.design import Design
from camgeo.geometry.contour.contour import Form
from camgeo.studies.accuracy.benefit import ripple_spectrum
from tests.effects.scenes import design

MOST = 63


@pytest.mark.parametrize("form", ["polyline", "arcs", "spline"])
def test_the_harmonics_are_those_of_dense_samples(form: Form) -> None:
    """Of the lift, whose transform falls fast; the second derivative gives the factor k^2."""
    setzhub = design("setzhub", "")
    edits = {"state.motion": "written", "state.contour": form, "output.tolerance": 1e-2}
    state = Design(setzhub.scene.with_values(edits)).effects.subject.state
    found = ripple_spectrum(state, setzhub.effects.subject.state, MOST)
    count = 2**15
    phi = np.linspace(0.0, 2.0 * math.pi, count, endpoint=False)
    off = state.output.jet(phi)[0] - setzhub.drive.plan.jet(phi)[0]
    lift = 2.0 * np.abs(np.fft.rfft(off))[1 : MOST + 1] / count
    wanted = np.arange(1, MOST + 1) ** 2 * lift
    # Aliases of a lift whose slope has kinks fall with the square of the number of samples.
    assert found.amplitudes == pytest.approx(wanted, abs=2e-4 * float(np.max(wanted)))
    assert found.error <= 1e-6 * float(np.max(wanted))
    assert found.numbers.tolist() == list(range(1, MOST + 1))
    bands = [wanted[2**n - 1 : 2 ** (n + 1) - 1] for n in range(6)]
    effective = [math.sqrt(0.5 * float(np.sum(band**2))) for band in bands]
    assert found.octaves == pytest.approx(effective, abs=2e-3 * float(np.max(wanted)))
    assert wanted[found.strongest - 1] == pytest.approx(float(np.max(wanted)), rel=1e-3)
