"""A broker on this machine, with starts, stops and pauses."""

from __future__ import annotations

import signal
from pathlib import Path
from typing import Self

from processes import Program, until


class Broker:
    """A broker that keeps its ports and data across restarts. It runs within `with`."""

    label = "a broker"

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        folder.mkdir(parents=True, exist_ok=True)
        self.program: Program | None = None

    def command(self) -> list[str]:
        """Command line of the broker."""
        raise NotImplementedError

    def answers(self) -> bool:
        raise NotImplementedError

    def __enter__(self) -> Self:
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def start(self) -> None:
        """Starts the broker, and waits until it answers."""
        assert self.program is None, "it runs"
        program = self.program = Program(self.command(), self.folder / "broker.log")

        def answers() -> bool:
            assert program.runs(), program.said()[-3000:]
            return self.answers()

        until(answers, f"{self.label} answers; see {self.folder}/broker.log")

    def running(self) -> Self:
        """The broker, started if it was stopped."""
        if self.program is None:
            self.start()
        return self

    def stop(self) -> None:
        """Stops the broker regularly: pending messages are on the disk."""
        if self.program:
            self.program.end()
            self.program = None

    def kill(self) -> None:
        if self.program:
            self.program.kill()
            self.program = None

    def pause(self) -> None:
        """Pauses the broker: it keeps its connections, but does not answer."""
        assert self.program
        self.program.send(signal.SIGSTOP)

    def resume(self) -> None:
        assert self.program
        self.program.send(signal.SIGCONT)

    def restart(self) -> None:
        self.stop()
        self.start()
