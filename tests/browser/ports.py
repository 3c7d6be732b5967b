"""Ports that nobody else uses, each given once: by the same blocks as `tests/src/ports.rs`."""

from __future__ import annotations

import os
import socket
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

PORTS = range(10_000, 30_000)
BLOCK = 50

# Whoever holds the UDP port at the beginning of a block has the others, until it ends.
guards: list[socket.socket] = []


def outgoing() -> tuple[int, int]:
    """The first and the last port that this system gives to outgoing connections."""
    try:
        first, last = Path("/proc/sys/net/ipv4/ip_local_port_range").read_text().split()
    except OSError:
        return 49_152, 65_535
    return int(first), int(last)


def is_free(port: int) -> bool:
    """Whether no program has it, be it one that knows nothing of blocks."""
    with socket.socket() as tcp, socket.socket(type=socket.SOCK_DGRAM) as udp:
        try:
            tcp.bind(("127.0.0.1", port))
            udp.bind(("127.0.0.1", port))
        except OSError:
            return False
    return True


def take_ports() -> Iterator[int]:
    first, last = outgoing()
    blocks = list(PORTS[::BLOCK])
    at = os.getpid() % len(blocks)
    blocks = blocks[at:] + blocks[:at]
    # An outgoing connection could take a port between its choice and its use: such blocks come last.
    blocks.sort(key=lambda begin: begin + BLOCK > first and begin <= last)
    for begin in blocks:
        guard = socket.socket(type=socket.SOCK_DGRAM)
        with suppress(OSError):
            guard.bind(("127.0.0.1", begin))
            guards.append(guard)
            yield from filter(is_free, range(begin + 1, begin + BLOCK))


taken = take_ports()


def free_ports(count: int) -> list[int]:
    """Ports that nobody has, neither of TCP nor of UDP."""
    return [next(taken) for _ in range(count)]
