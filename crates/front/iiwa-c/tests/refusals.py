"""Refusals of the C functions, and their messages."""

import ctypes
import math

from library import Failure, Library, State

PROGRAM = b'{ "version": 1, "start": { "joints_deg": [0, 0, 0, 0, 0, 0, 0] }, "motions": [%s] }'
GOOD = PROGRAM % b'{ "type": "ptp", "joints_deg": [10, 0, 0, 0, 0, 0, 0] }'
UNKNOWN = PROGRAM % b'{ "type": "ptq" }'
ARGUMENT, FILE, PROGRAM_STATUS, PLAN = 1, 2, 3, 4


def refused(status, says, work, line=0, column=0, motion=0):
    try:
        work()
    except Failure as failure:
        found = (failure.status, failure.line, failure.column, failure.motion)
        assert found == (status, line, column, motion), f"{found}: {failure}"
        assert says in str(failure), f"{failure} does not say {says!r}"
        return
    raise AssertionError(f"nothing is refused where {says!r} should be")


def check(library: Library, folder):
    def plan(program, **options):
        def work():
            with library.plan(program, **options):
                pass

        return work

    place = ctypes.byref(ctypes.c_void_p())
    state = State()
    cases = 0
    for arguments in [
        (ARGUMENT, "json is NULL", lambda: library.call("iiwasim_program_from_json", None, place)),
        (
            ARGUMENT,
            "program is NULL",
            lambda: library.call("iiwasim_program_from_json", GOOD, None),
        ),
        (ARGUMENT, "json is not UTF-8 text", plan(b"\xff")),
        (ARGUMENT, "path is NULL", lambda: library.call("iiwasim_program_load", None, place)),
        (ARGUMENT, "program is NULL", lambda: library.call("iiwasim_plan", None, None, place)),
        (ARGUMENT, "plan is NULL", lambda: library.at(None, 0.0)),
        (ARGUMENT, "no robot is called `kr_6`", plan(GOOD, robot="kr_6")),
        (FILE, "cannot read", plan(folder / "none.json")),
        (PROGRAM_STATUS, "the robot's profile: ", plan(GOOD, robot='{ "version": 2 }'), 1, 14),
        (PROGRAM_STATUS, "expected", plan(b"{\n  ]"), 2, 3),
        (PROGRAM_STATUS, "motion 1: ", plan(UNKNOWN), 1, UNKNOWN.index(b'"ptq"') + 1, 1),
        (ARGUMENT, "a limit of 0.5 %", plan(GOOD, limit_torque_percent=0.5)),
        (PLAN, "cannot hold", plan(HOLDS_NOT), 3, 1, 1),
    ]:
        refused(*arguments)
        cases += 1
    with library.plan(GOOD) as loaded:
        for arguments in [
            (ARGUMENT, "state is NULL", lambda: library.call("iiwasim_plan_at", loaded, 0.0, None)),
            (ARGUMENT, "t_s is not a number", lambda: library.at(loaded, math.nan)),
            (ARGUMENT, "rate_hz is 0", lambda: sample(library, loaded, 0.0, state, 1)),
            (ARGUMENT, "rate_hz is inf", lambda: sample(library, loaded, math.inf, state, 1)),
            (ARGUMENT, "capacity of 1", lambda: sample(library, loaded, 100.0, state, 1)),
            (ARGUMENT, "states is NULL", lambda: sample(library, loaded, 100.0, None, 9)),
            (
                ARGUMENT,
                "json is NULL",
                lambda: library.call("iiwasim_plan_figures_json", loaded, None),
            ),
            (
                ARGUMENT,
                "the model's name",
                lambda: library.text("iiwasim_plan_fmu_json", loaded, b"a\nb"),
            ),
        ]:
            refused(*arguments)
            cases += 1
        # A refused call does not affect the next one.
        assert sample(library, loaded, 1e-3, state, 0) == 2
        assert library.at(loaded, math.inf).q[0] == library.at(loaded, 1e9).q[0]
    print(f"{cases} bad calls are refused with a message, and where it is")


# No motion is slow enough for a torque limit of 20 % with an outstretched arm.
HOLDS_NOT = b"""{ "version": 1, "limit_torque_percent": 20,
  "start": { "joints_deg": [0, 90, 0, 0, 0, 0, 0] }, "motions": [
{ "type": "ptp", "joints_deg": [10, 90, 0, 0, 0, 0, 0] }] }"""


def sample(library, plan, rate_hz, states, capacity):
    count = ctypes.c_size_t()
    states = None if states is None or capacity == 0 else ctypes.byref(states)
    library.call("iiwasim_plan_sample", plan, rate_hz, states, capacity, ctypes.byref(count))
    return count.value
