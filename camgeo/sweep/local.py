"""Whether a file lies on a disk of this machine: SQLite's locks do not hold across a network."""

from __future__ import annotations

import os
import re
import sys
from pathlib import Path
from typing import Final

from camgeo.errors import OutputError

NETWORKED: Final = frozenset(
    {
        "afs", "beegfs", "ceph", "cifs", "coda", "fuse.ceph", "fuse.cephfs", "fuse.glusterfs",
        "fuse.rclone", "fuse.s3fs", "fuse.sshfs", "gfs2", "glusterfs", "gpfs", "lustre", "ncpfs",
        "nfs", "nfs4", "ocfs2", "orangefs", "pvfs2", "smb3", "smbfs",
    }
)  # fmt: skip
"""Kinds of file systems that lie on other machines, as Linux names them."""

MOUNTS: Final = Path("/proc/self/mounts")

REMOTE_DRIVE: Final = 4
"""What Windows calls a drive of another machine."""


def require_local(path: Path) -> None:
    """Raise OutputError if `path` lies on a file system of another machine.

    That is known on Linux and Windows; elsewhere every file passes.
    """
    kind = kind_of(path.resolve())
    if kind in NETWORKED:
        raise OutputError(
            f"{path} lies on a network file system ({kind}), on which a store may be damaged: name"
            " a file on a local disk, and copy it when the run has ended"
        )


def kind_of(path: Path) -> str:
    """The kind of file system that an absolute path lies on; empty if it is not known."""
    if sys.platform == "win32":
        return "smbfs" if _is_remote(path) else ""
    try:
        lines = MOUNTS.read_text("utf-8", "surrogateescape").splitlines()
    except OSError:
        return ""
    return mounted(lines, path)


def mounted(lines: list[str], path: Path) -> str:
    """The kind of the file system among mounts, as Linux lists them, that a path lies on."""
    longest, found = -1, ""
    for line in lines:
        fields = line.split()
        if len(fields) < 3:
            continue
        place = re.sub(r"\\([0-7]{3})", lambda octal: chr(int(octal[1], 8)), fields[1])
        inside = path.is_relative_to(place)
        if inside and len(place) >= longest:  # the last one mounted at a place hides the others
            longest, found = len(place), fields[2]
    return found


def _is_remote(path: Path) -> bool:
    if str(path).startswith("\\\\"):
        return True
    import ctypes

    drive = os.path.splitdrive(path)[0] + "\\"
    kernel = ctypes.windll.kernel32  # type: ignore[attr-defined]  # there is one on Windows
    return bool(kernel.GetDriveTypeW(drive) == REMOTE_DRIVE)
