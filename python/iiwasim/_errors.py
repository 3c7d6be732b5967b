"""Exceptions for invalid input."""

from __future__ import annotations


class IiwasimError(ValueError):
    """Base class of errors in the input; the message gives the reason and the place.

    >>> import iiwasim as iw
    >>> issubclass(iw.ProgramError, iw.IiwasimError) and issubclass(iw.IiwasimError, ValueError)
    True
    """

    def __str__(self) -> str:
        return str(self.args[0]) if self.args else ""


class _TextError(IiwasimError):
    """An error at a place in a text."""

    @property
    def line(self) -> int | None:
        """The line, from 1; `None` for a program that was made from arguments.

        >>> import iiwasim as iw
        >>> try:
        ...     iw.Scene.from_json("{}")
        ... except iw.SceneError as error:
        ...     error.line
        1
        """
        return self.args[1] if len(self.args) > 1 else None

    @property
    def column(self) -> int | None:
        """The column in characters, from 1.

        >>> import iiwasim as iw
        >>> try:
        ...     iw.Scene.from_json(" {}")
        ... except iw.SceneError as error:
        ...     error.column > 1
        True
        """
        return self.args[2] if len(self.args) > 2 else None


class ProgramError(_TextError):
    """A program that cannot be read or planned.

    The message names the motion and the argument; for a program that was read from a text or a
    file, it states the line and the column.

    >>> import iiwasim as iw
    >>> try:
    ...     iw.Program([iw.wait(-1)], start_deg=[0] * 7)
    ... except iw.ProgramError as error:
    ...     str(error)
    'motion 1, seconds: a wait of -1 s; it must be from 0 to 86400 s'
    """

    @property
    def motion(self) -> int | None:
        """The number of the motion, from 1; `None` if the error does not concern one motion.

        >>> import iiwasim as iw
        >>> program = iw.Program([iw.ptp(deg=[0, 0, 0, -500, 0, 0, 0])], start_deg=[0] * 7)
        >>> try:
        ...     iw.plan(program)
        ... except iw.ProgramError as error:
        ...     error.motion, error.line
        (1, None)
        """
        return self.args[3] if len(self.args) > 3 else None


class ProfileError(_TextError):
    """A robot profile that cannot be read.

    >>> import iiwasim as iw
    >>> try:
    ...     iw.Robot.from_profile("[]")
    ... except iw.ProfileError as error:
    ...     error.line
    1
    """


class SceneError(_TextError):
    """A scene that cannot be read.

    >>> import iiwasim as iw
    >>> try:
    ...     iw.Scene.from_json('{"version": 7}')
    ... except iw.SceneError as error:
    ...     "version" in str(error)
    True
    """


class RecordingError(IiwasimError):
    """A recording, or a plan file, that cannot be used.

    >>> import iiwasim as iw
    >>> try:
    ...     iw.Recording([0.0, 1000.0, 2000.0], [[0.0] * 7] * 3)
    ... except iw.RecordingError as error:
    ...     print(error)
    the recording: ...
    """


class UnreachableError(IiwasimError):
    """A frame that the arm does not reach.

    >>> import iiwasim as iw
    >>> far = dict(x_mm=2000, y_mm=0, z_mm=300, a_deg=0, b_deg=180, c_deg=0)
    >>> try:
    ...     iw.Robot().ik(far, e1_deg=0, status=2)
    ... except iw.UnreachableError as error:
    ...     error.allowed_e1_deg
    []
    """

    @property
    def allowed_e1_deg(self) -> list[list[float]]:
        """Ranges of E1 (the A3 position) for which the frame is reachable, in deg.

        >>> import iiwasim as iw
        >>> iw.UnreachableError("too far", [[-10.0, 20.0]]).allowed_e1_deg
        [[-10.0, 20.0]]
        """
        return list(self.args[1]) if len(self.args) > 1 else []


class SunriseError(IiwasimError):
    """A Sunrise project or application that cannot be imported; the message names file and line.

    >>> import iiwasim as iw
    >>> raise iw.SunriseError("Welding.java:84: the condition depends on a measured force")
    Traceback (most recent call last):
        ...
    iiwasim._errors.SunriseError: Welding.java:84: the condition depends on a measured force
    """
