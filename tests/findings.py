"""The findings of a design's effects together, single ones by their names, and values that findings
and answers must have.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, TypeVar

from camgeo.check.finding import Finding
from camgeo.design.design import Design

Value = TypeVar("Value")


def known(value: Value | None) -> Value:
    """The value, which is not None: a test that asks for it fails where there is none."""
    assert value is not None
    return value


def effect_findings(design: Design) -> tuple[Finding, ...]:
    """Findings of the effects in the scene, in its order; those that several effects share once."""
    found = [each for name in design.scene.effects for each in design.effects.findings(name)]
    return tuple(dict.fromkeys(found))


def finding(findings: Iterable[Finding], name: str) -> Any:
    """The only one of that name. Whoever asks knows which of its fields are not None."""
    (found,) = (each for each in findings if each.name == name)
    return found


def finding_of(design: Design, effect: str, name: str) -> Any:
    """The only one of that name of an effect."""
    return finding(design.effects.findings(effect), name)


def names_of(design: Design, effect: str) -> set[str]:
    """The names of the findings of an effect."""
    return {each.name for each in design.effects.findings(effect)}


def by_name(items: Iterable[Any]) -> dict[str, Any]:
    """Findings or columns by their names, the last of each."""
    return {each.name: each for each in items}


def finding_values(findings: Iterable[Finding]) -> dict[str, float]:
    """The values of those that have one, the last of each name."""
    return {each.name: each.value for each in findings if each.value is not None}
