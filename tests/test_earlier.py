"""Modules that the documentation named before they moved import what they named."""

from __future__ import annotations

import subprocess
import sys
from importlib import import_module

import pytest

from camgeo import NOW, present_name

DOCUMENTED = {
    "camgeo.accuracy.benefit": "benefit_rows",
    "camgeo.answers.check": "check",
    "camgeo.answers.render": "to_json",
    "camgeo.answers.tolerance": "tolerance",
    "camgeo.effects.effect": "Effect",
    "camgeo.effects.results": "CONTACT_FORCE",
    "camgeo.dynamics.effects.rules": "Only",
    "camgeo.effects.rules": "ONE_DISC",
    "camgeo.figure.compare": "figure",
    "camgeo.figure.model": "Figure",
    "camgeo.formats.format": "Format",
    "camgeo.mechanism.values": "Length",
    "camgeo.motion.laws": "make_law",
    "camgeo.optimise.optimise": "optimise",
    "camgeo.optimise.task": "task_of",
    "camgeo.studies.optimise.task": "task_of",
    "camgeo.sweep.engine": "Engine",
    "camgeo.sweep.stated": "family_of",
    "camgeo.sweep.sweep": "sweep",
    "camgeo.writing.transaction": "write_set",
    "camgeo.writing.writer": "Writer",
}
"""What the pages named, by module."""


def test_what_was_documented_is_there_with_a_warning() -> None:
    for earlier, name in DOCUMENTED.items():
        now = present_name(earlier)
        sys.modules.pop(earlier, None)
        with pytest.warns(DeprecationWarning, match=f"^{earlier} is {now} now$"):
            found = import_module(earlier)
        assert found is import_module(now)
        assert getattr(found, name) is getattr(import_module(now), name)


def test_nothing_is_there_twice() -> None:
    """An earlier room is the present one, in which Python would find a second copy of a module."""
    code = (
        "import camgeo.effects.effect as earlier, camgeo.dynamics.effects.effect as now;"
        " assert earlier is now and now.__spec__.name == now.__name__"
    )
    subprocess.run([sys.executable, "-W", "ignore", "-c", code], check=True)


def test_other_names_are_as_they_are() -> None:
    for name in ("camgeo", "camgeo.errors", "camgeo.design", "other.effects", "camgeo.effect"):
        assert present_name(name) == ""
    assert not {f"camgeo.{each}" for each in NOW} & {f"camgeo.{each}" for each in NOW.values()}
    with pytest.raises(ModuleNotFoundError):
        import_module("camgeo.effects.nothing_of_this_name")
