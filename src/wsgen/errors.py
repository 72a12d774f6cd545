"""Every exception that wsgen raises on purpose, and the exit code each one ends with.

WsgenError                          base; never raised itself
├── SessionDiedError            1   a physics engine, or a live launch, died while it worked
├── RequestError                2   the request is wrong: name, option, template, target
├── WouldOverwriteError         3   something exists already; nothing was written
├── NotFoundError               4   a required tool or file is missing
├── NotReadableError            4   a file exists and cannot be read or written
└── BrokenTemplateError         4   a template exists and cannot be rendered

An error in the user's files is a `Diagnostic`, not an exception: wsgen goes on, collects all
of them, and ends with exit code 1.

Every message says what happened and where; `hint` is the next step to try.
"""

from __future__ import annotations

EXIT_PASSED = 0
EXIT_FAILED = 1
EXIT_REQUEST = 2
EXIT_WOULD_OVERWRITE = 3
EXIT_MISSING = 4
EXIT_BUG = 70
EXIT_SIGNALLED = 128  # plus the number of the signal
EXIT_INTERRUPTED = 130
EXIT_STOPPED = 147  # of a child process alone: SIGSTOP would have it wait for ever

# What wsgen prints when one of these signals ends it.
SIGNAL_MESSAGES = {
    "SIGINT": "wsgen: interrupted",  # Ctrl-C
    "SIGTERM": "wsgen: terminated",  # CI cancels
    "SIGHUP": "wsgen: the terminal was closed",
}


class WsgenError(Exception):
    """Base of all errors that the user sees without a traceback."""

    exit_code = EXIT_REQUEST

    def __init__(self, message: str, *, hint: str) -> None:
        super().__init__(message)
        self.message = message
        self.hint = hint

    def __str__(self) -> str:
        """Message and hint on a line each."""
        return f"{self.message}\n{self.hint}"


class SessionDiedError(WsgenError):
    """A physics engine, or a live launch, died while it executed a command."""

    exit_code = EXIT_FAILED


class RequestError(WsgenError):
    """The request is wrong: nothing else was checked, nothing was written."""

    exit_code = EXIT_REQUEST


class WouldOverwriteError(WsgenError):
    """Something exists already; nothing was written."""

    exit_code = EXIT_WOULD_OVERWRITE


class NotFoundError(WsgenError):
    """A required tool, file or folder is missing."""

    exit_code = EXIT_MISSING


class NotReadableError(WsgenError):
    """A file or folder exists and cannot be read or written."""

    exit_code = EXIT_MISSING


class BrokenTemplateError(WsgenError):
    """A template exists and cannot be rendered."""

    exit_code = EXIT_MISSING
