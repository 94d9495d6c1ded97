"""The one door of what the designer computes: a job to JSON data."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any, Final

from camgeo.designing import judging, making, offers, painting
from camgeo.designing.faults import told
from camgeo.designing.job import Job, JobError
from camgeo.designing.recent import Recent
from camgeo.errors import CamgeoError
from camgeo.scene.new import KINDS, template

Work = Callable[[Job, Recent], dict[str, Any]]
"""Does a job; JobError if its arguments are wrong, any other CamgeoError tells faults."""

WORK: Final[Mapping[str, Work]] = {
    "curves": painting.curves,
    "change": painting.change,
    "findings": judging.findings,
    "build": making.build,
    "size": making.size,
    "solid": making.solid,
    "laws": offers.laws,
    "templates": offers.templates,
    "effects": offers.effects,
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
        raise JobError(f"there is no job {job.kind[:60]!r}; there are {', '.join(WORK)}")
    recent = recent or Recent()
    try:
        return {"faults": [], **WORK[job.kind](job, recent)}
    except JobError:
        raise
    except CamgeoError as error:
        recent.restate(job, error)
        return {"faults": told(error, job.text)}


def prepared() -> Callable[[Job], dict[str, Any]]:
    """What does jobs one after the other, warm: imported, and tried with a small scene."""
    text = template(KINDS[0])
    for kind in ("curves", "findings"):
        run(Job(kind, text))
    run(Job("change", text, arguments={"edits": {"name": "warm"}}))
    return partial(run, recent=Recent())
