"""camgeo: from a scene file to cams for machines and CAD programs.

import camgeo
design = camgeo.load("scene.toml")
design.findings                      # checks
design.write("out", ["dxf", "3mf"])  # files, with their certificate

larger = camgeo.Design(design.scene.with_values({"follower.base_radius": 40}))
"""

from __future__ import annotations

import sys
import warnings
from collections.abc import Sequence
from importlib import import_module
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import TYPE_CHECKING, Any, Final

from camgeo._version import __version__
from camgeo.errors import (
    CamgeoError,
    Fault,
    GeometryError,
    OutputError,
    SceneError,
    ToleranceError,
    UndercutError,
)

if TYPE_CHECKING:
    from pathlib import Path

    from camgeo.check.finding import Finding, Limits
    from camgeo.design.design import Design
    from camgeo.geometry.pitch_curve import PitchCurve, WorkingCurve
    from camgeo.kinematics.mechanism.flat import OscillatingFlat, TranslatingFlat
    from camgeo.kinematics.mechanism.linkage import LinkedMotion
    from camgeo.kinematics.mechanism.linkages import FourBar, SliderCrank, SliderDrivenCrank
    from camgeo.kinematics.mechanism.rollers import OscillatingRoller, TranslatingRoller
    from camgeo.kinematics.plan import Dwell, MotionPlan, Move
    from camgeo.scene.scene import Scene

LAZY_NAMES: Final = {
    "Design": "camgeo.design.design",
    "Dwell": "camgeo.kinematics.plan",
    "Finding": "camgeo.check.finding",
    "FourBar": "camgeo.kinematics.mechanism.linkages",
    "Limits": "camgeo.check.finding",
    "LinkedMotion": "camgeo.kinematics.mechanism.linkage",
    "MotionPlan": "camgeo.kinematics.plan",
    "Move": "camgeo.kinematics.plan",
    "OscillatingFlat": "camgeo.kinematics.mechanism.flat",
    "OscillatingRoller": "camgeo.kinematics.mechanism.rollers",
    "PitchCurve": "camgeo.geometry.pitch_curve",
    "Scene": "camgeo.scene.scene",
    "SliderCrank": "camgeo.kinematics.mechanism.linkages",
    "SliderDrivenCrank": "camgeo.kinematics.mechanism.linkages",
    "TranslatingFlat": "camgeo.kinematics.mechanism.flat",
    "TranslatingRoller": "camgeo.kinematics.mechanism.rollers",
    "WorkingCurve": "camgeo.geometry.pitch_curve",
}
"""Modules of the public names, which are imported on first use: a run needs only a few, and the
command line must be ready for Ctrl-C before it imports anything large."""


def __getattr__(name: str) -> Any:
    if name in LAZY_NAMES:
        return getattr(import_module(LAZY_NAMES[name]), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def load(path: str | Path) -> Design:
    """Read a scene file and return its design; nothing is computed yet.

    Raises
    ------
    SceneError
        If anything in the file is wrong; all faults at once.
    """
    from camgeo.design.design import Design
    from camgeo.scene.scene import load_scene

    return Design(load_scene(path))


def loads(text: str, *, folder: str | Path | None = None) -> Design:
    """Return the design of a scene's TOML text; `folder` holds the files that the scene names.

    Raises
    ------
    SceneError
        If anything in the text is wrong; all faults at once.
    """
    from camgeo.design.design import Design
    from camgeo.scene.scene import parse_scene

    return Design(parse_scene(text, folder=folder))


__all__ = [
    "CamgeoError",
    "Design",
    "Dwell",
    "Fault",
    "Finding",
    "FourBar",
    "GeometryError",
    "Limits",
    "LinkedMotion",
    "MotionPlan",
    "Move",
    "OscillatingFlat",
    "OscillatingRoller",
    "OutputError",
    "PitchCurve",
    "Scene",
    "SceneError",
    "SliderCrank",
    "SliderDrivenCrank",
    "ToleranceError",
    "TranslatingFlat",
    "TranslatingRoller",
    "UndercutError",
    "WorkingCurve",
    "__version__",
    "load",
    "loads",
]

# -- earlier names --------------------------------------------------------------------------------
# The documentation names modules that others import: writers, effects, answers, families. Some
# rooms and modules have moved since; their earlier names, and names that begin with them, still
# import them, with a warning.


NOW: Final = {
    "accuracy": "studies.accuracy",
    "answers": "app.answers",
    "answers.render": "app.answers.answer",
    "designing": "app.designing",
    "dynamics.effects.rules": "dynamics.effects.registry",
    "effects": "dynamics.effects",
    "effects.rules": "dynamics.effects.registry",
    "figure": "pictures",
    "figure.compare": "pictures.sweep",
    "formats": "scene.formats",
    "mechanism": "kinematics.mechanism",
    "motion": "kinematics",
    "optimise": "studies.optimise",
    "optimise.task": "studies.optimise.optimise",
    "pictures.compare": "pictures.sweep",
    "studies.optimise.task": "studies.optimise.optimise",
    "sweep": "studies.sweep",
    "sweep.engine": "studies.sweep.rows",
    "sweep.stated": "studies.sweep.family",
    "writing": "design",
    "writing.transaction": "design.writing",
    "writing.write": "design.writing",
    "writing.writer": "design.writing",
}
"""The present name by the earlier one, both within camgeo."""


class EarlierNames:
    """Finder and loader of the modules in `NOW` and of those whose names begin with them."""

    def find_spec(
        self, name: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """The specification of a module with an earlier name; None for all others."""
        if not present_name(name):
            return None
        # importlib.abc, which has the base class, takes 10 ms.
        return ModuleSpec(name, self, is_package=True)  # type: ignore[arg-type]  # a loader by its methods

    def create_module(self, spec: ModuleSpec) -> None:
        """Return None: the import system makes a module, which `exec_module` replaces."""

    def exec_module(self, module: ModuleType) -> None:
        """Replace the module by that of the present name."""
        earlier, now = module.__name__, present_name(module.__name__)
        sys.modules[earlier] = import_module(now)
        if earlier.count(".") > 1:
            # The frames of the import system lie between, so the caller cannot be named.
            warnings.warn(f"{earlier} is {now} now", DeprecationWarning, stacklevel=2)


def present_name(earlier: str) -> str:
    """The present name of a module of camgeo from an earlier one; empty if that is none."""
    words = earlier.split(".")[1:] if earlier.startswith("camgeo.") else []
    for count in range(len(words), 0, -1):
        if now := NOW.get(".".join(words[:count])):
            return ".".join(("camgeo", now, *words[count:]))
    return ""


def keep_earlier_names() -> None:
    """Put the finder of earlier names first: a later one would import copies of these modules."""
    if not any(isinstance(finder, EarlierNames) for finder in sys.meta_path):
        sys.meta_path.insert(0, EarlierNames())


keep_earlier_names()
