"""Figures of plans as objects."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Mapping

    import numpy as np
    from numpy.typing import NDArray

    from ._native import Plan, Program, Samples


class Limit(NamedTuple):
    """A limit of a joint or of the TCP.

    >>> import iiwasim as iw
    >>> iw.Limit(joint=4, kind="jerk").joint
    4
    """

    joint: int | None
    """The joint, 1 to 7; `None` if the TCP is limited."""
    kind: str
    """`velocity`, `acceleration`, `jerk` or `torque`; with `cart_` or `orientation_` for the TCP.
    """


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


@dataclass(frozen=True)
class MotionFigures:
    """A motion of a plan, or a wait.

    >>> import iiwasim as iw
    >>> plan = iw.plan(iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(1)], start_deg=[0] * 7))
    >>> first, second = plan.motions
    >>> first.type, second.type, round(second.time_s, 3)
    ('ptp', 'wait', 1.0)
    """

    index: int
    """The place in the program, from 1."""
    type: str
    """`ptp`, `lin`, `lin_rel`, `circ`, `spline`, `spl` or `wait`."""
    start_s: float
    """Start time, in s."""
    end_s: float
    """End time, in s."""
    peak_velocity_rel: float
    """The peak joint velocity as a share of its limit, over all joints, 0 to 1."""
    limited_by: Limit | None
    """The limit that is active for the longest time; `None` if no limit is active."""
    figures: Mapping[str, Any]
    """All figures, as in `Plan.figures()["motions"]`."""

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
        )

    return tuple(motion(own) for own in figures["motions"])


def planned(program: Program, words: tuple[str, str, str, int]) -> Plan:
    """Restores a pickled plan."""
    from ._native import plan

    timing, shape, search, samples = words
    return plan(program, timing=timing, blend_shape=shape, blend_search=search, samples=samples)


def sampled(plan: Plan, rate_hz: float) -> Samples:
    """Restores pickled samples."""
    return plan.sample(rate_hz=rate_hz)
