#!/usr/bin/env python3
"""Decodes FRI datagrams with protobuf's own codec, and encodes them.

    codec.py           reads one datagram per line, in hex, and prints {"monitoring": {...}},
                       {"command": {...}} or {"error": "..."} for each
    codec.py --encode  the opposite direction

Enums are numbers; fields have their names in fri.proto. Needs the packages in requirements.txt, one
folder up.
"""

from __future__ import annotations

import argparse
import json
import sys

from google.protobuf.json_format import MessageToDict, ParseDict
from google.protobuf.message import DecodeError

from schema import KINDS, decode


def to_json(line: str) -> str:
    try:
        kind, message = decode(bytes.fromhex(line))
    except DecodeError as error:
        return json.dumps({"error": str(error)})
    fields = MessageToDict(message, preserving_proto_field_name=True, use_integers_for_enums=True)
    return json.dumps({kind: fields})


def to_hex(line: str) -> str:
    ((kind, fields),) = json.loads(line).items()
    _, message = KINDS[kind]
    return ParseDict(fields, message()).SerializeToString().hex()


def main() -> None:
    parser = argparse.ArgumentParser(description="FRI datagrams as JSON, and back")
    parser.add_argument("--encode", action="store_true", help="JSON in, hex out")
    convert = to_hex if parser.parse_args().encode else to_json
    for line in sys.stdin:
        print(convert(line.strip()))


if __name__ == "__main__":
    main()
