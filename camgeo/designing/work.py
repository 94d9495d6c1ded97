"""The one door of what the designer computes: a job to JSON data."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Final

from camgeo.designing import painting
from camgeo.designing.job import Job, JobError
from camgeo.designing.recent import Recent
from camgeo.errors import CamgeoError, Fault, SceneError

Work = Callable[[Job, Recent], dict[str, Any]]
"""Does a job; a SceneError becomes the faults of the result, another CamgeoError one fault."""

WORK: Final[Mapping[str, Work]] = {
    "curves": painting.curves,
}
"""What is done for each kind of job."""


def run(job: Job, recent: Recent | None = None) -> dict[str, Any]:
    """The result of a job: finite numbers, texts, lists, tables, None, True and False.

    Parameters
    ----------
    recent : what earlier jobs left to be used again; it changes the time alone.

    Returns
    -------
    With `faults`, a list that is empty if the scene is valid: what is wrong in it never raises.

    Raises
    ------
    JobError
        If there is no such kind of job, or its arguments are wrong.
    """
    if job.kind not in WORK:
        raise JobError(f"there is no job {job.kind!r}; there are {', '.join(WORK)}")
    try:
        return {"faults": [], **WORK[job.kind](job, recent or Recent())}
    except JobError:
        raise
    except SceneError as error:
        return {"faults": [_fault(each) for each in error.faults]}
    except CamgeoError as error:
        return {"faults": [_fault(Fault("", "", str(error)))]}


def warm_up() -> None:
    """Import what jobs need, and compile what is compiled once, with a small scene."""
    from camgeo.scene.new import template  # no job needs it

    run(Job("curves", template("oscillating-roller")))


def _fault(fault: Fault) -> dict[str, Any]:
    return {
        "key": fault.key,
        "value": fault.value,
        "message": fault.message,
        "hint": fault.hint,
        "line": fault.line,
    }
