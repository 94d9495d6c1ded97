"""The process around a command: crashes, signals, and streams that take nothing."""

from __future__ import annotations

import errno
import os
import signal
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from camgeo.app.answers import check
from camgeo.app.answers.answer import CRASHED, STOPPED
from camgeo.app.cli.command import printable
from camgeo.app.cli.main import BLAS_THREADS, TRACEBACK, Stopped, main
from camgeo.design.writing import JOURNAL, NEW, OLD, STAGING

SCENES = Path(__file__).parents[2] / "fixtures" / "scenes"

SETZHUB = str(SCENES / "setzhub.toml")

CAMGEO = [sys.executable, "-m", "camgeo"]

Capture = pytest.CaptureFixture[str]

FULL = os.strerror(errno.ENOSPC)

posix = pytest.mark.skipif(os.name != "posix", reason="a POSIX shell and its signals")


def shell(command: str) -> subprocess.CompletedProcess[str]:
    """The exit codes of `camgeo` and of the rest of a shell command."""
    words = " ".join(CAMGEO)
    return subprocess.run(
        ["sh", "-c", f"{words} {command}"], capture_output=True, text=True, check=False
    )


# -- crashes ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("error", [TypeError("a\nb"), MemoryError(), RecursionError(), OSError(5)])
def test_a_crash_has_its_own_exit_code(
    error: Exception, monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    def crash(*_: object) -> None:
        raise error

    monkeypatch.setattr(check, "check", crash)
    assert main(["check", SETZHUB]) == CRASHED == 70
    captured = capsys.readouterr()
    assert captured.out == ""
    (line,) = captured.err.splitlines()
    assert line.startswith(f"camgeo: internal error ({type(error).__name__}")
    assert "check.py, line " in line
    assert "please report it to the authors of camgeo, with the scene" in line
    assert TRACEBACK in line
    for words in ([TRACEBACK, "check", SETZHUB], ["check", SETZHUB, TRACEBACK]):
        assert main(words) == CRASHED
        first, *_, last = capsys.readouterr().err.splitlines()
        assert first.startswith("Traceback")
        assert last == line


def test_help_names_the_exit_codes(capsys: Capture) -> None:
    with pytest.raises(SystemExit):
        main(["--help"])
    out = capsys.readouterr().out
    assert TRACEBACK in out
    assert f"{CRASHED} an error in camgeo itself" in out


# -- settings of a process of its own --------------------------------------------------------------


@pytest.mark.parametrize(("stated", "used"), [({}, "1"), ({BLAS_THREADS: "2"}, "2")])
def test_blas_has_one_thread_unless_more_are_stated(stated: dict[str, str], used: str) -> None:
    """It reads the variable when numpy is imported, so that must not have happened before."""
    code = (
        "import os, sys\n"
        "from camgeo.app.cli.main import BLAS_THREADS, main\n"
        "early = 'numpy' in sys.modules\n"
        "sys.argv[1:] = ['laws']\n"
        "main()\n"
        "sys.exit(f\"{early} {'numpy' in sys.modules} {os.environ[BLAS_THREADS]}\")\n"
    )
    environment = {name: value for name, value in os.environ.items() if name != BLAS_THREADS}
    done = subprocess.run(
        [sys.executable, "-c", code],
        env=environment | stated,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.stderr.splitlines()[-1] == f"False True {used}"


# -- signals ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_a_command(
    number: int, monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    def stop(*_: object) -> None:
        raise Stopped(number)

    monkeypatch.setattr(check, "check", stop)
    assert main(["check", SETZHUB]) == STOPPED + number
    assert capsys.readouterr().err == f"camgeo: interrupted by {signal.Signals(number).name}\n"


def test_calling_main_from_python_leaves_signals_alone() -> None:
    before = [signal.getsignal(each) for each in (signal.SIGINT, signal.SIGTERM)]
    codes: list[int] = []
    thread = threading.Thread(target=lambda: codes.append(main(["laws", "--task", "R-R"])))
    thread.start()
    thread.join()
    assert codes == [0]
    assert [signal.getsignal(each) for each in (signal.SIGINT, signal.SIGTERM)] == before


SIGNALLED = """
import os, signal, sys
class Numpy:
    def find_spec(self, name, *_):
        if name == "numpy":
            os.kill(os.getpid(), number)
sys.meta_path.insert(0, Numpy())
name, disposition, *sys.argv[1:] = sys.argv[1:]
number = getattr(signal, name)
signal.signal(number, getattr(signal, disposition))
from camgeo.app.cli.main import main
code = main()
print(code, flush=True)
os.kill(os.getpid(), number)  # the end of the process is no part of the command
sys.exit(code)
"""
"""Runs camgeo, and sends itself a signal when it imports numpy.

A process inherits the signals that are ignored: all that a shell starts in the background ignore
SIGINT, and after `nohup` SIGHUP, so the disposition at the start is always stated.
"""


def signalled(*words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", SIGNALLED, *words, "check", SETZHUB],
        capture_output=True, text=True, check=False,
    )  # fmt: skip


@posix
@pytest.mark.parametrize(
    ("name", "disposition"),
    [("SIGINT", "default_int_handler"), ("SIGTERM", "SIG_DFL"), ("SIGHUP", "SIG_DFL")],
)
def test_a_signal_while_camgeo_is_imported(name: str, disposition: str) -> None:
    """The handlers are there before anything large is imported, and gone afterwards.

    As Python sets them up where nothing ignores them; whoever started the tests may.
    """
    run = signalled(name, disposition)
    assert run.stderr == f"camgeo: interrupted by {name}\n"
    assert run.stdout == f"{STOPPED + getattr(signal, name)}\n"
    assert run.returncode == -getattr(signal, name)


@posix
def test_a_signal_that_is_ignored_stays_ignored() -> None:
    """This is how `nohup` starts commands."""
    run = signalled("SIGHUP", "SIG_IGN")
    assert run.stderr == ""
    assert "transmission-angle" in run.stdout
    assert run.returncode == 0


# -- streams ---------------------------------------------------------------------------------------


@posix
@pytest.mark.parametrize(
    ("command", "code", "message"),
    [
        (f"check {SETZHUB} > /dev/full", 2, f"camgeo: standard output: {FULL}\n"),
        ("check none.toml --json > /dev/full", 2, f"camgeo: standard output: {FULL}"),
        ("--help > /dev/full", 2, f"camgeo: standard output: {FULL}\n"),
        (f"check {SETZHUB} >&-", 2, f"camgeo: standard output: {os.strerror(errno.EBADF)}\n"),
        ("table --law modified-sine 2>&- | head -1 >&2", 0, "z,"),
        ("check none.toml 2>&-", 2, ""),
        ("check none.toml 2>/dev/full", 2, ""),
        ("check none.toml >&- 2>&- <&-", 2, ""),
    ],
)
def test_streams_that_take_nothing(command: str, code: int, message: str) -> None:
    if "/dev/full" in command and not Path("/dev/full").exists():
        pytest.skip("no /dev/full")
    run = shell(command)
    assert run.returncode == code
    assert run.stdout == ""
    assert run.stderr.startswith(message)
    assert bool(run.stderr) == bool(message)


def test_file_names_do_not_direct_the_terminal(capsys: Capture) -> None:
    name = "\x1b[31mred\x9b\u202e\udcff.toml"
    assert printable(f"{name}\n\tend ö φ") == r"\x1b[31mred\x9b\u202e\udcff.toml" + "\n\tend ö φ"
    assert main(["check", name]) == 2
    with pytest.raises(SystemExit):
        main(["check", "a", name])
    with pytest.raises(SystemExit):
        main([name])
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.count(r"\x1b[31mred\x9b\u202e\udcff.toml") == 3
    assert "\x1b" not in captured.err


# -- what an interrupted run has left --------------------------------------------------------------


def test_build_and_verify_restore_and_say_so(tmp_path: Path, capsys: Capture) -> None:
    build = ["build", SETZHUB, "--only", "csv", "-o", str(tmp_path)]
    assert main(build) == 0
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    verify = ["verify", "--scene", SETZHUB]
    for words in ([*verify, str(tmp_path)], [*verify, str(tmp_path / "setzhub.csv")], build):
        for place in (NEW, OLD):
            (tmp_path / STAGING / place).mkdir(parents=True)
        (tmp_path / "certificate.json").rename(tmp_path / STAGING / OLD / "certificate.json")
        (tmp_path / STAGING / JOURNAL).write_text('["setzhub.csv", "certificate.json"]')
        (tmp_path / "setzhub.csv").rename(tmp_path / STAGING / OLD / "setzhub.csv")
        (tmp_path / "setzhub.csv").write_text("new")
        capsys.readouterr()
        assert main(words) == 0
        captured = capsys.readouterr()
        assert f"{tmp_path}: a run was interrupted here" in captured.err
        assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_verify_names_what_it_cannot_restore(tmp_path: Path, capsys: Capture) -> None:
    (tmp_path / STAGING).mkdir()
    (tmp_path / STAGING / JOURNAL).write_text("damaged")
    assert main(["verify", str(tmp_path)]) == 2
    err = capsys.readouterr().err
    assert "a run was interrupted here" in err
    assert "cannot be put back" in err
