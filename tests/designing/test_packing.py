"""Packed pictures: the same numbers, in fewer bytes."""

from __future__ import annotations

import json
from base64 import b64decode
from typing import Any

import numpy as np
import pytest

from camgeo.app.designing.work import PACKING_ERROR, packed
from camgeo.design.design import Design
from camgeo.pictures import motion
from camgeo.pictures.mechanism import animation
from camgeo.pictures.model import Axis, Figure, Line, Panel, Style
from camgeo.scene.scene import load_scene
from tests.answers.documents import FIXTURES

SETZHUB = Design(load_scene(FIXTURES / "scenes" / "setzhub.toml"))


def lists(data: Any) -> Any:
    """With what is packed as lists again, gaps as None."""
    if isinstance(data, dict) and "packed" in data:
        found = np.frombuffer(b64decode(data["numbers"]), f"<{data['packed']}")
        whole = found.astype(np.float64).astype(object).reshape(data["shape"])
        whole[np.isnan(found).reshape(whole.shape)] = None
        return whole.tolist()
    if isinstance(data, dict):
        return {key: lists(value) for key, value in data.items()}
    return [lists(each) for each in data] if isinstance(data, list) else data


def numbers(data: Any) -> list[float]:
    if isinstance(data, dict):
        data = list(data.values())
    if isinstance(data, list):
        return [number for each in data for number in numbers(each)]
    return [float(data)] if isinstance(data, int | float) else []


def drawn(points: Any) -> Figure:
    axis = Axis((0.0, 1.0), "x")
    line = Line(np.array(points, np.float64), Style("black"))
    return Figure((4.0, 3.0), (Panel((0.0, 0.0, 1.0, 1.0), axis, axis, (line,)),))


def test_pictures_are_the_same_packed() -> None:
    chart = motion.drive_figure(SETZHUB.name, "mm", SETZHUB.drive, SETZHUB.scene.lift_unit)
    for picture in (chart, animation(SETZHUB.disc)):
        data, found = picture.to_data(), packed(picture)
        assert len(json.dumps(found, allow_nan=False)) < 0.6 * len(json.dumps(data))
        one, other = numbers(data), numbers(lists(found))
        assert len(one) == len(other)
        assert other == pytest.approx(one, rel=0.0, abs=PACKING_ERROR * max(map(abs, one)))


@pytest.mark.parametrize("offset", [0.0, 1e9])
def test_packed_numbers_are_near_relative_to_their_extent(offset: float) -> None:
    x = np.linspace(0.0, 1.0, 200)
    points = np.column_stack((360.0 * x, offset + np.sin(x)))
    points[7] = np.nan
    data = packed(drawn(points))["panels"][0]["marks"][0]["points"]
    assert data["packed"] == ("f8" if offset else "f4")
    found = np.array(lists(data), np.float64)
    assert np.array_equal(np.isnan(found), np.isnan(points))
    assert np.nanmax(np.abs(found - points) / np.array([360.0, np.sin(1.0)])) <= PACKING_ERROR


@pytest.mark.parametrize("size", [1e39, 1e-42])
def test_numbers_that_are_no_single_floats_stay(size: float) -> None:
    x = np.linspace(0.0, 1.0, 200)
    points = np.column_stack((x, size * np.sin(x)))
    assert lists(packed(drawn(points))) == drawn(points).to_data()


def test_short_lists_and_empty_gaps_are_as_they_were() -> None:
    for points in ([[0.0, 1.0], [2.0, 3.0]], np.empty((0, 2)), np.full((40, 2), np.nan)):
        assert lists(packed(drawn(points))) == drawn(points).to_data()
