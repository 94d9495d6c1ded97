"""`camgeo design`: design a scene live in the browser, with a server on this machine."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Final

from camgeo.app.answers.answer import FINE
from camgeo.app.cli.command import Argument, CallError, notify, say, until_ctrl_c
from camgeo.errors import FileError

DESIGNERS: Final = "camgeo.designers"
"""Entry points of designers: callables that serve a desk with its scene to a browser."""

EXTRA: Final = "pip install 'camgeo[design]'"

HOST: Final = "127.0.0.1"

EXAMPLE: Final = "camgeo design fixtures/scenes/setzhub.toml"


def _port(text: str) -> int:
    if not (text.isascii() and text.isdigit() and int(text) < 65_536):
        raise argparse.ArgumentTypeError("must be a whole number from 0 to 65535")
    return int(text)


ARGUMENTS: Final = (
    Argument(
        "scene",
        metavar="SCENE",
        nargs="?",
        help="scene file (TOML); default: the page offers those in the folder, and new ones",
    ),
    Argument("--port", type=_port, default=0, help="port to listen on; default: one that is free"),
    Argument(
        "--host",
        default=HOST,
        help=f"address to listen on; default {HOST}, which only this machine can reach",
    ),
    Argument("--no-browser", action="store_true", help="print the address, and open no browser"),
)


def run(arguments: argparse.Namespace) -> int:
    """Serve until Ctrl-C."""
    from importlib.metadata import entry_points

    from camgeo.app.designing.desk import Desk

    try:
        serve = entry_points(group=DESIGNERS)["browser"].load()
    except ModuleNotFoundError as error:
        message = f"the designer needs packages that are not installed ({error.name}): {EXTRA}"
        raise CallError(message) from error
    arguments.progress.end()
    scene = None if arguments.scene is None else Path(arguments.scene)
    if scene is not None and not scene.is_file():
        raise FileError(f"{scene}: there is no such file")
    scene = None if scene is None else scene.resolve()
    desk = Desk(Path.cwd() if scene is None else scene.parent)
    if scene is None:
        desk.begin()
    else:
        desk.open(scene.name)

    notes = desk.take_messages()

    def announce(address: str, alone: bool) -> None:
        for sentence in notes:
            notify(sentence)
        say(f"{arguments.scene or desk.folder}: the designer is at\n  {address}\nCtrl-C ends it.")
        if not alone:
            notify(
                f"Other machines can reach this server at {arguments.host}: anyone who learns the"
                f" address can change the scenes in {desk.folder}, and nothing is encrypted."
            )

    browser = not arguments.no_browser
    try:
        with until_ctrl_c():
            serve(desk, arguments.host, arguments.port, announce, notes=notes, browser=browser)
    finally:
        desk.close()
        for sentence in desk.take_messages():
            notify(sentence)
    return FINE
