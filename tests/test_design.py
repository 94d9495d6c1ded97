"""A design is lazy: each quantity at most once, and only when it is asked for."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from unittest.mock import Mock, patch

import numpy as np
import pytest

import camgeo
from camgeo.app.answers.explain import lazy_names
from camgeo.cam.cam import Disc, Drive
from camgeo.design.design import Design
from camgeo.design.value_table import radius_of_curvature
from camgeo.errors import UnknownNameError
from camgeo.geometry import pieces, pitch_curve
from camgeo.kinematics import plan

SETZHUB = Path(__file__).parents[1] / "fixtures" / "scenes" / "setzhub.toml"


@pytest.fixture
def design() -> Design:
    return camgeo.load(SETZHUB)


def test_nothing_is_computed_on_loading(design: Design) -> None:
    assert set(vars(design)) == {"scene", "ledger"}
    kind, jet = pitch_curve.PitchCurve, pitch_curve.PitchCurve.relative_jet
    with patch.object(kind, "relative_jet", autospec=True, side_effect=jet) as calls:
        camgeo.load(SETZHUB)
        calls.assert_not_called()
        design.disc.pictured.curve("pitch", np.zeros(3))
        calls.assert_called_once()


def test_what_was_not_asked_for_did_not_run(design: Design) -> None:
    design.disc.pictured.curve("pitch", np.zeros(1))
    design.cam.disc.pitch_curve.transmission_angle(np.zeros(1))
    assert [run.name for run in design.ledger.runs] == ["motion", "pitch_curve"]
    assert {"motion"} == set(lazy_names(Drive)) & set(vars(design.drive))
    assert {"pitch_curve"} == set(lazy_names(Disc)) & set(vars(design.cam.disc))


def test_findings_are_computed_once(design: Design, monkeypatch: pytest.MonkeyPatch) -> None:
    counted = Mock(wraps=pieces.curvature_extremes)
    monkeypatch.setattr("camgeo.cam.cam.curvature_extremes", counted)
    assert design.findings is design.findings
    assert design.judgement.has_outline
    counted.assert_called_once()


def test_findings_come_worst_first(tmp_path: Path) -> None:
    text = SETZHUB.read_text(encoding="utf-8").replace("roller_radius = 7.0", "roller_radius = 55")
    text = text.replace("transmission_angle = 41", "transmission_angle = 80")
    scene = tmp_path / "scene.toml"
    scene.write_text(text, encoding="utf-8")
    severities = [finding.severity for finding in camgeo.load(scene).findings]
    assert severities[0] == "invalid"
    order = ["invalid", "no-disc", "broken", "warning", "ok"]
    assert severities == sorted(severities, key=order.index)
    assert {"invalid", "no-disc", "broken", "ok"} <= set(severities)


def test_a_check_imports_no_contour_and_no_writer() -> None:
    code = (
        "import camgeo, json, sys; d = camgeo.load(sys.argv[1]); d.findings;"
        "print(json.dumps(sorted(sys.modules)))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, str(SETZHUB)], capture_output=True, text=True, check=True
    )
    loaded = json.loads(done.stdout)
    unwanted = (
        "camgeo.geometry.contour",
        "camgeo.milling.plan",
        "camgeo_export",
        "shapely",
        "scipy",
    )
    assert not [name for name in loaded if name.startswith(unwanted)]
    assert "camgeo.check.disc" in loaded


def test_quantities_agree_with_the_curves(design: Design) -> None:
    phi = np.linspace(0.0, 2.0 * np.pi, 50)
    pitch = design.cam.disc.pitch_curve.point(phi)
    assert np.array_equal(
        design.disc.pictured.curve("pitch", phi), np.column_stack((pitch.real, pitch.imag))
    )
    inner = design.cam.disc.inner_curve.point(phi)
    assert np.array_equal(
        design.disc.pictured.curve("inner", phi), np.column_stack((inner.real, inner.imag))
    )
    kappa = design.cam.disc.pitch_curve.curvature(phi)
    assert radius_of_curvature(kappa) == pytest.approx(1.0 / kappa, rel=1e-15)
    assert np.array_equal(design.drive.plan.jet(phi), plan.MotionPlan.jet(design.scene.plan, phi))


def test_arrays_of_any_number_of_turns(design: Design) -> None:
    phi = np.linspace(-7.0, 20.0, 101)
    turned = phi - 2.0 * np.pi * np.floor(phi / (2.0 * np.pi))
    assert design.disc.pictured.curve("pitch", phi) == pytest.approx(
        design.disc.pictured.curve("pitch", turned), abs=1e-12
    )


def test_an_unknown_effect_is_reported_with_those_that_exist(design: Design) -> None:
    with pytest.raises(UnknownNameError, match=r'no effect "sprung" .*"spring".*there are kin'):
        design.effect("sprung")


def test_public_names_that_few_need_are_imported_when_asked_for() -> None:
    code = (
        "import sys, camgeo\n"
        "modules = set(camgeo.LAZY_NAMES.values())\n"
        "assert not modules & set(sys.modules)\n"
        "assert all(getattr(camgeo, name).__name__ == name for name in camgeo.LAZY_NAMES)\n"
        "assert modules <= set(sys.modules)\n"
        "assert set(camgeo.LAZY_NAMES) <= set(camgeo.__all__)\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
