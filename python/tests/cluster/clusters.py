"""Clusters of two workers on this machine, and the killing of one worker."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path

import dask.config
import distributed
import psutil
import pyarrow as pa

from iiwasim._chunks import Planning

# Ray reads these on import: no usage reports, and the loopback interface only, as on other systems
# than Linux.
os.environ |= {"RAY_USAGE_STATS_ENABLED": "0", "RAY_ENABLE_WINDOWS_OR_OSX_CLUSTER": "0"}

import ray

# Timeout for broken runs; no test measures against it.
LONG_S = 300.0
STORE_BYTES = 200_000_000


@contextmanager
def ray_cluster(workers: int = 2) -> Iterator[None]:
    """Ray with `workers` CPUs; all its processes end with the context."""
    ours = set(psutil.Process().children(recursive=True))
    ray.init(
        num_cpus=workers,
        object_store_memory=STORE_BYTES,
        include_dashboard=False,
        log_to_driver=False,
        logging_level="ERROR",
    )
    started = set(psutil.Process().children(recursive=True)) - ours
    try:
        yield
    finally:
        ray.shutdown()
        _, left = psutil.wait_procs(started, LONG_S)
        assert not left, f"Ray left {left}"


@contextmanager
def dask_cluster(workers: int = 2) -> Iterator[distributed.Client]:
    """Dask with `workers` processes of one thread each."""
    with (
        # By default, Dask removes a worker for good if it is not running 15 s after it died. On a
        # loaded machine, tests that kill workers could lose all of them.
        dask.config.set({"distributed.deploy.lost-worker-timeout": f"{LONG_S}s"}),
        distributed.LocalCluster(
            n_workers=workers,
            threads_per_worker=1,
            host="127.0.0.1",
            dashboard_address="127.0.0.1:0",
            memory_limit=0,
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        yield client


CLUSTERS = {"cores": nullcontext, "ray": ray_cluster, "dask": dask_cluster}


def victim(pid_file: Path) -> type[Planning]:
    """A `Planning` that makes one worker wait to be killed: the first one after the folder of
    `pid_file` exists.
    """
    # Dask plans an empty table in this process, to find the columns.
    here = os.getpid()

    class Victim(Planning):
        def figures(self, chunk: pa.Table) -> pa.Table:
            if os.getpid() == here:
                return super().figures(chunk)
            try:
                with pid_file.open("x") as file:
                    print(os.getpid(), file=file)
            except (FileExistsError, FileNotFoundError):
                return super().figures(chunk)
            time.sleep(LONG_S)
            raise TimeoutError("nobody has killed this worker")

    return Victim


def kill_victim(pid_file: Path) -> None:
    """Kills the worker that waits to be killed."""
    until = time.monotonic() + LONG_S
    while not (pid_file.exists() and pid_file.read_text().endswith("\n")):
        assert time.monotonic() < until, "no worker has begun"
        time.sleep(0.01)
    os.kill(int(pid_file.read_text()), signal.SIGKILL)
