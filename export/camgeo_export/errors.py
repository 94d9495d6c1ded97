"""The error of a file that was read back."""

from __future__ import annotations

from camgeo.errors import CamgeoError


class FileError(CamgeoError, ValueError):
    """A file does not hold what its writer puts into such a file: cut short, changed or foreign."""
