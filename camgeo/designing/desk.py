"""What a designer edits: one scene with its history, its file on disk and its journal."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

from camgeo.designing import opened as files
from camgeo.designing.history import History
from camgeo.designing.journal import Journal, Kept, change
from camgeo.designing.opened import Disk, Opened, OverwriteError
from camgeo.errors import FileError

RESTORED: Final = (
    "unsaved edits of {name} have been restored; undo takes them back step by step, reload goes"
    " back to the file on disk"
)


class Desk:
    """One scene being edited in a folder; every change is written into its journal at once.

    Parameters
    ----------
    folder : the only one in which scenes are opened and saved.
    states : folder of journals; None for that of the user.

    Attributes
    ----------
    history : the scene's text and what it was before.
    opened : its file as it was read or saved last; None if it is in none yet.
    """

    def __init__(self, folder: Path, states: Path | None = None) -> None:
        self.folder = folder.resolve()
        self.history = History("")
        self.opened: Opened | None = None
        self._states = states
        self._journal: Journal | None = None
        self._told: list[str] = []

    @property
    def text(self) -> str:
        """The scene's present text."""
        return self.history.text

    @property
    def name(self) -> str | None:
        """The scene's file, as a path in the folder; None if it is in none yet."""
        if self.opened is None:
            return None
        return self.opened.path.relative_to(self.folder).as_posix()

    @property
    def beside(self) -> Path:
        """The folder in which the files lie that the scene names."""
        return self.folder if self.opened is None else self.opened.path.parent

    @property
    def saved(self) -> bool:
        """Whether the text is the one that was read or saved last."""
        if self.opened is None:
            return not self.text
        return files.digest(self.text.encode()) == self.opened.digest

    @property
    def disk(self) -> Disk:
        """How the file on disk compares with what was read or saved last."""
        return "same" if self.opened is None else files.disk(self.opened)

    def told(self) -> list[str]:
        """Sentences for the user since the last call."""
        told, self._told = self._told, []
        return told

    def open(self, name: str) -> None:
        """Switch to the scene file `name`, with its unsaved edits; those of the last one are kept.

        Raises
        ------
        FileError
            If it cannot or must not be read, or if another process is editing it.
        """
        path = files.place(self.folder, name)
        if self.opened is not None and self.opened.path == path:
            return
        journal = Journal.opened(str(path), self._states)
        try:
            text, found = files.read(path)
        except FileError:
            if path.exists() or journal.kept is None or journal.kept.history is None:
                journal.close(keep=True)
                raise
            text, found = "", Opened(path, journal.kept.saved)
        self._leave()
        self._journal = journal
        self.history, self.opened = self._restored(text, found, journal.kept)

    def begin(self) -> None:
        """Switch to the scene of this folder that is in no file yet, with its unsaved edits."""
        if self._journal is not None and self.opened is None:
            return
        journal = Journal.opened(f"{self.folder}{os.sep}", self._states)
        self._leave()
        self._journal = journal
        self.history, self.opened = self._restored("", None, journal.kept)

    def change(self, text: str, label: str, gesture: str = "") -> None:
        """Give the scene another text, see `History.changed`; FileError if it is none."""
        files.encoded(text, self.name or "scene")
        if text != self.text:
            event = change(self.text, text, label, gesture)
            self._note(self.history.changed(text, label, gesture), event)

    def undo(self) -> None:
        """Undo the latest step, if there is one."""
        if self.history.past:
            self._note(self.history.undone(), {"do": "undo"})

    def redo(self) -> None:
        """Redo the step that was undone last, if there is one."""
        if self.history.future:
            self._note(self.history.redone(), {"do": "redo"})

    def reload(self) -> None:
        """Take the text from disk, as a step that can be undone; FileError if there is none."""
        if self.opened is None:
            raise FileError("the scene is in no file yet")
        text, self.opened = files.read(self.opened.path)
        self.change(text, f"{self.name} from disk")
        self._note(self.history, self._saved_event(self.opened))

    def save(self, name: str | None = None, *, force: bool = False) -> None:
        """Save the scene; if a `name` is given, under that name, which it then keeps.

        Raises
        ------
        OverwriteError
            If that would overwrite something that was not read, and `force` is not set.
        FileError, OutputError
            If it cannot be saved there.
        """
        path = self.opened.path if name is None and self.opened else None
        if path is None:
            if name is None:
                raise FileError("the scene is in no file yet; it needs a name")
            path = files.place(self.folder, name)
        if self.opened is not None and path == self.opened.path:
            self.opened = files.saved(path, self.text, self.opened, force=force)
        else:
            self._save_elsewhere(path, force=force)
        self._note(self.history, self._saved_event(self.opened))

    def sync(self) -> None:
        """Wait until all edits are on disk; callable from another thread."""
        journal = self._journal
        if journal is not None:
            journal.sync()

    def close(self) -> None:
        """End editing; unsaved edits stay in the journal."""
        self._leave()

    def _save_elsewhere(self, path: Path, *, force: bool) -> None:
        journal = Journal.opened(str(path), self._states)
        try:
            kept = journal.kept
            if kept and kept.history and kept.history.text != self.text and not force:
                raise OverwriteError(f"{path.name} has unsaved edits of its own")
            self.opened = files.saved(path, self.text, None, force=force)
        except BaseException:
            journal.close(keep=True)
            raise
        if self._journal is not None:
            self._journal.close(keep=False)
        self._journal = journal

    def _restored(
        self, text: str, found: Opened | None, kept: Kept | None
    ) -> tuple[History, Opened | None]:
        """The history to continue, and the file as it was when that history was written."""
        if self._journal is not None and self._journal.fault:
            self._told.append(self._journal.fault)
        if kept is None:
            return History(text), found
        name = "the new scene" if found is None else found.path.name
        if kept.damage:
            self._told.append(f"the journal of {name} is damaged, edits may be lost: {kept.damage}")
        if kept.history is None:
            return History(text), found
        if kept.history.text == text:
            return kept.history, found
        self._told.append(RESTORED.format(name=name))
        if found is not None and found.digest != kept.saved:
            self._told.append(f"{name} has been changed on disk since they were made")
            found = Opened(found.path, kept.saved)
        return kept.history, found

    def _saved_event(self, opened: Opened | None) -> dict[str, Any]:
        return {"do": "saved", "saved": "" if opened is None else opened.digest}

    def _note(self, history: History, event: Mapping[str, Any]) -> None:
        """Continue with a history whose latest part is `event`."""
        self.history = history
        if self._journal is not None:
            fault = self._journal.fault
            self._journal.add(history, event, "" if self.opened is None else self.opened.digest)
            if self._journal.fault != fault:
                self._told.append(self._journal.fault)

    def _leave(self) -> None:
        """Close the journal; edits that are not saved stay in it."""
        if self._journal is None:
            return
        if not self.saved:
            name = self.name or "the new scene"
            self._told.append(f"unsaved edits of {name} are kept until it is opened again")
        self._journal.close(keep=not self.saved)
        self._journal = None
