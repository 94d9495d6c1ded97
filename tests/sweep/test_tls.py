"""A cluster with TLS: rows come through, and nobody without its certificate."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import AbstractContextManager

import pytest

from camgeo.errors import CamgeoError
from camgeo.studies.sweep import cluster
from camgeo.studies.sweep.cluster import Cluster
from camgeo.studies.sweep.rows import compute_rows
from tests.sweep.families import FIXTURES, family
from tests.sweep.processes import AT_ONCE, Processes
from tests.sweep.test_rows import work_on

dask = pytest.importorskip("dask", reason="needs camgeo[cluster]")
pytest.importorskip("distributed", reason="needs camgeo[cluster]")
pytest.importorskip("psutil")

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="ends processes as POSIX does")

TLS = FIXTURES / "tls"

OPTIONS = (
    "--protocol", "tls", "--tls-ca-file", str(TLS / "cluster.pem"),
    "--tls-cert", str(TLS / "cluster.pem"), "--tls-key", str(TLS / "cluster-key.pem"),
)  # fmt: skip


def certificate(name: str) -> AbstractContextManager[object]:
    """Variables of the environment, as docs/sweep.md names them."""
    variables = {
        "DASK_DISTRIBUTED__COMM__TLS__CA_FILE": str(TLS / f"{name}.pem"),
        "DASK_DISTRIBUTED__COMM__TLS__CLIENT__CERT": str(TLS / f"{name}.pem"),
        "DASK_DISTRIBUTED__COMM__TLS__CLIENT__KEY": str(TLS / f"{name}-key.pem"),
    }
    stated = dask.config.merge(dask.config.config, dask.config.collect_env(variables))
    found: AbstractContextManager[object] = dask.config.set(stated)
    return found


@pytest.fixture(scope="module")
def processes(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Processes]:
    found = Processes(tmp_path_factory.mktemp("tls"), AT_ONCE, OPTIONS, workers=1)
    try:
        with certificate("cluster"):
            found.wait()
        yield found
    finally:
        found.end()


def test_the_rows_of_the_loop_come_through_tls(processes: Processes) -> None:
    assert processes.address.startswith("tls://127.0.0.1:")
    found = family("follower.base_radius=45:60:6")
    work = work_on(found, "transmission-angle")
    with certificate("cluster"):
        rows = [
            row for chunk in Cluster(processes.address).rows(work, found.points()) for row in chunk
        ]
    assert sorted(rows, key=lambda row: row.point) == list(compute_rows(work, found.points()))
    assert set(processes.listening()) == {"127.0.0.1"}


@pytest.mark.parametrize("who", ["stranger", "plain"])
def test_whoever_has_no_certificate_of_it_is_refused(
    who: str, processes: Processes, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster, "REACHED", 1.0)
    found = family("follower.base_radius=45,46")
    address = processes.address if who == "stranger" else processes.address.replace("tls", "tcp")
    with (
        certificate("stranger"),
        pytest.raises(CamgeoError, match=f"no Dask scheduler can be reached at {address}: "),
    ):
        list(Cluster(address).rows(work_on(found, "laws"), found.points()))
