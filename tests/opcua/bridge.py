#!/usr/bin/env python3
"""Checks the OPC UA server of `iiwasim bridge`, built with the feature `opcua`, with a simulated
robot.

    bridge.py PROGRAM

A client with asyncua reads a run, stops it on its path, and observes a restart of the drive.
Without --allow-commands, the stop method is missing. The last line has figures. Exit code 1 when a
check fails. Needs the packages in requirements.txt.
"""

from __future__ import annotations

import asyncio
import json
import logging
import subprocess
import sys
import tempfile
import time
from contextlib import asynccontextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "browser"))

from asyncua import Client, ua

from check import (
    AXIS,
    MACHINE,
    TASK,
    System,
    Types,
    Visitor,
    check,
    failures,
    make_certificates,
    near,
)
from ports import free_ports
from rig import Rig

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Callable

NAME = "cell-1"
STATE = f"{MACHINE}/B:CurrentState"
PROGRAM_NAME = f"{TASK}/D:ParameterSet/TaskProgramName"
END = [1.5, 0.5, 0.0, -1.0, 0.0, 0.7, 0.0]
# A program of nine seconds.
THERE = {
    "version": 1,
    "robot": "lbr_iiwa_7_r800",
    "start": {"joints_rad": [0.0] * 7},
    "motions": [{"type": "ptp", "joints_rad": END, "velocity_rel": 0.1}],
}
POLL_S = 0.02


def listening(process: subprocess.Popen) -> set[tuple[str, int]]:
    """Listening addresses of a process."""
    inodes = set()
    for file in Path(f"/proc/{process.pid}/fd").iterdir():
        name = ""
        # The file descriptor may have been closed meanwhile.
        with suppress(FileNotFoundError):
            name = str(file.readlink())
        if name.startswith("socket:"):
            inodes.add(name[8:-1])
    found = set()
    for table in ("tcp", "tcp6"):
        for line in Path(f"/proc/{process.pid}/net/{table}").read_text().splitlines()[1:]:
            local, state, inode = (line.split()[at] for at in (1, 3, 9))
            if state == "0A" and inode in inodes:
                address, port = local.split(":")
                ip = (
                    ".".join(str(byte) for byte in reversed(bytes.fromhex(address)))
                    if len(address) == 8
                    else address
                )
                found.add((ip, int(port, 16)))
    return found


@asynccontextmanager
async def served(rig: Rig, *options: str) -> AsyncIterator[tuple[System, subprocess.Popen, int]]:
    """Runs a bridge, and returns the robot as seen by a client."""
    (port,) = free_ports(1)
    certificates = rig.folder / "clients"
    if not certificates.exists():
        make_certificates(certificates)
    (rig.folder / "password.txt").write_text("secret-1\n")
    own = ["--opcua", f"127.0.0.1:{port}", "--opcua-certificates", "server", "--name", NAME]
    own += ["--opcua-trust", str(certificates / "trusted.der")]
    own += ["--opcua-user", "anna", "--opcua-password-file", "password.txt"]
    bridge = rig.start("bridge", *own, *options, *rig.drive_at, *rig.stream_at)
    visitor = Visitor(f"opc.tcp://127.0.0.1:{port}", certificates)
    client = await connected(visitor)
    try:
        types = Types(client, await client.get_namespace_array())
        devices = client.get_node(ua.NodeId(5001, types.devices))
        robots = [ref for ref in await types.below(devices) if ref.BrowseName.Name == NAME]
        check("there is one robot of that name", len(robots) == 1, robots)
        yield System(client.get_node(robots[0].NodeId), types), bridge, port
    finally:
        await client.disconnect()
        bridge.terminate()
        check("the bridge ends", bridge.wait(10) == 0, bridge.returncode)


async def connected(visitor: Visitor) -> Client:
    """Connects as soon as the server is available."""
    until = time.monotonic() + 20
    while True:
        try:
            client = await visitor.client()
            await client.connect()
        except OSError:
            if time.monotonic() > until:
                raise
            await asyncio.sleep(0.1)
        else:
            return client


async def wait_for(
    what: str, path: str, system: System, holds: Callable[[ua.DataValue], bool]
) -> None:
    until = time.monotonic() + 20
    while True:
        found = await system.read(path)
        if holds(found):
            return
        if time.monotonic() > until:
            check(what, False, found)
            return
        await asyncio.sleep(POLL_S)


def given(value: object) -> Callable[[ua.DataValue], bool]:
    def holds(found: ua.DataValue) -> bool:
        it = found.Value.Value if found.Value else None
        return (it.Text if isinstance(it, ua.LocalizedText) else it) == value

    return holds


def status(rig: Rig) -> dict:
    done = subprocess.run(
        [rig.program, "status", "--json", *rig.drive_at],
        check=True,
        capture_output=True,
        text=True,
        timeout=30,
    )
    return json.loads(done.stdout)


async def axes(system: System) -> list[float]:
    return [await system.value(AXIS.format(joint, "ActualPosition")) for joint in range(1, 8)]


async def check_run(rig: Rig, system: System) -> float:
    """Observes the run of a program, and stops it; returns the time that the stop takes."""
    file = rig.folder / "there.json"
    file.write_text(json.dumps(THERE))
    await wait_for("the robot is ready", STATE, system, given("Ready"))
    command = ["run", str(file), "--no-output", *rig.drive_at, *rig.stream_at]
    run = rig.start(*command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    await wait_for("a program runs", STATE, system, given("Executing"))
    await wait_for("its name", PROGRAM_NAME, system, given("there"))
    await wait_for(
        "the first axis turns",
        AXIS.format(1, "ActualPosition"),
        system,
        lambda it: it.Value.Value > 0.2,
    )
    speed = await system.value(AXIS.format(1, "ActualSpeed"))
    check("with a tenth of its speed", 0.05 < speed < 0.3, speed)

    machine = await system.at(MACHINE)
    began = time.monotonic()
    result = await machine.call_method(
        f"{system.types.robotics}:Stop", ua.Variant(0, ua.VariantType.Int64)
    )
    took_s = time.monotonic() - began
    check("the stop", result == 0, result)
    now = status(rig)
    check("the drive is idle when it is answered", now["state"] == "idle", now)
    share = now["joints_rad"][0] / END[0]
    check("the arm stands on the way", 0.1 < share < 0.9, share)
    for joint, end in enumerate(END):
        near(f"joint {joint + 1} on the path", now["joints_rad"][joint], share * end, 2e-3)
    code = await asyncio.to_thread(run.wait, 10)
    check(
        "iiwasim run fails and reports the stop", code != 0 and b"stop" in run.stdout.read(), code
    )
    await wait_for("no program runs", STATE, system, given("Ready"))
    # Values are from the next update after the stop.
    first, rest = AXIS.format(1, "ActualPosition"), status(rig)["joints_rad"][0]
    await wait_for(
        "the first axis rests", first, system, lambda it: abs(it.Value.Value - rest) < 1e-5
    )
    for joint, (shown, measured) in enumerate(
        zip(await axes(system), status(rig)["joints_rad"], strict=True)
    ):
        near(f"joint {joint + 1} as the drive has it", shown, measured, 1e-5)
    return took_s


async def check_loss(rig: Rig, system: System) -> None:
    """The drive ends, and is restarted."""
    path = AXIS.format(1, "ActualPosition")
    before = await system.value(path)
    rig.drive.terminate()
    rig.drive.wait(10)
    name = "UncertainNoCommunicationLastUsableValue"
    await wait_for(
        "a value of the past is marked", path, system, lambda it: it.StatusCode.name == name
    )
    check("it is the last one", abs((await system.read(path)).Value.Value - before) < 1e-3)
    machine = await system.at(MACHINE)
    try:
        await machine.call_method(
            f"{system.types.robotics}:Stop", ua.Variant(0, ua.VariantType.Int64)
        )
    except ua.UaStatusCodeError as error:
        check(
            "a stop without a drive returns BadNoCommunication",
            error.code == ua.StatusCodes.BadNoCommunication,
            error,
        )
    else:
        check("a stop without a drive fails", False)
    rig.start_drive()
    rig.wait_until_ready()
    await wait_for("it is good again", path, system, lambda it: it.StatusCode.is_good())
    await wait_for("the robot is ready again", STATE, system, given("Ready"))


async def check_all(program: Path, folder: Path) -> None:
    with Rig(program, folder) as rig:
        async with served(rig, "--allow-commands") as (system, bridge, port):
            ports = listening(bridge)
            check("it listens at the given address only", ports == {("127.0.0.1", port)}, ports)
            took_s = await check_run(rig, system)
            await check_loss(rig, system)
        async with served(rig) as (system, _, _):
            machine = await system.at(MACHINE)
            names = {
                (await child.read_browse_name()).Name for child in await machine.get_children()
            }
            check("without --allow-commands there is no stop", not names & {"Stop", "Start"}, names)
    print(f"a run is stopped in {took_s:.2f} s")


def main() -> None:
    # Refused connections are expected.
    logging.disable(logging.CRITICAL)
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    with tempfile.TemporaryDirectory() as folder:
        asyncio.run(check_all(Path(sys.argv[1]), Path(folder)))
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()
