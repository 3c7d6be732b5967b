"""Motion simulator for the KUKA LBR iiwa: predicts robot paths and cycle times.

>>> import iiwasim as iw
>>> program = iw.Program([iw.ptp(deg=[20, 0, 0, -30, 0, 0, 0]), iw.wait(0.5)], start_deg=[0] * 7)
>>> plan = iw.plan(program)
>>> plan
<iiwasim.Plan 1.165 s, 2 motions, sunrise>
>>> plan.motions[0].limited_by
Limit(joint=4, kind='acceleration')

Angles are in rad, lengths in m and times in s unless a name ends in another unit; arrays are
(n, 7) and float64.
"""

from importlib.metadata import version as _version

from ._errors import (
    IiwasimError,
    ProfileError,
    ProgramError,
    RecordingError,
    SceneError,
    SunriseError,
    UnreachableError,
)
from ._figures import GroupFigures, Limit, MotionFigures, RepeatFigures, State, States
from ._native import (
    Clearance,
    Comparison,
    Identification,
    Optimum,
    PlaceMap,
    Plan,
    Program,
    Recording,
    Robot,
    Samples,
    Scene,
    TaskOrder,
    applications,
    frame,
    import_application,
    optimise,
    order,
    place,
    plan,
    plan_all,
    pose,
)
from ._recordings import compare, identify
from .drive import Drive, DriveError, DriveState, DriveTimeout, JointSample, Run
from .motions import (
    Motion,
    circ,
    lin,
    lin_rel,
    load,
    ptp,
    repeat,
    set_io,
    spline,
    wait,
    wait_for,
)

__version__ = _version("iiwasim")

__all__ = [
    "Clearance",
    "Comparison",
    "Drive",
    "DriveError",
    "DriveState",
    "DriveTimeout",
    "GroupFigures",
    "Identification",
    "IiwasimError",
    "JointSample",
    "Limit",
    "Motion",
    "MotionFigures",
    "Optimum",
    "PlaceMap",
    "Plan",
    "ProfileError",
    "Program",
    "ProgramError",
    "Recording",
    "RecordingError",
    "RepeatFigures",
    "Robot",
    "Run",
    "Samples",
    "Scene",
    "SceneError",
    "State",
    "States",
    "SunriseError",
    "TaskOrder",
    "UnreachableError",
    "applications",
    "circ",
    "compare",
    "frame",
    "identify",
    "import_application",
    "lin",
    "lin_rel",
    "load",
    "optimise",
    "order",
    "place",
    "plan",
    "plan_all",
    "pose",
    "ptp",
    "repeat",
    "set_io",
    "spline",
    "wait",
    "wait_for",
]
