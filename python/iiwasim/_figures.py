"""Figures of plans as objects."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Mapping

    import numpy as np
    from numpy.typing import NDArray

    from ._native import Plan, Program, Samples
    from ._options import Search, Shape, Timing


class Limit(NamedTuple):
    """A limit of a joint or of the TCP.

    >>> import iiwasim as iw
    >>> iw.Limit(joint=4, kind="jerk").joint
    4
    """

    joint: int | None
    """The joint, 1 to 7; `None` if the TCP is limited."""
    kind: str
    """`velocity`, `acceleration`, `jerk` or `torque`; with `cart_` or `orientation_` for the TCP;
    `minimum_duration` of short motions; `t1_velocity`."""


class State(NamedTuple):
    """The joint state of the robot at one time.

    >>> import iiwasim as iw
    >>> state = iw.plan(iw.Program([iw.ptp(deg=[30] + [0] * 6)], start_deg=[0] * 7)).at(0.2)
    >>> round(float(state.q[0]), 6), state.motion
    (0.074721, 1)
    """

    t_s: float
    """Time, in s."""
    q: NDArray[np.float64]
    """Positions (7,), in rad."""
    dq: NDArray[np.float64]
    """Velocities (7,), in rad/s."""
    ddq: NDArray[np.float64]
    """Accelerations (7,), in rad/s^2."""
    dddq: NDArray[np.float64]
    """Jerks (7,), in rad/s^3."""
    motion: int
    """The motion of the program, from 1."""


class States(NamedTuple):
    """Joint states at several times, as arrays.

    >>> import iiwasim as iw
    >>> plan = iw.plan(iw.Program([iw.ptp(deg=[30] + [0] * 6)], start_deg=[0] * 7))
    >>> states = plan.at([0.1, 0.2])
    >>> states.q.shape, states.motion.tolist()
    ((2, 7), [1, 1])
    """

    t_s: NDArray[np.float64]
    """Times (n,), in s."""
    q: NDArray[np.float64]
    """Positions (n, 7), in rad."""
    dq: NDArray[np.float64]
    """Velocities (n, 7), in rad/s."""
    ddq: NDArray[np.float64]
    """Accelerations (n, 7), in rad/s^2."""
    dddq: NDArray[np.float64]
    """Jerks (n, 7), in rad/s^3."""
    motion: NDArray[np.uint32]
    """Motions of the program (n,), from 1."""


@dataclass(frozen=True)
class MotionFigures:
    """A motion of a plan, a wait, or an input or output.

    >>> import iiwasim as iw
    >>> plan = iw.plan(iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(1)], start_deg=[0] * 7))
    >>> first, second = plan.motions
    >>> first.type, second.type, round(second.time_s, 3)
    ('ptp', 'wait', 1.0)
    """

    index: int
    """The place in the program, from 1."""
    type: str
    """`ptp`, `lin`, `lin_rel`, `circ`, `spline`, `spl`, `wait`, `set` or `wait_for`."""
    start_s: float
    """Start time, in s."""
    end_s: float
    """End time, in s."""
    peak_velocity_rel: float
    """The peak joint velocity as a share of its limit, over all joints, 0 to 1."""
    limited_by: Limit | None
    """The limit that is active for the longest time or, if none is active, that the motion
    approaches most closely; `None` for a wait."""
    figures: Mapping[str, Any]
    """All figures, as in `Plan.figures()["motions"]`."""
    name: str | None = None
    """The name in the program, if any."""
    comment: str | None = None
    """The comment in the program, if any."""
    group: str | None = None
    """The group in the program, if any."""
    rounds: tuple[tuple[int, int], ...] = ()
    """The rounds in repeat blocks, as (number from 1, number of rounds), the outermost block
    first."""
    io: str | None = None
    """The name of the output that is set, or of the input that the program waits for."""
    value: bool | float | None = None
    """The value that the output gets, or that the input is assumed to have at the end."""

    @property
    def time_s(self) -> float:
        """Duration, in s.

        >>> import iiwasim as iw
        >>> plan = iw.plan(iw.Program([iw.wait(0.25)], start_deg=[0] * 7))
        >>> plan.motions[0].time_s
        0.25
        """
        return self.end_s - self.start_s


def motions(figures: Mapping[str, Any]) -> tuple[MotionFigures, ...]:
    """The motions in the figures of a plan."""

    def motion(own: Mapping[str, Any]) -> MotionFigures:
        limit = own["limited_by"]
        return MotionFigures(
            index=own["index"],
            type=own["type"],
            start_s=own["start_s"],
            end_s=own["end_s"],
            peak_velocity_rel=own["peak_velocity_rel"],
            limited_by=Limit(limit["joint"], limit["kind"]) if limit else None,
            figures=own,
            name=own.get("name"),
            comment=own.get("comment"),
            group=own.get("group"),
            rounds=tuple((one["number"], one["count"]) for one in own.get("rounds", ())),
            io=own.get("io"),
            value=own.get("value"),
        )

    return tuple(motion(own) for own in figures["motions"])


@dataclass(frozen=True)
class GroupFigures:
    """A group of motions of a plan.

    >>> import iiwasim as iw
    >>> motions = [iw.ptp(deg=[30] + [0] * 6), iw.wait(1, group="hold")]
    >>> [hold] = iw.plan(iw.Program(motions, start_deg=[0] * 7)).groups
    >>> hold.name, hold.motions, round(hold.duration_s, 3), hold.contiguous
    ('hold', 1, 1.0, True)
    """

    name: str
    """The name of the group."""
    motions: int
    """The number of motions and waits with a duration."""
    duration_s: float
    """The sum of the times of these motions, in s, without the settling after stops."""
    share: float
    """The share of the cycle time, 0 to 1."""
    contiguous: bool
    """`False` if other motions lie between the motions of the group."""


def groups(figures: Mapping[str, Any]) -> tuple[GroupFigures, ...]:
    """The groups in the figures of a plan."""
    return tuple(GroupFigures(**own) for own in figures.get("groups", ()))


@dataclass(frozen=True)
class RepeatFigures:
    """A repeat block of a plan.

    A round lasts from the start of its first motion to the start of the motion after the round, or
    to the end of the program: with settling and waits.

    >>> import iiwasim as iw
    >>> block = iw.repeat(4, [iw.wait(0.5), iw.wait(0.25)], name="pause")
    >>> [pause] = iw.plan(iw.Program([block], start_deg=[0] * 7)).repeats
    >>> pause.name, pause.first_motion, pause.motions, pause.count, pause.duration_s
    ('pause', 1, 2, 4, 3.0)
    """

    first_motion: int
    """The number of the first motion, from 1."""
    motions: int
    """The number of motions per round in the program."""
    count: int
    """The number of rounds; of an inner block, per round of the outer block."""
    depth: int
    """The depth of the nesting: 1, for an inner block 2 or more."""
    duration_s: float
    """The sum of the times of all rounds, in s; of an inner block, in all rounds of the outer
    block."""
    share: float
    """The share of the cycle time, 0 to 1."""
    min_round_s: float
    """The time of the shortest round, in s."""
    max_round_s: float
    """The time of the longest round, in s."""
    name: str | None = None
    """The name in the program, if any."""
    comment: str | None = None
    """The comment in the program, if any."""
    group: str | None = None
    """The group of the motions of the block that state none, if any."""


def repeats(figures: Mapping[str, Any]) -> tuple[RepeatFigures, ...]:
    """The repeat blocks in the figures of a plan."""
    return tuple(RepeatFigures(**own) for own in figures.get("repeats", ()))


def planned(program: Program, words: tuple[Timing, Shape, Search, int]) -> Plan:
    """Restores a pickled plan."""
    from ._native import plan

    timing, shape, search, samples = words
    return plan(program, timing=timing, blend_shape=shape, blend_search=search, samples=samples)


def sampled(plan: Plan, rate_hz: float) -> Samples:
    """Restores pickled samples."""
    return plan.sample(rate_hz=rate_hz)
