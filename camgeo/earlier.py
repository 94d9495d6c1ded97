"""Earlier names of modules, which still import what they named, with a warning.

The documentation names modules that others import: writers, effects, answers, families. Their
earlier names are rooms and modules that have moved; each stands for what begins with it.
"""

from __future__ import annotations

import sys
import warnings
from collections.abc import Sequence
from importlib import import_module
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import Final

NOW: Final = {
    "accuracy": "studies.accuracy",
    "answers": "app.answers",
    "answers.render": "app.answers.answer",
    "designing": "app.designing",
    "dynamics.effects.rules": "dynamics.effects.effect",
    "effects": "dynamics.effects",
    "effects.rules": "dynamics.effects.effect",
    "figure": "pictures",
    "formats": "scene.formats",
    "mechanism": "kinematics.mechanism",
    "motion": "kinematics",
    "optimise": "studies.optimise",
    "optimise.task": "studies.optimise.optimise",
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
    """Finds the modules of `NOW` and what begins with them, where no module has that name."""

    def find_spec(
        self, name: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """The specification of an earlier name; None for all others."""
        if not present_name(name):
            return None
        # importlib.abc, which has the base class, takes 10 ms.
        return ModuleSpec(name, self, is_package=True)  # type: ignore[arg-type]  # a loader by its methods

    def create_module(self, spec: ModuleSpec) -> None:
        """Nothing: the module is there under its present name."""

    def exec_module(self, module: ModuleType) -> None:
        """Puts the module of the present name in place."""
        earlier, now = module.__name__, present_name(module.__name__)
        sys.modules[earlier] = import_module(now)
        if earlier.count(".") > 1:
            # Where the caller is, Python does not say: frames of its own import lie between.
            warnings.warn(f"{earlier} is {now} now", DeprecationWarning, stacklevel=2)


def present_name(earlier: str) -> str:
    """The present name of a module of camgeo; empty if it has had no other."""
    words = earlier.split(".")[1:] if earlier.startswith("camgeo.") else []
    for count in range(len(words), 0, -1):
        if now := NOW.get(".".join(words[:count])):
            return ".".join(("camgeo", now, *words[count:]))
    return ""


def keep_earlier_names() -> None:
    """Has Python ask for earlier names first: it would find copies in the rooms they stand for."""
    if not any(isinstance(each, EarlierNames) for each in sys.meta_path):
        sys.meta_path.insert(0, EarlierNames())
