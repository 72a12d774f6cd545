"""What xacro made of files, for launch files that have the same robot expanded.

Most packages have several launch files that start the same robot. What a xacro file becomes depends
on its arguments, the environment, the files it reads and where packages are: while these are the
same, it is not expanded again.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, NamedTuple

from wsgen.isolation.child import copy_environment
from wsgen.launching.record import RECORD, CommandOutcome

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from wsgen.launching.record import CommandRunner, Record


MOST_KNOWN = 16  # expansions that are kept


class _Known(NamedTuple):
    """An expansion, and what it depends on."""

    outcome: CommandOutcome
    texts: Mapping[str, str]  # that were noted, and their files
    opened: Sequence[str]  # robots among the files
    environment: Mapping[str, str]
    files: Mapping[str, tuple[int, ...] | None]  # that were read, and their states
    prefixes: Mapping[str, str | None]  # of packages that were looked up


class Expansions:
    """Runs command lines of xacro, those that are known only once."""

    def __init__(self, run_xacro: CommandRunner) -> None:
        self._run_xacro = run_xacro
        self._known: dict[tuple[str, ...], _Known] = {}  # by command line and folder

    def run(self, words: Sequence[str]) -> CommandOutcome:
        """What the command line prints."""
        if any(word.startswith("-") for word in words[1:]):  # it may write files
            return self._run_xacro(words)
        key = (os.getcwd(), *words)
        known = self._known.get(key)
        if known is None or not _holds(known):
            return self._expand(key, words)
        RECORD.texts.update(known.texts)
        RECORD.opened.extend(known.opened)
        return known.outcome

    def _expand(self, key: tuple[str, ...], words: Sequence[str]) -> CommandOutcome:
        from ament_index_python import packages  # of the shim

        environment = copy_environment()
        prefixes: dict[str, str | None] = {}
        find = packages.find_prefix

        def find_and_note(name: str, prefix: str | None) -> str | None:
            prefixes[name] = prefix
            return find(name, prefix)

        RECORD.opened_by_xacro = []
        packages.find_prefix = find_and_note
        try:
            # What it notes is the same whatever the launch file has had noted before.
            with RECORD.apart() as noted:
                outcome = self._run_xacro(words)
        finally:
            packages.find_prefix = find
            files, RECORD.opened_by_xacro = RECORD.opened_by_xacro, None
        # What it notes beyond its texts, it has to note again.
        if outcome.code == 0 and not _has_more(noted) and None not in prefixes.values():
            while len(self._known) >= MOST_KNOWN:
                del self._known[next(iter(self._known))]
            self._known[key] = _Known(
                outcome=outcome,
                texts=noted.texts,
                opened=noted.opened,
                environment=environment,
                files={file: _state(file) for file in files},
                prefixes=prefixes,
            )
        return outcome


def _has_more(noted: Record) -> bool:
    """Whether an expansion has noted more than its texts and the robots that it opened."""
    return any(
        (
            noted.unresolved,
            noted.diagnostics,
            noted.lookups,
            noted.unset,
            noted.unused_xacro_arguments,
            noted.left_out,
        )
    )


def _holds(known: _Known) -> bool:
    """Whether everything that an expansion depends on is as it was."""
    from ament_index_python.resources import has_resource  # of the shim

    return (
        known.environment == copy_environment()
        and all(_state(file) == state for file, state in known.files.items())
        and all(has_resource("packages", name) == one for name, one in known.prefixes.items())
    )


def _state(file: str) -> tuple[int, ...] | None:
    try:
        found = os.stat(file)
    except (OSError, ValueError):
        return None
    return found.st_ino, found.st_size, found.st_mtime_ns
