"""Read the settings of a package, its `wsgen.toml`."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from wsgen import tomlfile
from wsgen.diagnostics import Rule, Severity
from wsgen.suggestions import suggest

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.behavior import Behavior


INVALID_SETTINGS = Rule(
    code="PKG060",
    name="invalid-settings",
    severity=Severity.ERROR,
    severity_varies="a warning for a mistake in `[validate]`",
    summary="`wsgen.toml` is not TOML, or a key or value in it is invalid.",
    why="`wsgen` ignores an entry that it cannot use: a rule is not allowed, or a behavior is not "
    "checked.",
    example="""[[behavior]]
name = "drives straight"
drive = { linear = "fast" }
seconds = 2.0
moved = { x = 1.0 }""",
    instead="""[[behavior]]
name = "drives straight"
drive = { linear = 0.5 }
seconds = 2.0
moved = { x = 1.0 }""",
)

FILE = "wsgen.toml"
# What `wsgen new` records, and what a user may set.
KNOWN_KEYS = ("schema", "wsgen", "template", "target", "package", "answers", "validate", "behavior")


@dataclass(frozen=True, kw_only=True)
class Settings:
    """The part of the file that a user sets, and the distribution that `wsgen new` recorded."""

    file: Path
    allow: tuple[str, ...] = ()  # names of rules that the package breaks on purpose
    behaviors: tuple[Behavior, ...] = ()  # what its robot must do beyond standing
    distro: str | None = None  # target of the package, as `wsgen new` recorded it


def read_settings(package: Path) -> tuple[Settings, tuple[Diagnostic, ...]]:
    """Read the settings of the package in a folder; the defaults where it has none."""
    file = package / FILE
    try:
        document = tomlfile.load(file)
    except FileNotFoundError:
        return Settings(file=file), ()
    except OSError as error:
        return Settings(file=file), (
            INVALID_SETTINGS.at(
                file,
                message=f"{FILE} cannot be read: {error.strerror}.",
                hint="Make it readable for your user.",
            ),
        )
    except ValueError as error:
        return Settings(file=file), (
            INVALID_SETTINGS.at(
                file, message=f"{FILE} is not TOML: {error}.", hint="Fix it, or remove the file."
            ),
        )
    behaviors, found = _read_behaviors(document, file)
    settings = Settings(file=file, behaviors=behaviors, distro=_distro(document))
    found = (*_unknown_keys(document, file), *found)
    allow = _allow(document)
    if allow is None:
        return settings, (
            *found,
            _warn(
                file,
                "`allow` in [validate] is not a list of names.",
                'Write for example: allow = ["massless-root"]',
            ),
        )
    unknown = sorted(set(document.get("validate", {})) - {"allow"})
    return replace(settings, allow=allow), (
        *found,
        *(
            _warn(file, f"[validate] has no key `{key}`.", "Its only key is `allow`.")
            for key in unknown
        ),
    )


def _distro(document: dict[str, Any]) -> str | None:
    target = document.get("target")
    distro = target.get("distro") if isinstance(target, dict) else None
    return distro if isinstance(distro, str) else None


def _read_behaviors(
    document: dict[str, Any], file: Path
) -> tuple[tuple[Behavior, ...], tuple[Diagnostic, ...]]:
    if "behavior" not in document:
        return (), ()
    from wsgen.workspace.behavior_settings import read_behaviors  # noqa: PLC0415  most packages have none

    text = file.read_text(encoding="utf-8")
    return read_behaviors(document, file, text, INVALID_SETTINGS)


def _unknown_keys(document: dict[str, Any], file: Path) -> Iterator[Diagnostic]:
    """Report keys that nothing reads: wsgen would never run a misspelled behavior."""
    for key in document:
        if key not in KNOWN_KEYS:
            yield INVALID_SETTINGS.at(
                file,
                message=f"{FILE} has no key `{key}`.",
                hint=suggest(key.lower(), KNOWN_KEYS),
            )


def _allow(document: dict[str, Any]) -> tuple[str, ...] | None:
    section = document.get("validate", {})
    names = section.get("allow", []) if isinstance(section, dict) else None
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        return None
    return tuple(names)


def _warn(file: Path, message: str, hint: str) -> Diagnostic:
    return INVALID_SETTINGS.at(file, message=message, hint=hint, severity=Severity.WARNING)
