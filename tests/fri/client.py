#!/usr/bin/env python3
"""An FRI client without code of the project: protobuf's codec and a UDP socket.

    client.py --bind 127.0.0.1:PORT [--command] [--seconds N]

Answers the controller's messages, and prints a JSON line for every session state when it begins,
with the quality. With --command, its set-points in the commanding states are the controller's own
interpolation with a small sine on joint 1, which starts gently when commanding is active. Ends
after N seconds, or on an interrupt, with a JSON line of figures and exit code 0. Needs the packages
in requirements.txt, one folder up.
"""

from __future__ import annotations

import argparse
import json
import math
import signal
import socket
import time
from typing import Any

from google.protobuf.message import DecodeError

from schema import COMMAND, FRI, decode

AMPLITUDE_RAD = 0.02
FREQUENCY_HZ = 0.25
START_S = 2.0
COMMANDING = (FRI.COMMANDING_WAIT, FRI.COMMANDING_ACTIVE)
OPENING = (FRI.IDLE, FRI.MONITORING_WAIT)


def offset_rad(t_s: float) -> float:
    """A sine whose amplitude grows from 0, with a slope of 0, over the first two seconds."""
    share = min(t_s / START_S, 1.0)
    growth = share * share * (3.0 - 2.0 * share)
    return AMPLITUDE_RAD * growth * math.sin(2.0 * math.pi * FREQUENCY_HZ * t_s)


class Client:
    """The session, without the socket."""

    def __init__(self, command: bool) -> None:
        self.command = command
        self.sequence = 0
        self.latest: int | None = None
        self.unanswered = 0
        self.active_s = 0.0
        self.setpoint: list[float] | None = None
        self.states: list[str] = []
        self.messages = self.answers = self.ignored = self.invalid = 0
        self.largest_difference_rad = 0.0

    def take(self, datagram: bytes) -> bytes | None:
        """Processes a datagram; returns the answer, if any."""
        try:
            kind, message = decode(datagram)
        except DecodeError:
            kind, message = "", None
        if kind != "monitoring":
            self.invalid += 1
            return None
        state = message.connectionInfo.sessionState
        ahead = self.ahead(message.header.sequenceCounter)
        if ahead <= 0 and ahead > -1000 and state not in OPENING:
            self.ignored += 1
            return None
        self.latest = message.header.sequenceCounter
        self.messages += 1
        self.tell(message)
        self.compare(message)
        if state == FRI.IDLE:
            return None
        self.unanswered += 1
        if self.unanswered < max(message.connectionInfo.receiveMultiplier, 1):
            return None
        self.unanswered = 0
        return self.answer(message)

    def ahead(self, counter: int) -> int:
        """Difference of a 32-bit counter to the latest one; negative for an older one."""
        if self.latest is None:
            return 1
        return (counter - self.latest + 2**31) % 2**32 - 2**31

    def tell(self, message: Any) -> None:
        connection = message.connectionInfo
        state = FRI.SessionState.Name(connection.sessionState).lower()
        if not self.states or self.states[-1] != state:
            self.states.append(state)
            quality = FRI.Quality.Name(connection.quality).lower()
            line = {"session": state, "quality": quality, "message": self.messages}
            print(json.dumps(line), flush=True)

    def compare(self, message: Any) -> None:
        """Compares the last set-point with the position of the robot."""
        if message.connectionInfo.sessionState != FRI.COMMANDING_ACTIVE:
            self.setpoint = None
            self.active_s = 0.0
            return
        self.active_s += message.connectionInfo.sendPeriod * 1e-3
        if self.setpoint is None:
            return
        measured = message.monitorData.measuredJointPosition.value
        difference = max(abs(a - b) for a, b in zip(self.setpoint, measured, strict=True))
        self.largest_difference_rad = max(self.largest_difference_rad, difference)

    def answer(self, message: Any) -> bytes:
        state = message.connectionInfo.sessionState
        commanding = state in COMMANDING
        if commanding:
            joints = list(message.ipoData.jointPosition.value)
        else:
            joints = list(message.monitorData.commandedJointPosition.value)
        if self.command and state == FRI.COMMANDING_ACTIVE:
            joints[0] += offset_rad(self.active_s)
            self.setpoint = joints
        reply = FRI.FRICommandMessage()
        reply.header.messageIdentifier = COMMAND
        reply.header.sequenceCounter = self.sequence
        reply.header.reflectedSequenceCounter = message.header.sequenceCounter
        reply.commandData.jointPosition.value.extend(joints)
        self.sequence = (self.sequence + 1) % 2**32
        self.answers += 1
        return reply.SerializeToString()

    def figures(self) -> dict[str, Any]:
        return {
            "messages": self.messages,
            "answers": self.answers,
            "ignored": self.ignored,
            "invalid": self.invalid,
            "states": self.states,
            "largest_difference_rad": self.largest_difference_rad,
        }


def address(text: str) -> tuple[str, int]:
    host, port = text.rsplit(":", 1)
    return host, int(port)


def main() -> None:
    parser = argparse.ArgumentParser(description="an FRI client")
    parser.add_argument("--bind", type=address, required=True, metavar="HOST:PORT")
    parser.add_argument("--command", action="store_true", help="move joint 1 a little")
    parser.add_argument("--seconds", type=float, default=math.inf, help="how long to run for")
    arguments = parser.parse_args()
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    client = Client(arguments.command)
    end = time.monotonic() + arguments.seconds
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as udp:
        udp.bind(arguments.bind)
        udp.settimeout(0.1)
        # With port 0, this line reports the chosen port.
        print(json.dumps({"bound": "{}:{}".format(*udp.getsockname())}), flush=True)
        try:
            while time.monotonic() < end:
                try:
                    datagram, source = udp.recvfrom(65536)
                except TimeoutError:
                    continue
                if (answer := client.take(datagram)) is not None:
                    udp.sendto(answer, source)
        except KeyboardInterrupt:
            pass
    print(json.dumps(client.figures()))


if __name__ == "__main__":
    main()
