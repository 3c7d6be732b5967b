"""Compiles fri.proto with protoc, and distinguishes the messages."""

from __future__ import annotations

import importlib
import sys
import tempfile
from pathlib import Path
from types import ModuleType

from google.protobuf.message import DecodeError, Message
from grpc_tools import protoc

FOLDER = Path(__file__).parent
MONITORING = 0x245142
COMMAND = 0x34001


def compile_schema() -> ModuleType:
    """The module that protoc generates from fri.proto, in a temporary folder."""
    with tempfile.TemporaryDirectory() as out:
        if protoc.main(["protoc", f"-I{FOLDER}", f"--python_out={out}", "fri.proto"]) != 0:
            sys.exit("protoc refuses fri.proto")
        sys.path.insert(0, out)
        try:
            return importlib.import_module("fri_pb2")
        finally:
            sys.path.remove(out)


FRI = compile_schema()
KINDS = {
    "monitoring": (MONITORING, FRI.FRIMonitoringMessage),
    "command": (COMMAND, FRI.FRICommandMessage),
}


def decode(datagram: bytes) -> tuple[str, Message]:
    """The kind of a datagram, and its message. Raises DecodeError."""
    identifier = FRI.Envelope.FromString(datagram).header.messageIdentifier
    for kind, (expected, message) in KINDS.items():
        if identifier == expected:
            return kind, message.FromString(datagram)
    raise DecodeError(f"no message has the identifier {identifier:#x}")
