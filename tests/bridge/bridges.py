"""`iiwasim bridge` as a process."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from typing import Any

import jsonschema

from processes import PATIENCE_S, Program
from robots import Robot


class Bridge(Program):
    """A bridge from a robot to the brokers in its options."""

    lasts = True

    def __init__(self, binary: Path, robot: Robot, log: Path, *options: str) -> None:
        super().__init__(
            [str(binary), "bridge", *robot.drive_at, *robot.stream_at, *options],
            log,
            folder=log.parent,
        )

    def memory_kb(self) -> int:
        """Resident memory."""
        for line in Path(f"/proc/{self.pid}/status").read_text().splitlines():
            if line.startswith("VmRSS:"):
                return int(line.split()[1])
        raise AssertionError("it has ended")

    def threads_and_files(self) -> tuple[int, int]:
        """Numbers of threads and open files, which lost connections must not increase."""
        own = Path(f"/proc/{self.pid}")
        return len(list((own / "task").iterdir())), len(list((own / "fd").iterdir()))


class Schema:
    """`iiwasim schema bridge`, against which messages are checked."""

    def __init__(self, binary: Path) -> None:
        command = [binary, "schema", "bridge"]
        done = subprocess.run(
            command, check=True, capture_output=True, text=True, timeout=PATIENCE_S
        )
        self.schema = json.loads(done.stdout)
        kind = jsonschema.validators.validator_for(self.schema)
        kind.check_schema(self.schema)
        self.validator = kind(self.schema)

    def check(self, message: dict[str, Any]) -> dict[str, Any]:
        """Checks a message against the schema, and returns it."""
        error = jsonschema.exceptions.best_match(self.validator.iter_errors(message))
        assert error is None, f"{error.message} at {error.json_path} in {message}"
        return message
