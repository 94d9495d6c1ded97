"""The faults of a scene and the verdict on it, as data for the page."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Final

from camgeo.app.answers.answer import MARKS, error_faults
from camgeo.errors import CamgeoError, Fault
from camgeo.scene.keys import key_lines, nearest_line, parse_path
from camgeo.units import counted


def faults_as_data(error: CamgeoError, text: str = "") -> list[dict[str, Any]]:
    """The faults of a scene with that `text`; any other error as a single fault, at its key."""
    return [
        {
            "key": fault.key,
            "value": fault.value,
            "message": fault.message,
            "hint": fault.hint,
            "line": fault.line,
        }
        for fault in _with_lines(error_faults(error), text)
    ]


def _with_lines(faults: tuple[Fault, ...], text: str) -> tuple[Fault, ...]:
    """The faults, each with the line of its key; those of a computation come without lines."""
    if all(fault.line is not None or not fault.key for fault in faults):
        return faults
    lines = key_lines(text.replace("\r\n", "\n"))  # only a text that is TOML has faults with keys
    return tuple(
        fault
        if fault.line
        else replace(fault, line=nearest_line(parse_path(fault.key) or (), lines))
        for fault in faults
    )


# -- verdict --------------------------------------------------------------------------------------
# The one verdict on a scene that a page shows, never better than what is known.
#
# It is made from the results of jobs, so that faults that only the findings or the files reveal
# count as well.


WAITING: Final = "waiting"
"""Severity of a scene whose findings have not come yet."""

UNKNOWN: Final = "unknown"
"""Severity of a scene without a verdict, because a job has no result."""

Results = Mapping[str, Mapping[str, Any]]
"""Results of the jobs "curves", "findings" and "build" of one text, as far as they have come:
`faults`, and of the second `verdict` and `findings`. With `refused`, a sentence, a job has no
result.
"""


def scene_verdict(results: Results) -> dict[str, Any]:
    """The verdict: its `severity`, a `sentence`, and the `faults`.

    The severity is "invalid" if there are faults, else `UNKNOWN` or `WAITING` if that holds, else
    that of the worst finding, "ok" without any.
    """
    judged, built = results.get("findings", {}), results.get("build", {})
    # Those of the curves are among those of the findings.
    of_scene = results.get("curves", {}).get("faults") or judged.get("faults")
    faults = of_scene or built.get("faults")
    refused = judged.get("refused") or built.get("refused")
    if faults:
        number = "a fault" if len(faults) == 1 else counted(len(faults), "fault")
        sentence = f"The scene has {number}." if of_scene else f"There are no files: {number}."
        return {"severity": "invalid", "sentence": sentence, "faults": faults}
    if refused:
        return {"severity": UNKNOWN, "sentence": f"There is no verdict: {refused}.", "faults": []}
    if "findings" not in judged:
        return {"severity": WAITING, "sentence": "Findings are being computed.", "faults": []}
    severities = {finding["severity"] for finding in judged["findings"]}
    worst = next((severity for severity in MARKS if severity in severities), "ok")
    return {"severity": worst, "sentence": judged["verdict"], "faults": []}
