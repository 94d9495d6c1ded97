from __future__ import annotations

import math
import re

import pytest

from camgeo.errors import GeometryError
from camgeo.part.materials import MATERIALS, find_material
from camgeo.scene.schema import schema

HARDNESS = {"steel": 180, "steel-tempered": 300, "cast-iron": 200, "cast-iron-ductile": 220}
"""Of the rows whose limit follows from it by ISO 6336-5, sigma_Hlim = A x + B, quality MQ."""


@pytest.mark.parametrize("name", MATERIALS)
def test_a_material_has_a_source_and_is_one_that_there_can_be(name: str) -> None:
    """Positive definite elasticity; no lighter than water, no heavier than lead; a limit below the
    static one of the best bearing steel, 4000 MPa (ISO 76, line contact). A scene can name it."""
    material = find_material(name)
    assert material.name == name
    assert material.title
    assert material.source
    assert material.modulus > 0.0
    assert 0.0 < material.poisson < 0.5
    assert 1e-9 < material.density < 11.3e-9
    assert material.pressure is None or 0.0 < material.pressure < 4000.0
    assert re.search(schema()["$defs"]["material"]["pattern"], name)


@pytest.mark.parametrize(("name", "hardness"), HARDNESS.items())
def test_a_limit_is_the_one_of_its_hardness(name: str, hardness: int) -> None:
    """To half a unit, the last digit of the row."""
    material = find_material(name)
    found = re.search(r"([\d.]+) x \+ (\d+)", material.source)
    assert found is not None
    assert material.pressure is not None
    assert str(hardness) in material.title
    assert abs(float(found[1]) * hardness + float(found[2]) - material.pressure) <= 0.5


def test_bronze_on_steel_has_the_modulus_of_the_standard() -> None:
    """DIN 3996 prints E_red = 140144 N/mm^2 for CuSn12-C-GZ on steel, twice the contact modulus."""
    compliance = sum(
        (1.0 - each.poisson**2) / each.modulus
        for each in (find_material("bronze"), find_material("steel"))
    )
    assert round(2.0 / compliance) == 140144


@pytest.mark.parametrize(
    ("name", "meant"),
    [("steel-harden", "steel-hardened"), ("Bronze", "bronze"), ("aluminum", "aluminium")],
)
def test_a_misspelt_name_is_refused_with_the_one_meant(name: str, meant: str) -> None:
    with pytest.raises(GeometryError, match=f"did you mean {meant}") as caught:
        find_material(name, "cam_material")
    assert caught.value.key == "cam_material"
    assert caught.value.value == name


def test_a_name_like_no_other_is_refused_with_all_there_are() -> None:
    with pytest.raises(GeometryError) as caught:
        find_material("qqqq")
    assert "did you mean" not in caught.value.message
    assert all(name in caught.value.message for name in MATERIALS)


def test_the_table_cannot_be_changed() -> None:
    with pytest.raises(TypeError):
        MATERIALS["wood"] = find_material("steel")  # type: ignore[index]  # it must be read-only
    assert math.isclose(find_material("steel").density, 7.85e-9, rel_tol=1e-15)
