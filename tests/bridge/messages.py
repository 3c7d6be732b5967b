"""Requirements on bridge messages from any broker, and the commands of the bridge."""

from __future__ import annotations

import json
import uuid
from collections import defaultdict
from collections.abc import Iterable
from datetime import UTC, datetime, timedelta
from typing import Any

from readers import once_and_in_order

KINDS = ("joints", "state", "run", "io", "sensors", "conditions", "bridge")


def without_repetitions(messages: Iterable[dict[str, Any]]) -> tuple[list[dict[str, Any]], int]:
    """Messages in their order without repetitions, and the number of repetitions: delivery is at
    least once.
    """
    messages = list(messages)
    keys = [
        tuple(message[name] for name in ("robot", "kind", "session", "seq")) for message in messages
    ]
    by_key = dict(zip(keys, messages))
    once, repeated = once_and_in_order(keys)
    return [by_key[key] for key in once], repeated


def check_numbers(messages: Iterable[dict[str, Any]], *, may_lack: Iterable[str] = ()) -> int:
    """Checks that the numbers of each kind and session are complete from 0 and in order.

    For the kinds `may_lack`, numbers only have to increase. Returns the number of repetitions.
    """
    messages, repeated = without_repetitions(messages)
    may_lack = set(may_lack)
    found: dict[tuple[str, str, int], list[int]] = defaultdict(list)
    for message in messages:
        found[message["robot"], message["kind"], message["session"]].append(message["seq"])
    for what, numbers in found.items():
        lacks = what[1] in may_lack
        gaps = [
            (a, b) for a, b in zip([-1, *numbers], numbers) if (b <= a if lacks else b != a + 1)
        ]
        assert not gaps, f"{what}: {len(gaps)} gaps, the first from {gaps[0][0]} to {gaps[0][1]}"
    return repeated


def check_times(samples: list[dict[str, Any]], step_s: float) -> int:
    """Checks that samples are in order by the controller clock; returns the number of missing
    cycles.
    """
    missing = 0
    for a, b in zip(samples, samples[1:]):
        cycles = (b["t_s"] - a["t_s"]) / step_s
        assert cycles > 0.5, f"{b['t_s']} s follows {a['t_s']} s"
        missing += round(cycles) - 1
    return missing


def command(
    robot: str, type: str, *, age_s: float = 0.0, identity: str | None = None, **request: Any
) -> dict[str, Any]:
    """A command for the bridge."""
    at = datetime.now(UTC) - timedelta(seconds=age_s)
    return {
        "version": 1,
        "robot": robot,
        "id": identity or uuid.uuid4().hex,
        "at": at.isoformat(timespec="microseconds").replace("+00:00", "Z"),
        "request": {"type": type, **request},
    }


# Commands that would move the robot, each of which has to be refused.
def refused_commands(robot: str, program: dict[str, Any]) -> dict[str, bytes]:
    """Bodies of invalid commands, by their error."""

    def changed(**change: Any) -> bytes:
        whole = {**command(robot, "run_motions", motions=program["motions"]), **change}
        return json.dumps(
            {key: value for key, value in whole.items() if value is not None}
        ).encode()

    whole = changed()
    return {
        "empty": b"",
        "no JSON": b"\x00\xff\xfe run",
        "cut off": whole[: len(whole) // 2],
        "followed by more": whole + b"{}",
        "an array": b"[" + whole + b"]",
        "deeply nested": b"[" * 100_000,
        "another version": changed(version=2),
        "no version": changed(version=None),
        "another robot": changed(robot="nobody"),
        "a robot with a long name": changed(robot="x" * 700_000),
        "no id": changed(id=None),
        "an empty id": changed(id=""),
        "a long id": changed(id="x" * 1000),
        "an id that is a number": changed(id=7),
        "no time": changed(at=None),
        "a time without a zone": changed(at=datetime.now(UTC).isoformat()[:19]),
        "too old": json.dumps(
            command(robot, "run_motions", age_s=60, motions=program["motions"])
        ).encode(),
        "from the future": json.dumps(
            command(robot, "run_motions", age_s=-60, motions=program["motions"])
        ).encode(),
        "no request": changed(request=None),
        "an unknown request": changed(request={"type": "fly"}),
        "an unknown key": changed(hurry=True),
        "an id in its request": changed(
            request={"type": "run_motions", "id": 1, "motions": program["motions"]}
        ),
        "a motion out of reach": changed(
            request={
                "type": "run_motions",
                "motions": [{"type": "ptp", "joints_deg": [0, 0, 0, 500, 0, 0, 0]}],
            }
        ),
        "motions planned for another robot": changed(
            request={
                "type": "run_motions",
                "motions": program["motions"],
                "label": {
                    "planned_for": {
                        "model": "lbr_iiwa_7_r800",
                        "lengths_mm": {
                            "base": 340,
                            "upper_arm": 400,
                            "forearm": 400,
                            "flange": 126,
                        },
                    }
                },
            }
        ),
        "a motion that is not finite": whole.replace(b"0.4", b"1e999"),
    }
