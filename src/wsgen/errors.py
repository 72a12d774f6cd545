"""Every exception that wsgen raises on purpose, and the exit code each one ends with.

WsgenError                          base; never raised itself
├── RequestError                2   the request is wrong: name, option, template, target
├── WouldOverwriteError         3   something is there already; nothing was written
├── NotFoundError               4   a tool or a file that is needed is missing
├── NotReadableError            4   a file is there and cannot be read or written
└── BrokenTemplateError         4   a template is there and cannot be made into a package

What is wrong with the user's files is a `Diagnostic`, not an exception: wsgen goes on and collects
the next one, and ends with exit code 1.

Every message says what happened and where; `hint` is the next step to try.
"""

from __future__ import annotations

EXIT_PASSED = 0
EXIT_FAILED = 1
EXIT_REQUEST = 2
EXIT_WOULD_OVERWRITE = 3
EXIT_MISSING = 4
EXIT_BUG = 70
EXIT_SIGNALLED = 128  # and the number of the signal
EXIT_INTERRUPTED = 130

# What is reported when one of the signals that end wsgen comes.
SIGNAL_MESSAGES = {
    "SIGINT": "wsgen: interrupted",  # Ctrl-C
    "SIGTERM": "wsgen: terminated",  # CI cancels
    "SIGHUP": "wsgen: the terminal was closed",
}


class WsgenError(Exception):
    """Base of all errors that are told to the user without a traceback."""

    exit_code = EXIT_REQUEST

    def __init__(self, message: str, *, hint: str) -> None:
        super().__init__(message)
        self.message = message
        self.hint = hint

    def __str__(self) -> str:
        """Message and hint on a line each."""
        return f"{self.message}\n{self.hint}"


class RequestError(WsgenError):
    """The request is wrong: nothing was looked at beyond it, nothing was written."""

    exit_code = EXIT_REQUEST


class WouldOverwriteError(WsgenError):
    """Something is there already; nothing was written."""

    exit_code = EXIT_WOULD_OVERWRITE


class NotFoundError(WsgenError):
    """A tool, file or folder that is needed is missing."""

    exit_code = EXIT_MISSING


class NotReadableError(WsgenError):
    """A file or folder is there and cannot be read or written."""

    exit_code = EXIT_MISSING


class BrokenTemplateError(WsgenError):
    """A template is there and cannot be made into a package."""

    exit_code = EXIT_MISSING
