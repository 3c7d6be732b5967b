"""Unused ports, each given out once, from the same blocks as in `tests/src/ports.rs`."""

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

# UDP sockets at the beginning of blocks: their owner has the other ports of the block until it
# ends.
guards: list[socket.socket] = []


def outgoing() -> tuple[int, int]:
    """The first and the last port of the system for outgoing connections."""
    try:
        first, last = Path("/proc/sys/net/ipv4/ip_local_port_range").read_text().split()
    except OSError:
        return 49_152, 65_535
    return int(first), int(last)


def is_free(port: int) -> bool:
    """True if the port is unused, also by programs that do not use blocks."""
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
    # Blocks in the range of outgoing connections are last, as a connection could take a port before
    # its use.
    blocks.sort(key=lambda begin: begin + BLOCK > first and begin <= last)
    for begin in blocks:
        guard = socket.socket(type=socket.SOCK_DGRAM)
        with suppress(OSError):
            guard.bind(("127.0.0.1", begin))
            guards.append(guard)
            yield from filter(is_free, range(begin + 1, begin + BLOCK))


taken = take_ports()


def free_ports(count: int) -> list[int]:
    """Ports that are unused by both TCP and UDP."""
    return [next(taken) for _ in range(count)]
