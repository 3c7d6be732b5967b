"""A Sparkplug B host application: reads payloads, and checks their senders against the
specification.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from google.protobuf import descriptor_pb2, descriptor_pool, message_factory

from readers import Received

NAMESPACE = "spBv1.0"

# Fields of message types with their numbers, from sparkplug_b.proto of Sparkplug 3.0.0, without
# templates and data sets.
FIELDS = {
    "Metric": {
        "name": (1, "string"),
        "alias": (2, "uint64"),
        "timestamp": (3, "uint64"),
        "datatype": (4, "uint32"),
        "is_historical": (5, "bool"),
        "is_transient": (6, "bool"),
        "is_null": (7, "bool"),
        "int_value": (10, "uint32"),
        "long_value": (11, "uint64"),
        "float_value": (12, "float"),
        "double_value": (13, "double"),
        "boolean_value": (14, "bool"),
        "string_value": (15, "string"),
        "bytes_value": (16, "bytes"),
    },
    "Payload": {
        "timestamp": (1, "uint64"),
        "metrics": (2, "Metric"),
        "seq": (3, "uint64"),
        "uuid": (4, "string"),
        "body": (5, "bytes"),
    },
}
# Numbers of metric types, and the field with their value.
TYPES = {
    **dict.fromkeys((1, 2, 3, 5, 6, 7), "int_value"),
    **dict.fromkeys((4, 8, 13), "long_value"),
    9: "float_value",
    10: "double_value",
    11: "boolean_value",
    **dict.fromkeys((12, 14, 15), "string_value"),
    **dict.fromkeys((17, 18, *range(22, 35)), "bytes_value"),
}


def compiled(name: str, messages: dict[str, dict[str, tuple[int, str]]] = FIELDS) -> type:
    """The class of a message from a table such as `FIELDS`; `*` marks repeated numbers."""
    pool = descriptor_pool.DescriptorPool()
    file = descriptor_pb2.FileDescriptorProto(
        name="sparkplug.proto", package="sparkplug", syntax="proto2"
    )
    kinds = descriptor_pb2.FieldDescriptorProto
    for message, fields in messages.items():
        described = file.message_type.add(name=message)
        for field_name, (number, kind) in fields.items():
            one = described.field.add(name=field_name, number=number, label=kinds.LABEL_OPTIONAL)
            if kind.endswith("*"):
                one.label, one.type = (
                    kinds.LABEL_REPEATED,
                    getattr(kinds, f"TYPE_{kind[:-1].upper()}"),
                )
                one.options.packed = True
            elif kind in messages:
                one.label, one.type, one.type_name = (
                    kinds.LABEL_REPEATED,
                    kinds.TYPE_MESSAGE,
                    f".sparkplug.{kind}",
                )
            else:
                one.type = getattr(kinds, f"TYPE_{kind.upper()}")
    pool.Add(file)
    return message_factory.GetMessageClass(pool.FindMessageTypeByName(f"sparkplug.{name}"))


Payload = compiled("Payload")


def value_of(metric: Any, datatype: int) -> Any:
    if metric.is_null:
        return None
    held = TYPES[datatype]
    assert metric.HasField(held), f"{metric} has no {held}, which its type {datatype} asks for"
    return getattr(metric, held)


def command(name: str, value: bool) -> bytes:
    """The payload of a command with one metric, such as `Node Control/Rebirth`."""
    payload = Payload(timestamp=1, seq=0)
    payload.metrics.add(name=name, datatype=11, boolean_value=value, timestamp=1)
    return payload.SerializeToString()


@dataclass
class Node:
    """State of an edge node as known by a host."""

    birth_seq: int | None = None
    next_seq: int = 0
    is_online: bool = False
    births: int = 0
    deaths: int = 0
    devices: dict[str, bool] = field(default_factory=dict)
    # Values by device and metric name; the device of node metrics is "".
    values: dict[tuple[str, str], Any] = field(default_factory=dict)
    names: dict[int, tuple[str, str, int]] = field(default_factory=dict)


class Host:
    """Processes messages in their order, and raises AssertionError if they violate the
    specification.
    """

    def __init__(self) -> None:
        self.nodes: dict[str, Node] = {}

    def take(self, message: Received) -> None:
        namespace, group, kind, node_name, *device_name = message.topic.split("/")
        assert namespace == NAMESPACE, message.topic
        assert (not message.retained and message.qos == 0) or kind == "NDEATH", (
            f"{kind} has QoS {message.qos}"
        )
        payload = Payload.FromString(message.payload)
        node = self.nodes.setdefault(f"{group}/{node_name}", Node())
        device = device_name[0] if device_name else ""
        assert bool(device) == kind.startswith("D"), message.topic
        if not node.births and kind != "NBIRTH":
            # A host that connects later requests a birth.
            return
        getattr(self, kind.lower())(node, device, payload)

    def nbirth(self, node: Node, _: str, payload: Any) -> None:
        assert payload.seq == 0, f"an NBIRTH has the number 0, not {payload.seq}"
        node.names.clear()
        self.learn(node, "", payload)
        self.check_sequence(payload)
        node.birth_seq = node.values["", "bdSeq"]
        assert node.values["", "Node Control/Rebirth"] is False
        node.next_seq, node.is_online, node.devices = 1, True, {}
        node.births += 1

    def ndeath(self, node: Node, _: str, payload: Any) -> None:
        (metric,) = payload.metrics
        assert not payload.HasField("seq")
        self.check_sequence(payload)
        # A late death message of an earlier birth does not concern this one.
        if metric.long_value == node.birth_seq:
            node.is_online, node.devices = False, dict.fromkeys(node.devices, False)
            node.deaths += 1

    def check_sequence(self, payload: Any) -> None:
        """Checks `bdSeq`, Int64 from 0 to 255, which relates a death to its birth."""
        (metric,) = (metric for metric in payload.metrics if metric.name == "bdSeq")
        assert metric.datatype == 4, f"bdSeq has the type {metric.datatype}"
        assert 0 <= metric.long_value < 256

    def dbirth(self, node: Node, device: str, payload: Any) -> None:
        self.count(node, payload)
        self.learn(node, device, payload)
        node.devices[device] = True

    def ddeath(self, node: Node, device: str, payload: Any) -> None:
        self.count(node, payload)
        node.devices[device] = False

    def ndata(self, node: Node, _: str, payload: Any) -> None:
        self.count(node, payload)
        self.update(node, "", payload)

    def ddata(self, node: Node, device: str, payload: Any) -> None:
        self.count(node, payload)
        assert node.devices.get(device), f"{device} was not born"
        self.update(node, device, payload)

    def ncmd(self, *_: Any) -> None:
        """Ignores commands, which the host itself sends."""

    dcmd = ncmd

    def count(self, node: Node, payload: Any) -> None:
        assert node.is_online, "there was no NBIRTH"
        assert payload.seq == node.next_seq, f"number {payload.seq} follows {node.next_seq - 1}"
        node.next_seq = (node.next_seq + 1) % 256

    def learn(self, node: Node, device: str, payload: Any) -> None:
        assert payload.HasField("timestamp")
        for metric in payload.metrics:
            assert metric.name and metric.HasField("datatype") and metric.HasField("timestamp"), (
                metric
            )
            if metric.HasField("alias"):
                assert metric.alias not in node.names, f"the alias {metric.alias} is used twice"
                node.names[metric.alias] = (device, metric.name, metric.datatype)
            node.values[device, metric.name] = value_of(metric, metric.datatype)

    def update(self, node: Node, device: str, payload: Any) -> None:
        assert payload.metrics and payload.HasField("timestamp")
        for metric in payload.metrics:
            assert metric.HasField("timestamp"), metric
            if metric.HasField("alias"):
                assert metric.alias in node.names, f"the alias {metric.alias} was in no birth"
                of, name, datatype = node.names[metric.alias]
                assert of == device, f"{name} is of {of}, not of {device}"
            else:
                name, datatype = metric.name, metric.datatype
                assert (device, name) in node.values, f"{name} was in no birth"
            if not metric.is_historical:
                node.values[device, name] = value_of(metric, datatype)
