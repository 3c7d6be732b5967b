"""A broker on this machine, and what happens to brokers."""

from __future__ import annotations

import signal
from pathlib import Path
from typing import Self

from processes import Program, until


class Broker:
    """Keeps its ports and its data from one start to the next. It runs within `with`."""

    label = "a broker"

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        folder.mkdir(parents=True, exist_ok=True)
        self.program: Program | None = None

    def command(self) -> list[str]:
        """What starts it."""
        raise NotImplementedError

    def answers(self) -> bool:
        raise NotImplementedError

    def __enter__(self) -> Self:
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def start(self) -> None:
        """Returns when it answers."""
        assert self.program is None, "it runs"
        program = self.program = Program(self.command(), self.folder / "broker.log")

        def answers() -> bool:
            assert program.runs(), program.said()[-3000:]
            return self.answers()

        until(answers, f"{self.label} answers; see {self.folder}/broker.log")

    def running(self) -> Self:
        """The broker, started where it was stopped."""
        if self.program is None:
            self.start()
        return self

    def stop(self) -> None:
        """As an operator does it: what it has for others is on the disk."""
        if self.program:
            self.program.end()
            self.program = None

    def kill(self) -> None:
        if self.program:
            self.program.kill()
            self.program = None

    def pause(self) -> None:
        """It holds its connections, and answers nothing."""
        assert self.program
        self.program.send(signal.SIGSTOP)

    def resume(self) -> None:
        assert self.program
        self.program.send(signal.SIGCONT)

    def restart(self) -> None:
        self.stop()
        self.start()
