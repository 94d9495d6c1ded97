"""The result of `camgeo slotted-lever`, rendered as text, JSON, table and diagram."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from decimal import Decimal

import numpy as np
import pytest

from camgeo.app.answers.answer import figure, table, text
from camgeo.app.answers.slotted_lever import FULL_TURN, slotted_lever
from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.slotted_lever import SlottedLever
from tests.answers.documents import document

CRANKS = {"swings": 75.0, "turns": 400.0, "equal": 150.0}


@pytest.mark.parametrize("printed", [False, True])
@pytest.mark.parametrize("crank", CRANKS.values(), ids=CRANKS)
def test_documents_are_what_their_schema_says(crank: float, printed: bool) -> None:
    rows = Decimal("0.7"), Decimal(1), Decimal(359)
    found = slotted_lever(150.0, 90.0, crank=crank, rows=rows, printed=printed)
    reported = document(found)
    assert reported["crank_mm"] == crank
    assert reported["swings"] == (crank < 150.0)
    assert len(reported["extremes"]) == len(found.driven.extremes)
    head, *lines = table(found).csv().splitlines()
    assert head.split(",") == list(reported["table"])
    values = np.array([line.split(",") for line in lines], dtype=np.float64)
    assert np.array_equal(values.T, np.array(list(reported["table"].values())))
    json.dumps(figure(found).to_data(), allow_nan=False)


def test_text_and_document_are_of_one_result() -> None:
    found = slotted_lever(150.0, 90.0, swing=60.0)
    reported = document(found)
    assert "table" not in reported
    assert reported["swing_deg"] == pytest.approx(60.0)
    changed = replace(found, driven=replace(found.driven, lever=SlottedLever(75.0, 160.0)))
    assert document(changed)["frame_mm"] == 160.0
    assert "frame a = 160 mm" in text(changed)
    swing = math.degrees(changed.swing or 0.0)
    assert document(changed)["swing_deg"] == swing
    assert f"swings, by {swing:.7g} deg in all" in text(changed)
    assert "frame a = 150 mm" in text(found)


def test_a_crank_or_a_swing_is_needed() -> None:
    with pytest.raises(GeometryError, match="needed") as caught:
        slotted_lever(150.0, 90.0, rows=FULL_TURN)
    assert caught.value.key == "crank"
