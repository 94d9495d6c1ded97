"""docs/opticurv.md has what its script computes, with a faithful port of the program."""

from __future__ import annotations

import numpy as np
import pytest

from tests.pages import page_maker
from tests.reference import THESIS_CAMS, reference

PAGE = page_maker("opticurv_page")

PUBLISHED = {"schnitt": 6.7, "setzhub": 5.1, "vorschub": 1.3}
"""Largest error of the working curves [mm] as the reference collection has it (section 8)."""


@pytest.mark.parametrize("name", THESIS_CAMS)
def test_the_program_with_its_faults_mended_agrees_with_camgeo(name: str) -> None:
    """So the port is faithful, and there are no other faults, except for mue."""
    found, true = PAGE.opticurv(PAGE.numbers_of(name), ()), PAGE.right(name)
    assert tuple(found) == tuple(true)
    for column, values in true.items():
        if column == "mue":
            continue
        there, here = found[column], values
        if column == "r_K":
            there, here = 1.0 / there, 1.0 / here
        assert abs(there - here).max() < PAGE.AGREE, column


@pytest.mark.parametrize("fault", PAGE.FAULTS)
def test_each_fault_alone_makes_the_program_wrong(fault: str) -> None:
    name = "querhub"  # the only one with the answer that fault "sign" needs
    found, true = PAGE.opticurv(PAGE.numbers_of(name), (fault,)), PAGE.right(name)
    assert abs(1.0 / found["r_K"] - 1.0 / true["r_K"]).max() > 1e-3


@pytest.mark.parametrize("name", PUBLISHED)
def test_the_errors_of_the_working_curves_are_the_published_ones(name: str) -> None:
    found, true = PAGE.opticurv(PAGE.numbers_of(name)), PAGE.right(name)
    for flank in ("i", "a"):
        assert round(float(PAGE.off(found, true, flank).max()), 1) == PUBLISHED[name]
    assert PAGE.off(found, true, "B").max() < 1e-12 * 100.0


def test_mue_of_the_program_is_90_degrees_in_a_dwell() -> None:
    columns = PAGE.opticurv(PAGE.numbers_of("setzhub"))
    first = columns["phi"] < 110.0
    # arccos of a cosine that is 1 except for some roundings.
    assert abs(columns["mue"][first] - 90.0).max() < np.degrees(np.sqrt(32.0 * 2.0**-52))


@pytest.mark.parametrize("name", THESIS_CAMS)
def test_the_right_columns_have_the_extremes_of_the_reference(name: str) -> None:
    """At steps of 0.5 degrees, so on the far side of the extremes and near them."""
    expected = reference("thesis_examples.toml")[THESIS_CAMS[name]]["results_sigma_minus1"]
    true = PAGE.right(name)
    swing = true["psi"][abs(true["psi"]).argmax()]
    assert swing == pytest.approx(expected["psi_extreme"], abs=1e-12)
    radius = np.hypot(true["x_B_vers"], true["y_B_vers"])
    assert radius.min() == pytest.approx(expected["r_min"], abs=1e-12)
    assert radius.max() == pytest.approx(expected["r_max"], abs=1e-12)
    assert expected["mu_min"] <= true["mue"].min() < expected["mu_min"] + 0.05
    convex = true["r_K"][true["r_K"] > 0.0].min()
    assert expected["rho_convex_min"] <= convex < expected["rho_convex_min"] * 1.01
