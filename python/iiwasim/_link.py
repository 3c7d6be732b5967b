"""Connection to a drive over ZeroMQ: address, keys, handshake and connection loss."""

from __future__ import annotations

import ipaddress
import math
import os
import re
import stat
import time
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from ._replies import DriveTimeout

try:
    import zmq
    import zmq.auth
    from zmq.utils.monitor import recv_monitor_message
except ImportError as error:
    raise ImportError(
        "the client of the drive needs pyzmq: pip install 'iiwasim[drive]'"
    ) from error

if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Self

# A drive that shuts down closes connections, too: only repeated closing is a refusal.
MAX_CLOSED_HANDSHAKES = 3
# On Windows, Ctrl-C takes effect only at the end of a poll.
POLL_S = 0.1


class ConnectionLost(DriveTimeout):
    """The drive has closed the connection."""


class Line:
    """A connection to a drive after a successful handshake."""

    def __init__(
        self, at: str, keys: Keys | None, timeout_s: float, topics: tuple[bytes, ...] = ()
    ) -> None:
        """Connects for requests, or for stream topics if `topics` are given."""
        self.is_lost = False
        self._at = at
        self._is_stream = bool(topics)
        self._socket: zmq.Socket[bytes] = zmq.Context.instance().socket(
            zmq.SUB if topics else zmq.REQ
        )
        self._events: zmq.Socket[bytes] = self._socket.get_monitor_socket(zmq.EVENT_ALL)
        try:
            self._socket.setsockopt(zmq.LINGER, 0)
            self._socket.setsockopt(zmq.IPV6, 1)
            if keys is not None:
                self._socket.setsockopt(zmq.CURVE_PUBLICKEY, keys.public)
                self._socket.setsockopt(zmq.CURVE_SECRETKEY, keys.secret)
                self._socket.setsockopt(zmq.CURVE_SERVERKEY, keys.server)
            self._socket.connect(at)
            self._shake_hands(keys, timeout_s)
            # In this order: a message of the last topic shows that the drive knows all of them.
            for topic in topics:
                self._socket.setsockopt(zmq.SUBSCRIBE, topic)
        except BaseException:
            self.close()
            raise

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        self._socket.disable_monitor()
        self._events.close(linger=0)
        self._socket.close(linger=0)

    def _shake_hands(self, keys: Keys | None, timeout_s: float) -> None:
        until = time.monotonic() + timeout_s
        closed = 0
        while time.monotonic() < until and closed <= MAX_CLOSED_HANDSHAKES:
            event = self._next_event(min(POLL_S, timeout_s))
            if event == zmq.EVENT_HANDSHAKE_SUCCEEDED:
                return
            if event in (zmq.EVENT_HANDSHAKE_FAILED_AUTH, zmq.EVENT_HANDSHAKE_FAILED_PROTOCOL):
                raise self._refusal(event, keys)
            closed += event == zmq.EVENT_DISCONNECTED
        if closed:
            raise self._refusal(zmq.EVENT_DISCONNECTED, keys)
        raise DriveTimeout(
            "timeout", f"no drive answers at {self._at}; is `iiwasim drive` running there?"
        )

    def _refusal(self, event: int, keys: Keys | None) -> DriveTimeout:
        if event == zmq.EVENT_HANDSHAKE_FAILED_AUTH:
            why = (
                "`key` is not on its list; put the .pub file of the same name into the folder of "
                "its --allow"
            )
        elif event == zmq.EVENT_HANDSHAKE_FAILED_PROTOCOL and keys is None:
            why = "it requires keys, or is not a drive: give `key` and `server_key`"
        elif event == zmq.EVENT_HANDSHAKE_FAILED_PROTOCOL:
            why = (
                "it has no keys, or is not a drive: leave out `key` and `server_key`, or start it "
                "with --key and --allow"
            )
        else:
            why = "it closed the connection; do the keys fit, and is `server_key` its .pub file?"
            return ConnectionLost(
                "unauthorized", f"the drive at {self._at} refused the connection: {why}"
            )
        return DriveTimeout(
            "unauthorized", f"the drive at {self._at} refused the connection: {why}"
        )

    def _next_event(self, wait_s: float) -> int | None:
        """The next event of the connection; `None` without an event within `wait_s`."""
        return (
            recv_monitor_message(self._events)["event"] if self._events.poll(_ms(wait_s)) else None
        )

    def send(self, request: bytes) -> None:
        try:
            self._socket.send(request, zmq.NOBLOCK)
        except zmq.Again:
            raise self._loss() from None

    def poll(self, wait_s: float, give_up: Callable[[], bool] = lambda: False) -> bool:
        """Waits up to `wait_s` for a message; returns true if there is a message to receive."""
        until = time.monotonic() + wait_s
        while True:
            left_s = max(until - time.monotonic(), 0.0)
            if self._socket.poll(_ms(min(left_s, POLL_S))):
                return True
            self._check()
            if left_s <= 0.0 or give_up():
                return False

    def _check(self) -> None:
        """Raises `ConnectionLost` if the connection, and with it the reply, is lost.

        Streams reconnect.
        """
        while (event := self._next_event(0.0)) is not None:
            if self._is_stream:
                continue
            # The reply may just have arrived.
            if event == zmq.EVENT_DISCONNECTED and not self._socket.poll(0):
                raise self._loss()

    def _loss(self) -> ConnectionLost:
        self.is_lost = True
        lost = f"the connection to the drive at {self._at} was lost before its reply"
        return ConnectionLost(
            "timeout", f"{lost}; a motion that had begun continues, and `last_run` has its result"
        )

    def receive(self) -> list[bytes]:
        return self._socket.recv_multipart(zmq.NOBLOCK)


class Keys(NamedTuple):
    """The key pair of the client, and the public key of the drive."""

    public: bytes
    secret: bytes
    server: bytes

    @classmethod
    def read(
        cls, key: str | os.PathLike[str] | None, server_key: str | os.PathLike[str] | None
    ) -> Keys | None:
        if key is None and server_key is None:
            return None
        if key is None or server_key is None:
            missing = (
                "server_key, the drive's .pub file"
                if server_key is None
                else "key, your own .key file"
            )
            raise ValueError(f"keys come in twos: give {missing}, too")
        if not zmq.has("curve"):
            raise ValueError(
                "this pyzmq has no CURVE keys; install the one of PyPI: pip install pyzmq"
            )
        public, secret = _certificate(key)
        if secret is None:
            raise ValueError(f"{key} has a public key only; `key` is your own .key file")
        if os.name == "posix" and (mode := stat.S_IMODE(Path(key).stat().st_mode)) & 0o077:
            raise ValueError(
                f"{key} has a secret key, and others may access it (mode {mode:04o}): `chmod 600` "
                "it"
            )
        server, foreign = _certificate(server_key)
        if foreign is not None:
            raise ValueError(
                f"{server_key} has a secret key, which its owner alone should have; give the .pub "
                "file"
            )
        return cls(public, secret, server)


def _certificate(path: str | os.PathLike[str]) -> tuple[bytes, bytes | None]:
    try:
        return zmq.auth.load_certificate(path)
    except OSError as error:
        raise ValueError(f"cannot read {path}: {error.strerror or error}") from error
    except (ValueError, UnicodeError) as error:
        raise ValueError(f"{path} is not a key file; `iiwasim keygen` makes them") from error


def endpoint(text: str, keys: Keys | None) -> tuple[str, int]:
    """Host and port of `HOST:PORT`, which may begin with `tcp://`.

    Without keys, only addresses of this machine are accepted.
    """
    wrong = f"{text!r} is not an address: give HOST:PORT, as 127.0.0.1:5560 or [::1]:5560"
    if not isinstance(text, str):
        raise TypeError(f"{wrong}, as a str")
    parts = re.fullmatch(r"(?:tcp://)?(\[[0-9a-fA-F:.]+\]|[\w.-]+):(\d{1,5})", text, re.ASCII)
    if parts is None or not 1 <= int(parts[2]) <= 65535:
        raise ValueError(wrong)
    host = "127.0.0.1" if parts[1].lower() == "localhost" else parts[1]
    try:
        is_here = ipaddress.ip_address(host.strip("[]")).is_loopback
    except ValueError:
        is_here = False
    if keys is None and not is_here:
        raise ValueError(
            f"{text} may be another machine, so keys are required: make them with `iiwasim keygen "
            "NAME`, and give "
            "key='NAME.key' and server_key='drive.pub'"
        )
    return host, int(parts[2])


def _ms(seconds: float) -> int:
    return math.ceil(1e3 * seconds)
