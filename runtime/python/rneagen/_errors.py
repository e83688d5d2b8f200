"""Exceptions, which carry the library's message."""
from __future__ import annotations


class Error(Exception):
    """What one of the libraries refused. `code` is its word for what is wrong: "URDF", "NO_COMPILER", "COMPILE", ..."""

    code: str

    def __init__(self, message: str, code: str = ""):
        super().__init__(message)
        self.code = code

    def __reduce__(self):
        return type(self), (*self.args, self.code)


class RobotError(Error, ValueError):
    """The URDF, the scene or an option is at fault. The message names the file and the link, joint or option."""


class BackendError(Error, RuntimeError):
    """The text cannot be compiled or run on this machine."""


def translated(function, *args):
    """Call a function of _core; its exceptions as ours."""
    try:
        return function(*args)
    except (ValueError, RuntimeError) as error:
        if len(error.args) != 2:
            raise
        kind = RobotError if isinstance(error, ValueError) else BackendError
        raise kind(*error.args) from None
