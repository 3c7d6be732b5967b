#!/usr/bin/env python3
"""An OPC UA client without code of the project.

    check.py certificates FOLDER
    check.py secured URL FOLDER EXPECTED
    check.py open URL EXPECTED

The first command generates client certificates: a trusted one, an unknown one, and a trusted one
that has expired. The other commands connect, find the robots by their types, check all objects
against the types of OPC 40010-1, and compare them with the JSON file EXPECTED: limits, units, the
motion, states. `secured` needs certificates and passwords, and checks that other clients are
refused; `open` is for a server without authentication. The last line has figures in JSON. Exit code
1 when a check fails. Needs the packages in requirements.txt, one folder up.
"""

from __future__ import annotations

import asyncio
import datetime
import json
import logging
import math
import statistics
import sys
import time
from collections.abc import Awaitable, Callable
from functools import partial
from pathlib import Path
from typing import Any

from asyncua import Client, Node, ua
from asyncua.crypto import security_policies as policies
from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import rsa
from cryptography.x509.oid import ExtendedKeyUsageOID, NameOID

DEVICES = "http://opcfoundation.org/UA/DI/"
ROBOTICS = "http://opcfoundation.org/UA/Robotics/"
APPLICATION = "urn:check.py"
CURRENT = [
    policies.SecurityPolicyBasic256Sha256,
    policies.SecurityPolicyAes128Sha256RsaOaep,
    policies.SecurityPolicyAes256Sha256RsaPss,
]
MODES = [ua.MessageSecurityMode.Sign, ua.MessageSecurityMode.SignAndEncrypt]
# UN/ECE unit codes, as listed by the OPC Foundation.
UNITS = {"ActualPosition": 4405297, "ActualSpeed": 12865, "ActualAcceleration": 12866}
MANDATORY, PLACEHOLDER = ua.NodeId(78), ua.NodeId(11510)

failures: list[str] = []


def check(what: str, holds: bool, found: object = None) -> None:
    if not holds:
        failures.append(what)
        print(f"FAILED: {what}" + ("" if found is None else f" (found {found!r})"))


def near(what: str, found: float, expected: float, tolerance: float) -> None:
    check(f"{what} is {expected}", abs(found - expected) <= tolerance, found)


# ---- certificates


def make_certificates(folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    now = datetime.datetime.now(datetime.UTC)
    day = datetime.timedelta(days=1)
    for name, begin, end in (
        ("trusted", now - day, now + 30 * day),
        ("unknown", now - day, now + 30 * day),
        ("expired", now - 30 * day, now - day),
    ):
        key = rsa.generate_private_key(public_exponent=65537, key_size=2048)
        subject = x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, f"check.py {name}")])
        uses = x509.KeyUsage(True, True, True, True, False, False, False, False, False)
        builder = x509.CertificateBuilder(
            subject, subject, key.public_key(), x509.random_serial_number(), begin, end
        )
        certificate = (
            builder.add_extension(
                x509.SubjectAlternativeName([x509.UniformResourceIdentifier(APPLICATION)]), False
            )
            .add_extension(uses, False)
            .add_extension(x509.ExtendedKeyUsage([ExtendedKeyUsageOID.CLIENT_AUTH]), False)
            .sign(key, hashes.SHA256())
        )
        (folder / f"{name}.der").write_bytes(certificate.public_bytes(serialization.Encoding.DER))
        (folder / f"{name}.pem").write_bytes(
            key.private_bytes(
                serialization.Encoding.PEM,
                serialization.PrivateFormat.PKCS8,
                serialization.NoEncryption(),
            )
        )


# ---- access


class Visitor:
    """A client with its credentials and security options."""

    def __init__(self, url: str, folder: Path) -> None:
        self.url, self.folder = url, folder

    async def client(
        self,
        policy: Any = policies.SecurityPolicyBasic256Sha256,
        mode: ua.MessageSecurityMode = ua.MessageSecurityMode.SignAndEncrypt,
        user: str | None = "anna",
        password: str | None = "secret-1",
        certificate: str = "trusted",
    ) -> Client:
        client = Client(self.url, timeout=8)
        client.application_uri = APPLICATION
        if policy is not None:
            der, key = (str(self.folder / f"{certificate}.{end}") for end in ("der", "pem"))
            await client.set_security(policy, der, key, mode=mode)
        if user is not None:
            client.set_user(user)
            client.set_password(password)
        return client

    async def refused(self, what: str, **how: Any) -> None:
        """Checks that a connection with these options is refused."""
        try:
            async with await self.client(**how) as client:
                await client.nodes.server_state.read_value()
        except (TimeoutError, ua.UaError, ConnectionError, OSError) as error:
            print(f"{what}: refused: {type(error).__name__}")
        else:
            check(f"{what}: refused", False)


async def check_endpoints(url: str, with_none: bool) -> None:
    endpoints = await Client(url).connect_and_get_server_endpoints()
    found = {(end.SecurityPolicyUri.rpartition("#")[2], end.SecurityMode.name) for end in endpoints}
    expected = {(policy.URI.rpartition("#")[2], mode.name) for policy in CURRENT for mode in MODES}
    if with_none:
        expected.add(("None", "None_"))
    check("endpoints", found == expected, found)
    for end in endpoints:
        tokens = {token.TokenType for token in end.UserIdentityTokens}
        plain = end.SecurityMode == ua.MessageSecurityMode.None_
        expected_tokens = {ua.UserTokenType.Anonymous if plain else ua.UserTokenType.UserName}
        check(f"{end.SecurityPolicyUri}: users", with_none or tokens == expected_tokens, tokens)


async def check_security(visitor: Visitor) -> None:
    await check_endpoints(visitor.url, False)
    for policy in CURRENT:
        for mode in MODES:
            async with await visitor.client(policy, mode) as client:
                state = await client.nodes.server_state.read_value()
                check(f"{policy.URI} {mode.name}: a session", state == 0, state)
    await visitor.refused("a wrong password", password="secret-2")
    await visitor.refused("an empty password", password="")
    await visitor.refused("an unknown user", user="ben")
    await visitor.refused("a user without a name", user=None)
    await visitor.refused("an unknown certificate", certificate="unknown")
    await visitor.refused("an expired certificate", certificate="expired")
    await visitor.refused("no security", policy=None, user=None)
    await visitor.refused("no security, but a password", policy=None)
    await visitor.refused("Basic128Rsa15", policy=policies.SecurityPolicyBasic128Rsa15)
    await visitor.refused("Basic256", policy=policies.SecurityPolicyBasic256)


# ---- types


def name_of(ref: ua.ReferenceDescription) -> tuple[int, str]:
    return ref.BrowseName.NamespaceIndex, ref.BrowseName.Name


class Types:
    """Checks instances against their types."""

    def __init__(self, client: Client, namespaces: list[str]) -> None:
        self.client = client
        self.devices, self.robotics = namespaces.index(DEVICES), namespaces.index(ROBOTICS)
        # Cache of answers, which do not change.
        self.answers: dict[tuple[str, ua.NodeId], Any] = {}
        self.checked: set[tuple[ua.NodeId, ua.NodeId]] = set()

    async def known(self, what: str, node: Node, ask: Callable[[], Awaitable[Any]]) -> Any:
        key = (what, node.nodeid)
        if key not in self.answers:
            self.answers[key] = await ask()
        return self.answers[key]

    async def below(self, node: Node) -> list[ua.ReferenceDescription]:
        kinds, forward = ua.ObjectIds.HierarchicalReferences, ua.BrowseDirection.Forward
        return await self.known("below", node, lambda: node.get_references(kinds, forward))

    async def bases(self, type_id: ua.NodeId) -> list[ua.NodeId]:
        """The type and its supertypes."""
        found = [type_id]
        inverse = ua.BrowseDirection.Inverse
        while True:
            node = self.client.get_node(found[-1])
            base = await self.known(
                "base", node, partial(node.get_referenced_nodes, ua.ObjectIds.HasSubtype, inverse)
            )
            if not base:
                return found
            found.append(base[0].nodeid)

    async def rule(self, node: Node) -> ua.NodeId | None:
        rules = await self.known(
            "rule", node, lambda: node.get_referenced_nodes(ua.ObjectIds.HasModellingRule)
        )
        return rules[0].nodeid if rules else None

    async def check(self, path: str, instance: Node, declared: Node) -> None:
        """Checks that an instance has the members of its declaration and of the declared type."""
        if (instance.nodeid, declared.nodeid) in self.checked:
            return
        self.checked.add((instance.nodeid, declared.nodeid))
        own = {name_of(ref): ref for ref in await self.below(instance)}
        type_id = await self.known("type", instance, instance.read_type_definition)
        for model in [declared.nodeid, *await self.bases(type_id)]:
            for ref in await self.below(self.client.get_node(model)):
                await self.check_member(path, own, ref)
        for ref in own.values():
            # Members with names of this project have their own types: a robot, an axis, ...
            if ref.BrowseName.NamespaceIndex == instance.nodeid.NamespaceIndex:
                node = self.client.get_node(ref.NodeId)
                await self.check(
                    f"{path}/{ref.BrowseName.Name}", node, self.client.get_node(ref.TypeDefinition)
                )

    async def check_member(self, path: str, own: dict, ref: ua.ReferenceDescription) -> None:
        """Checks one member of a type in an instance."""
        member = self.client.get_node(ref.NodeId)
        rule = await self.rule(member)
        path = f"{path}/{ref.BrowseName.Name}"
        if rule == MANDATORY:
            check(f"{path}: it exists", name_of(ref) in own)
        elif rule == PLACEHOLDER and ref.TypeDefinition.NamespaceIndex == self.robotics:
            check(
                f"{path}: there is one",
                any(it.TypeDefinition == ref.TypeDefinition for it in own.values()),
            )
        if name_of(ref) not in own or rule is None:
            return
        mine = own[name_of(ref)]
        check(f"{path}: node class", mine.NodeClass == ref.NodeClass, mine.NodeClass)
        if mine.NodeClass == ua.NodeClass.Method:
            return
        kinds = await self.bases(mine.TypeDefinition)
        check(f"{path}: type", ref.TypeDefinition in kinds, mine.TypeDefinition)
        node = self.client.get_node(mine.NodeId)
        if mine.NodeClass == ua.NodeClass.Variable:
            found = await self.known("data type", node, node.read_data_type)
            declared = await self.known("data type", member, member.read_data_type)
            check(f"{path}: data type", declared in await self.bases(found), found)
        await self.check(path, node, member)


# ---- values


class System:
    """A robot in the address space."""

    def __init__(self, root: Node, types: Types) -> None:
        self.root, self.types = root, types

    async def at(self, path: str) -> Node:
        """The node at a path of browse names; a letter before a name selects a namespace other than
        Robotics.
        """
        spaces = {"D": self.types.devices, "B": 0, "I": self.root.nodeid.NamespaceIndex}
        names = []
        for part in path.split("/"):
            space, colon, name = part.rpartition(":")
            names.append(f"{spaces[space] if colon else self.types.robotics}:{name}")
        return await self.root.get_child(names)

    async def read(self, path: str) -> ua.DataValue:
        return await (await self.at(path)).read_data_value(raise_on_bad_status=False)

    async def value(self, path: str) -> Any:
        found = await self.read(path)
        check(f"{path}: good", found.StatusCode.is_good(), found.StatusCode)
        return found.Value.Value if found.Value else None


AXIS = "MotionDevices/I:Arm/Axes/I:A{}/D:ParameterSet/{}"
TASK = "Controllers/I:Controller/TaskControls/I:Task"
MACHINE = f"{TASK}/TaskControlOperation/TaskControlStateMachine"


def motion(expected: dict, joint: int, at: datetime.datetime) -> tuple[float, float, float]:
    """Position, speed and acceleration of a swinging joint."""
    amplitude, w = expected["amplitude_rad"], expected["rad_per_s"]
    seconds = at.replace(tzinfo=datetime.UTC).timestamp() - expected["since"]
    phase = w * seconds + joint
    return (
        amplitude * math.sin(phase),
        amplitude * w * math.cos(phase),
        -amplitude * w * w * math.sin(phase),
    )


async def check_axes(system: System, expected: dict) -> None:
    for joint in range(7):
        for i, (name, unit) in enumerate(UNITS.items()):
            path = AXIS.format(joint + 1, name)
            found = await system.read(path)
            check(f"{path}: good", found.StatusCode.is_good(), found.StatusCode)
            what = motion(expected, joint, found.SourceTimestamp)[i]
            # Stamps are in microseconds. With a non-zero jerk, the fitted parabola is late by half
            # a window of 60 ms.
            jerk = expected["amplitude_rad"] * expected["rad_per_s"] ** 3
            tolerance = (2e-6, jerk * 0.03**2, jerk * 0.06)[i]
            near(f"{expected['name']}: {path}", found.Value.Value, what, tolerance)
            units = await system.value(f"{path}/B:EngineeringUnits")
            check(f"{path}: unit", units.UnitId == unit, units)
            low, high = expected["ranges"][i][joint]
            found = await system.value(f"{path}/B:EURange")
            check(f"{path}: range", (found.Low, found.High) == (low, high), found)
        profile = await system.value(f"MotionDevices/I:Arm/Axes/I:A{joint + 1}/MotionProfile")
        check("axes turn", profile == 1, profile)


async def check_states(system: System, expected: dict) -> None:
    for path, value in expected["values"].items():
        found = await system.read(path)
        given = found.Value.Value if found.Value else None
        if isinstance(given, ua.LocalizedText):
            given = given.Text
        check(f"{expected['name']}: {path} is {value!r}", given == value, given)
    for path, status in expected["statuses"].items():
        found = await system.read(path)
        check(
            f"{expected['name']}: {path} is {status}",
            found.StatusCode.name == status,
            found.StatusCode.name,
        )
    load = await system.value("MotionDevices/I:Arm/FlangeLoad/CenterOfMass")
    where = load.CartesianCoordinates
    found = [where.X, where.Y, where.Z]
    check("centre of mass", found == expected["center_m"], found)
    state = await system.value(f"{MACHINE}/B:CurrentState/B:Id")
    name = (await system.types.client.get_node(state).read_browse_name()).Name
    check(
        "the state is one of the type",
        name == expected["values"][f"{MACHINE}/B:CurrentState"],
        name,
    )


class Listener:
    """Notifications of a subscription, with their delays."""

    def __init__(self) -> None:
        self.late_ms: list[float] = []
        self.per_node: dict[Node, int] = {}

    def datachange_notification(self, node: Node, _: Any, data: Any) -> None:
        at = data.monitored_item.Value.SourceTimestamp.replace(tzinfo=datetime.UTC)
        self.per_node[node] = self.per_node.get(node, 0) + 1
        if self.per_node[node] > 1:
            self.late_ms.append((time.time() - at.timestamp()) * 1e3)


async def check_subscription(client: Client, system: System, seconds: float) -> dict:
    listener = Listener()
    subscription = await client.create_subscription(50, listener)
    nodes = [await system.at(AXIS.format(joint + 1, name)) for joint in range(7) for name in UNITS]
    await subscription.subscribe_data_change(nodes, sampling_interval=50)
    await asyncio.sleep(seconds)
    await subscription.delete()
    rate = min(listener.per_node.get(node, 0) for node in nodes) / seconds
    late = sorted(listener.late_ms)
    figures = {
        "updates_hz": round(rate, 1),
        "median_ms": round(statistics.median(late), 1),
        "p99_ms": round(late[int(0.99 * len(late))], 1),
        "max_ms": round(late[-1], 1),
    }
    # Half of the nominal rate, as machines are shared.
    check("subscriptions bring 10 values a second", rate >= 10, rate)
    check("values are there within 0.2 s, in the middle", figures["median_ms"] <= 200, figures)
    return figures


# ---- forbidden operations


async def refused(what: str, asked: Callable[[], Awaitable[Any]]) -> None:
    try:
        await asked()
    except ua.UaError as error:
        print(f"{what}: refused: {type(error).__name__}")
    else:
        check(f"{what}: refused", False)


async def check_only_read(client: Client, system: System) -> None:
    for path in (
        AXIS.format(1, "ActualPosition"),
        AXIS.format(1, "ActualPosition") + "/B:EURange",
        "MotionDevices/I:Arm/D:ParameterSet/SpeedOverride",
        "Controllers/I:Controller/D:Model",
    ):
        node = await system.at(path)
        value = (await node.read_data_value(raise_on_bad_status=False)).Value
        await refused(f"writing {path}", lambda node=node, value=value: node.write_value(value))
    reason = client.get_node(ua.NodeId(6097, system.types.robotics))
    await refused(
        "writing to a type", lambda: reason.write_value(ua.Variant(1, ua.VariantType.Int16))
    )
    await refused(
        "adding a node",
        lambda: client.nodes.objects.add_folder(system.root.nodeid.NamespaceIndex, "mine"),
    )
    _, statuses = await client.delete_nodes([system.root])
    check("deleting a node: refused", not any(status.is_good() for status in statuses), statuses)
    axis = await system.at(AXIS.format(1, "ActualPosition"))
    before = await axis.read_data_value()
    check("values are still the robot's", isinstance(before.Value.Value, float), before)


async def check_stop(system: System, expected: dict) -> None:
    machine = await system.at(MACHINE)
    space = system.types.robotics
    if expected["stop"] == "absent":
        names = {(await child.read_browse_name()).Name for child in await machine.get_children()}
        check("there is no stop", not names & {"Stop", "Start"}, names)
        return

    def stop(mode: int) -> Awaitable[Any]:
        return machine.call_method(f"{space}:Stop", ua.Variant(mode, ua.VariantType.Int64))

    if expected["stop"] == "refused":
        await refused("a stop by nobody", lambda: stop(0))
        return
    began = time.time()
    status = await stop(0)
    check("a stop", status == 0, status)
    check("it is answered when the arm is at rest", time.time() - began >= expected["stop_takes_s"])
    await refused("a stop in a mode that there is not", lambda: stop(7))
    await refused(
        "a method of a type",
        lambda: machine.call_method(ua.NodeId(7009, space), ua.Variant(0, ua.VariantType.Int64)),
    )


# ---- all checks


async def check_robots(client: Client, robots: list[dict]) -> dict:
    namespaces = await client.get_namespace_array()
    types = Types(client, namespaces)
    # Structures from the definitions of the server.
    await client.load_data_type_definitions()
    device_set = client.get_node(ua.NodeId(5001, types.devices))
    system_type = client.get_node(ua.NodeId(1002, types.robotics))
    systems = {
        ref.BrowseName.Name: System(client.get_node(ref.NodeId), types)
        for ref in await types.below(device_set)
        if ref.TypeDefinition == system_type.nodeid
    }
    check("robots", set(systems) == {robot["name"] for robot in robots}, set(systems))
    began = time.time()
    figures: dict = {}
    for robot in robots:
        system = systems[robot["name"]]
        await types.check(robot["name"], system.root, system_type)
        await check_axes(system, robot)
        await check_states(system, robot)
        await check_only_read(client, system)
        await check_stop(system, robot)
    figures["checked"] = len(types.checked)
    figures["browse_s"] = round(time.time() - began, 2)
    figures["subscription"] = await check_subscription(client, systems[robots[0]["name"]], 3.0)
    return figures


async def run(mode: str, url: str, rest: list[str]) -> None:
    robots = json.loads(Path(rest[-1]).read_text(encoding="utf-8"))["robots"]
    if mode == "secured":
        visitor = Visitor(url, Path(rest[0]))
        await check_security(visitor)
        async with await visitor.client() as client:
            figures = await check_robots(client, robots)
    else:
        await check_endpoints(url, True)
        async with Client(url) as client:
            figures = await check_robots(client, robots)
    print(json.dumps(figures))


def main() -> None:
    # Refused connections are expected.
    logging.disable(logging.CRITICAL)
    match sys.argv[1:]:
        case ["certificates", folder]:
            make_certificates(Path(folder))
        case [("secured" | "open") as mode, url, *rest] if rest:
            asyncio.run(run(mode, url, rest))
        case _:
            sys.exit(__doc__)
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()
