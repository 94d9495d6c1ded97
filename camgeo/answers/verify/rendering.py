"""What `camgeo verify` finds, in words."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any, Final

from camgeo.answers.verify import Verification
from camgeo.units import LengthUnit, in_unit, unit_in
from camgeo.verifying.verification import Check, Verdict

MARKS: Final = {True: "ok", False: "FAIL", None: ""}

WIDTHS: Final = (34, 20, 32)
"""Columns of a check: what, found, allowed."""


def text(answer: Verification) -> str:
    """Each file with its result, and its checks below it."""
    lines = []
    for path, verdict in zip(answer.paths, answer.verdicts, strict=True):
        checks = (_line(_divided(check, verdict.length)) for check in verdict.checks)
        lines += [in_unit(_headline(path, verdict), verdict.length), *checks]
    return "\n".join(lines)


def _headline(path: Path, verdict: Verdict) -> str:
    """The file and its result."""
    word = "pass" if verdict.passed else "FAIL"
    if verdict.tolerance is None:
        return f"{path}: {word}, {'bytes only' if verdict.passed else 'not measured'}"
    tolerance, who = verdict.tolerance
    off = verdict.deviation
    text = "deviation not proved" if off is None else f"at most {off:.3g} mm off"
    return f"{path}: {word}, {text} (tolerance {tolerance:g} mm, by {who})"


def _divided(check: Check, length: LengthUnit) -> Check:
    """The check with its numbers in the unit of length of the scene."""
    unit, divisor = unit_in(check.unit, length)

    def shown(value: Any) -> Any:
        return value / divisor if isinstance(value, float) and divisor != 1.0 else value

    figures = {name: shown(getattr(check, name)) for name in ("value", "expected", "limit")}
    return replace(check, **figures, unit=unit)


def _line(check: Check) -> str:
    """One check: what, found, allowed, verdict, note."""
    name = f"{check.name} {check.of}".rstrip()
    found = _text(check.value, check.unit)
    if check.expected is not None:
        found, allowed = _long(check.value), _long(check.expected)
        if check.limit is not None:
            allowed += f" +- {check.limit:.3g} {check.unit}"
    else:
        allowed = "" if check.limit is None else f"<= {_text(check.limit, '')}"
    columns = "".join(
        f"{text:{width}} " for text, width in zip((name, found, allowed), WIDTHS, strict=True)
    )
    return f"  {columns}{MARKS[check.ok]:5}{check.note}".rstrip()


def _text(value: float | str | None, unit: str) -> str:
    if value is None:
        return ""
    if isinstance(value, str):
        return value
    return f"{value:.4g} {unit}".rstrip()


def _long(value: float | str | None) -> str:
    """The value with as many digits as a comparison needs."""
    return f"{value:.9g}" if isinstance(value, float) else value or ""
