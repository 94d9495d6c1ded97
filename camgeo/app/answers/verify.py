"""What `camgeo verify` finds: files compared with the exact curves of their scene."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any, ClassVar, Final

from camgeo.app.answers.answer import BROKEN, CRASHED, FINE, Answer, Key
from camgeo.design.design import Design
from camgeo.design.verify import Against, Check, Verdict, Wanted, scene_file, verify_files
from camgeo.scene.scene import hashes_of, load_scene
from camgeo.units import LengthUnit, in_unit, unit_in


@dataclass(frozen=True, slots=True)
class Verification(Answer):
    """Files, and the verdicts on them.

    Attributes
    ----------
    paths : of the files.
    verdicts : one per file, in the same order.
    """

    command: ClassVar[str] = "verify"

    paths: tuple[Path, ...]
    verdicts: tuple[Verdict, ...]

    @property
    def passed(self) -> bool:
        """Whether all files pass."""
        return all(verdict.passed for verdict in self.verdicts)

    @property
    def records(self) -> tuple[Mapping[str, Any], ...]:
        """The verdicts as a verification.json holds them."""
        return tuple(verdict.record() for verdict in self.verdicts)

    @property
    def exit_code(self) -> int:
        """0 if all files pass, 1 if one does not, CRASHED after an error in camgeo itself."""
        if any(verdict.crashed for verdict in self.verdicts):
            return CRASHED
        return FINE if self.passed else BROKEN


def verify(
    paths: tuple[Path, ...], wanted: Wanted | None = None, *, scene: str | Path | None = None
) -> Verification:
    """Read files back, and compare them with a scene.

    Parameters
    ----------
    paths : of the files.
    wanted : the requirements; None for those stated by the files and their scene.
    scene : path of the scene; None for the one whose hash the files name, looked for in their
        folder, the one above and the present one.

    Raises
    ------
    SceneError
        If none of the files can be compared: they are of a format that cannot be read, or their
        scene is not found or wrong.
    """
    return Verification(paths, verify_files(paths, _scenes(scene), wanted or Wanted()))


def _scenes(named: str | Path | None) -> Callable[[Path, str], Against]:
    """A function that finds the scene of a file; each scene is read once."""

    @cache
    def load(path: Path) -> Against:
        design = Design(load_scene(path))
        scene = design.scene
        return Against(design.discs, scene.output.tolerance, scene.made_before)

    def find(folder: Path, sha256: str) -> Against:
        if named is not None:
            return load(Path(named))
        return load(scene_file((folder, folder / "..", Path()), sha256, hashes_of))

    return find


# -- document -------------------------------------------------------------------------------------
# What JSON has of the answer.


DOCUMENT: Final = Key(
    "Files read back and compared with the exact curves of their scene.",
    {
        "passed": "Whether all files pass.",
        "files": Key(
            "In the order in which they were named.",
            {
                "file": Key("Its name.", type=str),
                "format": Key("Name of its format.", type=str),
                "sha256": Key("SHA-256 of its bytes, hexadecimal.", type=str),
                "bytes": Key("Its size.", type=int),
                "scene": Key(
                    "The scene that it was compared with, if it was measured.",
                    {
                        "name": Key("Name of the scene.", type=str),
                        "sha256": Key("Its hash as written in the file, hexadecimal.", type=str),
                    },
                    type=dict[str, Any],
                    optional=True,
                    by_key=True,
                ),
                "tolerance_mm": Key(
                    "The tolerance that was applied, if it was measured.", type=float, optional=True
                ),
                "tolerance_from": Key(
                    "Origin of the tolerance: the call, the file, its certificate or the scene.",
                    type=str,
                    optional=True,
                ),
                "deviation_mm": Key(
                    "Largest proved deviation; missing if one could not be proved, or there is"
                    " none.",
                    type=float,
                    optional=True,
                ),
                "passed": Key("Whether no check fails.", type=bool),
                "checks": Key(
                    "All checks.",
                    {
                        "name": Key('What was checked, e.g. "deviation".', type=str),
                        "of": Key(
                            "The boundary or operation concerned; missing for the whole file.",
                            type=str,
                            optional=True,
                        ),
                        "value": Key("What was found, in `unit`.", type=float | str, optional=True),
                        "expected": Key("What it should be.", type=float | str, optional=True),
                        "limit": Key(
                            "Largest value, or largest difference from what is expected.",
                            type=float,
                            optional=True,
                        ),
                        "unit": Key("Unit of the numbers.", type=str, optional=True),
                        "ok": Key(
                            "Whether it passes; null for information alone.", type=bool | None
                        ),
                        "note": Key("A sentence or a place.", type=str, optional=True),
                    },
                    type=tuple[dict[str, Any], ...],
                    by_key=True,
                ),
            },
            of="records",
            by_key=True,
        ),
    },
    type=Verification,
)


# -- rendering ------------------------------------------------------------------------------------
# What `camgeo verify` finds, in words.


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
