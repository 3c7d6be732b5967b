"""Connections to a drive: addresses, keys, loss."""

from __future__ import annotations

import math
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

pytest.importorskip("zmq", reason="the client of the drive needs pyzmq")

from drive_runs import AWAY, SLOW, in_background, program
from simulated_robot import SimulatedRobot, binary, free_ports

from iiwasim.drive import Drive, DriveTimeout

if TYPE_CHECKING:
    from collections.abc import Iterator


def test_no_drive_is_a_timeout() -> None:
    at = f"127.0.0.1:{free_ports(1)[0]}"
    with Drive(at, timeout_s=0.3) as drive:
        for request in (
            drive.state,
            drive.stop,
            lambda: next(drive.stream()),
            lambda: drive.run(program(AWAY)),
        ):
            with pytest.raises(
                DriveTimeout, match=r"no drive answers at tcp://127.*`iiwasim drive`"
            ) as absent:
                request()
            assert absent.value.code == "timeout"


def test_a_drive_that_ends_in_a_run_is_noticed(tmp_path: Path) -> None:
    with SimulatedRobot(tmp_path) as robot, Drive(robot.address, timeout_s=30) as drive:
        robot.wait_until_ready(drive)
        with in_background(drive.run, SLOW) as results:
            robot.drive.kill()
        (lost,) = results
        assert isinstance(lost, DriveTimeout) and "lost before its reply" in lost.message
        stream = drive.stream()
        drive._timeout_s = 0.3
        with pytest.raises(DriveTimeout):
            next(stream)


@pytest.fixture(scope="module")
def keyed(tmp_path_factory: pytest.TempPathFactory) -> Iterator[SimulatedRobot]:
    """A robot whose drive accepts Alice's key."""
    folder = tmp_path_factory.mktemp("keyed")
    for name in ("drive", "alice", "mallory"):
        command = [binary(), "keygen", name, "-o", folder / "keys"]
        subprocess.run(command, check=True, capture_output=True)
    (folder / "clients").mkdir()
    (folder / "clients/alice.pub").write_bytes((folder / "keys/alice.pub").read_bytes())
    options = ("--key", "keys/drive.key", "--allow", "clients")
    with SimulatedRobot(folder, drive=options) as robot:
        keys = {"key": folder / "keys/alice.key", "server_key": folder / "keys/drive.pub"}
        robot.wait_until_ready(Drive(robot.address, timeout_s=30, **keys))
        yield robot


def test_the_right_keys_open_everything(
    keyed: SimulatedRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("IIWASIM_KEY", str(keyed.folder / "keys/alice.key"))
    monkeypatch.setenv("IIWASIM_SERVER_KEY", str(keyed.folder / "keys/drive.pub"))
    with Drive(keyed.address, stream=keyed.stream) as drive:
        assert drive.run(program(AWAY), move_to_start=True).cycle_time_s
        assert next(drive.stream()).q.shape == (7,)


@pytest.mark.parametrize(
    ("keys", "says"),
    [
        ({}, "it requires keys"),
        ({"key": "mallory.key", "server_key": "drive.pub"}, "`key` is not on its list"),
        ({"key": "alice.key", "server_key": "mallory.pub"}, "is `server_key` its .pub file"),
    ],
)
def test_wrong_keys_open_nothing(keyed: SimulatedRobot, keys: dict[str, str], says: str) -> None:
    given = {name: keyed.folder / "keys" / file for name, file in keys.items()}
    with Drive(keyed.address, stream=keyed.stream, **given) as drive:
        for request in (
            drive.state,
            lambda: next(drive.stream()),
            lambda: drive.run({"motions": []}),
        ):
            with pytest.raises(DriveTimeout, match=says) as refused:
                request()
            assert refused.value.code == "unauthorized"


def test_keys_are_of_no_use_where_a_drive_has_none(
    keyed: SimulatedRobot, robot: SimulatedRobot
) -> None:
    keys = {"key": keyed.folder / "keys/alice.key", "server_key": keyed.folder / "keys/drive.pub"}
    with Drive(robot.address, **keys) as drive, pytest.raises(DriveTimeout, match="it has no keys"):
        drive.state()


def test_files_that_are_no_keys_are_refused(keyed: SimulatedRobot) -> None:
    keys = keyed.folder / "keys"
    exposed = keys / "exposed.key"
    exposed.write_bytes((keys / "alice.key").read_bytes())
    exposed.chmod(0o644)
    (keys / "none.pub").write_text("nothing\n")
    for key, server_key, says in [
        ("alice.key", None, "server_key, the drive's .pub file"),
        (None, "drive.pub", "key, your own .key file"),
        ("alice.pub", "drive.pub", "a public key only"),
        ("alice.key", "drive.key", "give the .pub file"),
        ("alice.key", "bob.pub", "bob.pub"),
        ("alice.key", "none.pub", "none.pub is not a key file"),
        ("exposed.key", "drive.pub", r"mode 0644.*chmod 600"),
    ]:
        given = {"key": key and keys / key, "server_key": server_key and keys / server_key}
        with pytest.raises(ValueError, match=says):
            Drive("robot-pc:5560", **given)


def test_addresses_are_those_of_the_command(monkeypatch: pytest.MonkeyPatch) -> None:
    def at(*address: str, **options: str) -> tuple[str, str]:
        drive = Drive(*address, **options)
        return drive._at, drive._stream_at

    assert at() == ("tcp://127.0.0.1:5560", "tcp://127.0.0.1:5561")
    assert at("tcp://localhost:70") == ("tcp://127.0.0.1:70", "tcp://127.0.0.1:71")
    assert at("[::1]:70", stream="127.0.0.1:9") == ("tcp://[::1]:70", "tcp://127.0.0.1:9")
    monkeypatch.setenv("IIWASIM_DRIVE", "127.0.0.2:80")
    assert at() == ("tcp://127.0.0.2:80", "tcp://127.0.0.2:81")
    monkeypatch.setenv("IIWASIM_STREAM", "127.0.0.2:90")
    assert at() == ("tcp://127.0.0.2:80", "tcp://127.0.0.2:90")
    assert at("127.0.0.1:70") == ("tcp://127.0.0.1:70", "tcp://127.0.0.1:71")
    for wrong in (
        "5560",
        "127.0.0.1",
        "127.0.0.1:0",
        "127.0.0.1:70000",
        "udp://127.0.0.1:5560",
        "::1:5560",
        "a b:5",
    ):
        with pytest.raises(ValueError, match="is not an address"):
            Drive(wrong)
    for elsewhere in ("192.168.0.9:5560", "robot-pc:5560", "0.0.0.0:5560"):
        with pytest.raises(ValueError, match="may be another machine, so keys are required"):
            Drive(elsewhere)
    for timeout_s in (0.0, -1.0, math.inf, math.nan):
        with pytest.raises(ValueError, match="timeout_s"):
            Drive(timeout_s=timeout_s)


def test_without_pyzmq_it_says_what_to_install() -> None:
    missing = "import sys; sys.modules['zmq'] = None; import iiwasim.drive as d; d.Run; d.Drive()"
    ended = subprocess.run(
        [sys.executable, "-c", missing], check=False, capture_output=True, text=True
    )
    assert ended.returncode == 1
    assert (
        "ImportError: the client of the drive needs pyzmq: pip install 'iiwasim[drive]'"
        in ended.stderr
    )
