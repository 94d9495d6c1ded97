"""The result of `camgeo stability`, rendered as text, as JSON and as a picture."""

from __future__ import annotations

import math
from dataclasses import replace

from camgeo.app.answers.answer import figure, text
from tests.answers.documents import document
from tests.stability.measure import Reading
from tests.stability.report import Stability
from tests.stability.suite import table


def found(*readings: Reading) -> Stability:
    return Stability(readings, table(readings), quick=False)


def test_text_and_document_are_of_one_result() -> None:
    groups = ("laws", "cams", "slotted-levers")
    readings = [Reading("f", group, group, 0.5, 1.0, 2.0, 1.0) for group in groups]
    answer = found(*readings)
    reported = document(answer)
    assert (reported["kept"], reported["quantities"][0]["values"], answer.exit_code) == (True, 3, 0)
    for reading in readings:
        at = document(found(reading))["quantities"][0]["largest_error"]["at"]
        (name,) = at
        assert name == {"laws": "z", "cams": "cam_angle_deg"}.get(reading.group, "crank_angle_deg")
        assert at[name] == (0.5 if name == "z" else math.degrees(0.5))
    worse = found(replace(readings[0], error=math.inf), *readings[1:])
    assert document(worse)["quantities"][0]["largest_error"]["error_ulp"] is None
    assert "no value" in text(worse)
    assert "no value" not in text(answer)
    assert worse.exit_code == 1
    assert figure(answer).panels
