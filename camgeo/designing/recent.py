"""What jobs leave behind for those that follow: the last design, for a scene that is its edit."""

from __future__ import annotations

from camgeo.design import Design
from camgeo.designing.job import Job
from camgeo.scene.load import parse_scene


class Recent:
    """The design of the last scene that was valid."""

    def __init__(self) -> None:
        self._job: Job | None = None
        self._design: Design | None = None

    def design(self, job: Job) -> Design:
        """The design of a job's scene; SceneError if it is not valid."""
        return Design(parse_scene(job.text, job.file, job.folder or None))
