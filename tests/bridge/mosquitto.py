"""An MQTT broker on this machine: mosquitto of Debian."""

from __future__ import annotations

import shutil
import socket
import subprocess
from pathlib import Path

from broker import Broker
from certificates import Certificates
from ports import free_ports

USER, PASSWORD = "robot", "let me in"
# Listeners by the credentials of their clients: none, a password, none over TLS, a password over
# TLS, a certificate. Clients have to refuse the certificates of the last two listeners.
LISTENERS = ("plain", "password", "tls", "tls_password", "mutual", "misnamed", "expired")


def program(name: str) -> str:
    """Path of a mosquitto program, which is not on the search path of every user."""
    found = shutil.which(name) or shutil.which(name, path="/usr/sbin:/usr/local/sbin")
    assert found, f"{name} is missing: apt-get install mosquitto"
    return found


class Mosquitto(Broker):
    """A broker with persistence, which keeps messages for disconnected sessions."""

    label = "mosquitto"

    def __init__(
        self,
        folder: Path,
        certificates: Certificates | None = None,
        *,
        persistent: bool = True,
        forbidden: str = "",
    ) -> None:
        """Opens all LISTENERS with certificates, otherwise the listeners without TLS. `forbidden`
        is a topic that clients without credentials may not use.
        """
        super().__init__(folder)
        self.passwords = folder / "passwords"
        # Its warnings about owners and root do not matter.
        command = [program("mosquitto_passwd"), "-b", "-c", str(self.passwords), USER, PASSWORD]
        subprocess.run(command, check=True, capture_output=True, timeout=60)
        self.rules = folder / "rules"
        self.rules.write_text(
            f"topic readwrite #\ntopic deny {forbidden}\n" if forbidden else "topic readwrite #\n"
        )
        names = LISTENERS if certificates else LISTENERS[:2]
        self.ports = dict(zip(names, free_ports(len(names))))
        self.configuration = folder / "mosquitto.conf"
        lines = [
            "per_listener_settings true",
            # Started as root, mosquitto would change to a user who cannot read the test files.
            "user root",
            "log_dest stderr",
            # Disconnected sessions receive all missed messages.
            "max_queued_messages 1000000",
            "retain_available true",
        ]
        if persistent:
            lines += ["persistence true", f"persistence_location {folder}/"]
        for name, port in self.ports.items():
            lines += ["", f"listener {port} 127.0.0.1", *self.listener(name, certificates)]
        self.configuration.write_text("\n".join(lines) + "\n")

    def listener(self, name: str, certificates: Certificates | None) -> list[str]:
        lines = ["allow_anonymous true"]
        if name == "plain":
            lines.append(f"acl_file {self.rules}")
        if "password" in name:
            lines = ["allow_anonymous false", f"password_file {self.passwords}"]
        if certificates and name not in LISTENERS[:2]:
            shown = {"misnamed": certificates.misnamed, "expired": certificates.expired}.get(
                name, certificates.server
            )
            lines += [
                f"cafile {certificates.authority}",
                f"certfile {shown.certificate}",
                f"keyfile {shown.key}",
            ]
        if name == "mutual":
            lines += ["require_certificate true", "use_identity_as_username true"]
        return lines

    def port(self, listener: str = "plain") -> int:
        return self.ports[listener]

    def address(self, listener: str = "plain") -> str:
        """Host and port."""
        return f"localhost:{self.port(listener)}"

    def command(self) -> list[str]:
        return [program("mosquitto"), "-c", str(self.configuration)]

    def answers(self) -> bool:
        try:
            socket.create_connection(("127.0.0.1", self.port()), 1).close()
        except OSError:
            return False
        return True
