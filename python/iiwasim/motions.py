"""Functions that return motions as the dicts of program files.

Arguments that are left out are not in the dict; the robot's limits and the program's tool and base
apply then.
"""

from __future__ import annotations

# Imported at run time, too: `typing.get_type_hints` needs these names.
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any, Union

import numpy as np

from ._options import Frame, Numbers

Share = Union[float, Numbers]

Motion = dict[str, Any]
"""A motion, as in program files.

>>> import iiwasim as iw
>>> isinstance(iw.wait(1), iw.Motion)
True
"""


# Keys of motions that functions build from arguments with other names.
INSTEAD = {
    "blend": "give blend_cart_mm, blend_ori_deg or blend_sunrise_rel",
    "offset": "give x_mm, y_mm, z_mm, a_deg, b_deg or c_deg",
    "in": "give within",
    "type": "its motions have their type",
}


def _numbers(name: str, values: Numbers) -> list[float]:
    with _named(name, values, "a list of numbers"):
        return [_real(value) for value in values]


def _real(value: Any) -> float:
    """Converts to a number. NumPy would accept masked values, and drop imaginary parts."""
    if np.ma.is_masked(value) or np.iscomplexobj(value):
        raise TypeError
    return float(value)


def _share(name: str, value: Share | None) -> float | list[float] | None:
    if value is None or isinstance(value, (int, float)):
        return value
    with _named(name, value, "a number, or one for each joint,"):
        return _real(value) if np.ndim(value) == 0 else [_real(one) for one in value]


@contextmanager
def _named(name: str, value: object, expected: str) -> Iterator[None]:
    """Adds the name of the argument to errors of number conversion."""
    message = "{} is {!r}; {} is expected"
    try:
        yield
    except TypeError:
        raise TypeError(message.format(name, value, expected)) from None
    except ValueError:
        raise ValueError(message.format(name, value, expected)) from None


def _motion(kind: str, /, **given: Any) -> Motion:
    return {"type": kind, **{key: value for key, value in given.items() if value is not None}}


def _others(kind: str, limits: dict[str, Any], *made: str) -> dict[str, Any]:
    """The further keys of a motion, without the keys that are built from other arguments."""
    for key in ("type", "blend", *made):
        if key in limits:
            raise TypeError(f"{kind} has no argument {key!r}: {INSTEAD[key]}")
    return limits


def _blend(
    cart_mm: float | None, ori_deg: float | None, **others: float | None
) -> dict[str, float] | None:
    given = {"cart_mm": cart_mm, "ori_deg": ori_deg, **others}
    return {key: value for key, value in given.items() if value is not None} or None


def ptp(
    *,
    deg: Numbers | None = None,
    rad: Numbers | None = None,
    frame: Frame | None = None,
    velocity_rel: Share | None = None,
    acceleration_rel: Share | None = None,
    jerk_rel: Share | None = None,
    blend_cart_mm: float | None = None,
    blend_ori_deg: float | None = None,
    blend_fraction: float | None = None,
    blend_sunrise_rel: float | None = None,
    blocking: bool = False,
    tool: str | None = None,
    base: str | None = None,
    name: str | None = None,
    comment: str | None = None,
    group: str | None = None,
) -> Motion:
    """Moves all joints to joint positions, in deg or rad, or to a frame; all joints arrive
    together.

    Shares of the robot's limits are above 0 and at most 1, for all joints or one per joint. A blend
    rounds the corner at the target: `blend_cart_mm` is a radius, `blend_fraction` a share of the
    neighbouring segments up to 0.5, `blend_sunrise_rel` the argument of Sunrise's `setBlendingRel`.
    A `blocking` motion, for whose end the program waits, is followed by a longer standstill.

    All motions may have a `name` and a `comment`, for tables, reports and messages, and a `group`,
    whose time is in `Plan.groups`.

    >>> import iiwasim as iw
    >>> motion = iw.ptp(deg=[0, 30, 0, -60, 0, 90, 0], velocity_rel=0.5, blend_cart_mm=50)
    >>> motion["type"], motion["joints_deg"]
    ('ptp', [0.0, 30.0, 0.0, -60.0, 0.0, 90.0, 0.0])
    >>> motion["velocity_rel"], motion["blend"]
    (0.5, {'cart_mm': 50})
    """
    if sum(value is not None for value in (deg, rad, frame)) != 1:
        raise ValueError("ptp goes to one of deg, rad and frame")
    return _motion(
        "ptp",
        joints_deg=None if deg is None else _numbers("deg", deg),
        joints_rad=None if rad is None else _numbers("rad", rad),
        frame=frame,
        tool=tool,
        base=base,
        velocity_rel=_share("velocity_rel", velocity_rel),
        acceleration_rel=_share("acceleration_rel", acceleration_rel),
        jerk_rel=_share("jerk_rel", jerk_rel),
        blend=_blend(
            blend_cart_mm, blend_ori_deg, fraction=blend_fraction, sunrise_rel=blend_sunrise_rel
        ),
        blocking=blocking or None,
        name=name,
        comment=comment,
        group=group,
    )


def lin(
    frame: Frame,
    *,
    cart_velocity_mm_s: float | None = None,
    blend_cart_mm: float | None = None,
    blend_ori_deg: float | None = None,
    blend_sunrise_rel: float | None = None,
    name: str | None = None,
    comment: str | None = None,
    group: str | None = None,
    **limits: Any,
) -> Motion:
    """Moves the TCP on a straight line to a frame: the name of a program frame, or a dict.

    `limits` are all other limits of program files, and `tool`, `base` and `orientation`.

    >>> import iiwasim as iw
    >>> iw.lin("place", cart_velocity_mm_s=250, cart_jerk_mm_s3=20000)
    {'type': 'lin', 'frame': 'place', 'cart_velocity_mm_s': 250, 'cart_jerk_mm_s3': 20000}
    """
    blend = _blend(blend_cart_mm, blend_ori_deg, sunrise_rel=blend_sunrise_rel)
    return _motion(
        "lin",
        frame=frame,
        cart_velocity_mm_s=cart_velocity_mm_s,
        name=name,
        comment=comment,
        group=group,
        **_others("lin", limits),
        blend=blend,
    )


def lin_rel(
    *,
    x_mm: float = 0,
    y_mm: float = 0,
    z_mm: float = 0,
    a_deg: float = 0,
    b_deg: float = 0,
    c_deg: float = 0,
    within: str | Mapping[str, Any] | None = None,
    e1_deg: float | None = None,
    cart_velocity_mm_s: float | None = None,
    blend_cart_mm: float | None = None,
    blend_ori_deg: float | None = None,
    blend_sunrise_rel: float | None = None,
    name: str | None = None,
    comment: str | None = None,
    group: str | None = None,
    **limits: Any,
) -> Motion:
    """Moves the TCP on a straight line by an offset, along the TCP axes or the axes of `within`.

    >>> import iiwasim as iw
    >>> iw.lin_rel(z_mm=-80, cart_velocity_mm_s=250)
    {'type': 'lin_rel', 'offset': {'z_mm': -80}, 'cart_velocity_mm_s': 250}
    """
    given = {
        "x_mm": x_mm,
        "y_mm": y_mm,
        "z_mm": z_mm,
        "a_deg": a_deg,
        "b_deg": b_deg,
        "c_deg": c_deg,
    }
    return _motion(
        "lin_rel",
        offset={key: value for key, value in given.items() if value},
        **{"in": within},
        e1_deg=e1_deg,
        cart_velocity_mm_s=cart_velocity_mm_s,
        name=name,
        comment=comment,
        group=group,
        **_others("lin_rel", limits, "offset", "in"),
        blend=_blend(blend_cart_mm, blend_ori_deg, sunrise_rel=blend_sunrise_rel),
    )


def circ(
    aux: Frame,
    frame: Frame,
    *,
    circ_angle_deg: float | None = None,
    cart_velocity_mm_s: float | None = None,
    blend_cart_mm: float | None = None,
    blend_ori_deg: float | None = None,
    blend_sunrise_rel: float | None = None,
    name: str | None = None,
    comment: str | None = None,
    group: str | None = None,
    **limits: Any,
) -> Motion:
    """Moves the TCP on a circular arc through `aux` to `frame`, or by `circ_angle_deg`.

    >>> import iiwasim as iw
    >>> iw.circ("via", "place", cart_velocity_mm_s=300)
    {'type': 'circ', 'aux': 'via', 'frame': 'place', 'cart_velocity_mm_s': 300}
    """
    return _motion(
        "circ",
        aux=aux,
        frame=frame,
        circ_angle_deg=circ_angle_deg,
        cart_velocity_mm_s=cart_velocity_mm_s,
        name=name,
        comment=comment,
        group=group,
        **_others("circ", limits),
        blend=_blend(blend_cart_mm, blend_ori_deg, sunrise_rel=blend_sunrise_rel),
    )


def spline(
    segments: Sequence[Mapping[str, Any]],
    *,
    cart_velocity_mm_s: float | None = None,
    blend_cart_mm: float | None = None,
    blend_ori_deg: float | None = None,
    blend_sunrise_rel: float | None = None,
    name: str | None = None,
    comment: str | None = None,
    group: str | None = None,
    **limits: Any,
) -> Motion:
    """Moves the TCP through frames without a stop; segments are `spl`, `lin` and `circ` dicts.

    >>> import iiwasim as iw
    >>> iw.spline([{"type": "spl", "frame": "via"}, {"type": "lin", "frame": "place"}])["type"]
    'spline'
    """
    return _motion(
        "spline",
        segments=[dict(segment) for segment in segments],
        cart_velocity_mm_s=cart_velocity_mm_s,
        name=name,
        comment=comment,
        group=group,
        **_others("spline", limits),
        blend=_blend(blend_cart_mm, blend_ori_deg, sunrise_rel=blend_sunrise_rel),
    )


def wait(
    seconds: float,
    *,
    overlap: bool | int = False,
    name: str | None = None,
    comment: str | None = None,
    group: str | None = None,
) -> Motion:
    """Waits at standstill.

    With `overlap` the waiting time is counted from the start of the motion before; a number counts
    that many motions back.

    >>> import iiwasim as iw
    >>> iw.wait(0.5), iw.wait(1, overlap=True)
    ({'type': 'wait', 'seconds': 0.5}, {'type': 'wait', 'seconds': 1, 'overlap': True})
    """
    is_flag = isinstance(overlap, (bool, np.bool_))
    return _motion(
        "wait",
        seconds=seconds,
        overlap=True if is_flag and overlap else None,
        overlap_motions=None if is_flag else overlap,
        name=name,
        comment=comment,
        group=group,
    )


def set_io(
    io: str,
    value: bool | float,
    *,
    overlap: bool | int = False,
    name: str | None = None,
    comment: str | None = None,
    group: str | None = None,
) -> Motion:
    """Sets an output, which takes no time. On a Sunrise controller, its name is `Group.Signal`.

    The arm is at rest. With `overlap` the output is set at the start of the motion before; a number
    counts that many motions back.

    >>> import iiwasim as iw
    >>> iw.set_io("Gripper.Close", True)
    {'type': 'set', 'io': 'Gripper.Close', 'value': True}
    """
    is_flag = isinstance(overlap, (bool, np.bool_))
    return _motion(
        "set",
        io=io,
        value=_io_value(value),
        overlap=True if is_flag and overlap else None,
        overlap_motions=None if is_flag else overlap,
        name=name,
        comment=comment,
        group=group,
    )


def wait_for(
    io: str,
    value: bool | float,
    seconds: float,
    *,
    overlap: bool | int = False,
    name: str | None = None,
    comment: str | None = None,
    group: str | None = None,
) -> Motion:
    """Waits until an input has a value.

    The plan assumes that this takes `seconds`, and lists the assumption. The arm is at rest. With
    `overlap` the time is counted from the start of the motion before; a number counts that many
    motions back.

    >>> import iiwasim as iw
    >>> iw.wait_for("Gripper.Closed", True, 0.4)
    {'type': 'wait_for', 'io': 'Gripper.Closed', 'value': True, 'seconds': 0.4}
    """
    is_flag = isinstance(overlap, (bool, np.bool_))
    return _motion(
        "wait_for",
        io=io,
        value=_io_value(value),
        seconds=seconds,
        overlap=True if is_flag and overlap else None,
        overlap_motions=None if is_flag else overlap,
        name=name,
        comment=comment,
        group=group,
    )


def _io_value(value: bool | float) -> bool | float:
    """Converts scalars of NumPy; `False` is a value, too."""
    return value.item() if isinstance(value, np.generic) else value


def load(
    mass_kg: float | None,
    *,
    center_mm: Numbers = (0, 0, 0),
    inertia_kg_m2: Numbers | None = None,
    abc_deg: Numbers | None = None,
    shapes: Iterable[Mapping[str, Any]] = (),
    name: str | None = None,
    comment: str | None = None,
    group: str | None = None,
) -> Motion:
    """Sets the load at the flange (tool and workpiece); `None` restores the load of the tool.

    `shapes` are the shapes of the workpiece in the flange frame, which count in clearances: dicts
    with the keys of program files.

    >>> import iiwasim as iw
    >>> iw.load(2.5, center_mm=[0, 0, 60])
    {'type': 'load', 'load': {'mass_kg': 2.5, 'center_mm': [0.0, 0.0, 60.0]}}
    >>> ball = {"type": "sphere", "center_mm": [0, 0, 150], "radius_mm": 40}
    >>> iw.load(1, shapes=[ball])["load"]["shapes"]
    [{'type': 'sphere', 'center_mm': [0, 0, 150], 'radius_mm': 40}]
    """
    labels = {"name": name, "comment": comment, "group": group}
    if mass_kg is None:
        return {**_motion("load", **labels), "load": None}
    own: dict[str, Any] = {"mass_kg": mass_kg, "center_mm": _numbers("center_mm", center_mm)}
    if inertia_kg_m2 is not None:
        own["inertia_kg_m2"] = _numbers("inertia_kg_m2", inertia_kg_m2)
    if abc_deg is not None:
        own["abc_deg"] = _numbers("abc_deg", abc_deg)
    if listed := [dict(shape) for shape in shapes]:
        own["shapes"] = listed
    return _motion("load", load=own, **labels)


def repeat(
    count: int,
    motions: Iterable[Motion],
    *,
    name: str | None = None,
    comment: str | None = None,
    group: str | None = None,
) -> Motion:
    """Repeats motions `count` times; blocks may contain further blocks.

    `group` is the group of all motions of the block that state no group. A program counts the
    motions of all rounds.

    >>> import iiwasim as iw
    >>> block = iw.repeat(3, [iw.lin_rel(z_mm=10), iw.wait(0.5)], name="stack")
    >>> len(iw.Program([iw.ptp(deg=[0, 30, 0, -60, 0, 90, 0]), block], start_deg=[0] * 7))
    7
    """
    return _motion(
        "repeat",
        count=count,
        motions=[dict(motion) for motion in motions],
        name=name,
        comment=comment,
        group=group,
    )
