"""ctypes bindings of the functions of iiwasim.h that FMUs and tests need."""

import ctypes
import json
from contextlib import contextmanager


class State(ctypes.Structure):
    """IiwasimState."""

    _fields_ = [
        ("t_s", ctypes.c_double),
        ("q", ctypes.c_double * 7),
        ("dq", ctypes.c_double * 7),
        ("ddq", ctypes.c_double * 7),
        ("tcp_m", ctypes.c_double * 3),
        ("tcp_xyzw", ctypes.c_double * 4),
        ("motion", ctypes.c_uint32),
    ]


class Options(ctypes.Structure):
    """IiwasimOptions."""

    _fields_ = [
        ("robot", ctypes.c_char_p),
        ("timing", ctypes.c_int32),
        ("samples", ctypes.c_uint32),
        ("limit_torque_percent", ctypes.c_double),
    ]


class Error(ctypes.Structure):
    """IiwasimError."""

    _fields_ = [
        ("status", ctypes.c_int),
        ("line", ctypes.c_uint32),
        ("column", ctypes.c_uint32),
        ("motion", ctypes.c_uint32),
        ("message", ctypes.c_char_p),
    ]


class Failure(Exception):
    """A failed call, with its status and its place in the program text."""

    def __init__(self, error):
        super().__init__(error.message.decode())
        self.status, self.line, self.column, self.motion = (
            error.status,
            error.line,
            error.column,
            error.motion,
        )


class Library:
    def __init__(self, path):
        self.c = ctypes.CDLL(str(path))
        self.c.iiwasim_version.restype = ctypes.c_char_p
        self.c.iiwasim_plan_at.argtypes = [ctypes.c_void_p, ctypes.c_double, ctypes.c_void_p]
        self.c.iiwasim_plan_sample.argtypes = [
            ctypes.c_void_p,
            ctypes.c_double,
            ctypes.c_void_p,
            ctypes.c_size_t,
            ctypes.c_void_p,
        ]

    def call(self, name, *arguments):
        if getattr(self.c, name)(*arguments) != 0:
            error = Error()
            self.c.iiwasim_last_error(ctypes.byref(error))
            raise Failure(error)

    def text(self, name, *arguments):
        """A text returned by the library."""
        place = ctypes.c_void_p()
        self.call(name, *arguments, ctypes.byref(place))
        try:
            return ctypes.string_at(place).decode()
        finally:
            self.c.iiwasim_string_free(place)

    @contextmanager
    def plan(self, program, *, robot=None, timing="sunrise", limit_torque_percent=0.0):
        """Plans a program, given as a path or as text in bytes."""
        options = Options()
        self.call("iiwasim_options_default", ctypes.byref(options))
        options.robot = None if robot is None else robot.encode()
        options.timing = {"jerk": 0, "acceleration": 1, "sunrise": 2}[timing]
        options.limit_torque_percent = limit_torque_percent
        loaded, plan = ctypes.c_void_p(), ctypes.c_void_p()
        try:
            if isinstance(program, bytes):
                self.call("iiwasim_program_from_json", program, ctypes.byref(loaded))
            else:
                self.call("iiwasim_program_load", str(program).encode(), ctypes.byref(loaded))
            self.call("iiwasim_plan", loaded, ctypes.byref(options), ctypes.byref(plan))
            yield plan
        finally:
            self.c.iiwasim_plan_free(plan)
            self.c.iiwasim_program_free(loaded)

    def at(self, plan, t_s):
        state = State()
        self.call("iiwasim_plan_at", plan, t_s, ctypes.byref(state))
        return state

    def figures(self, plan):
        return json.loads(self.text("iiwasim_plan_figures_json", plan))
