"""What a package says to wsgen: its `wsgen.toml`."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from wsgen import tomlfile
from wsgen.diagnostics import Diagnostic, Severity
from wsgen.suggestions import suggest

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from wsgen.model.behavior import Behavior


FILE = "wsgen.toml"
# What `wsgen new` records, and what a person may wish.
KNOWN = ("schema", "wsgen", "template", "target", "package", "answers", "validate", "behavior")


@dataclass(frozen=True, kw_only=True)
class Settings:
    """The part of the file that is a wish, not a record."""

    file: Path
    allow: tuple[str, ...] = ()  # names of rules whose findings the package has on purpose
    behaviors: tuple[Behavior, ...] = ()  # what its robot must do beyond standing
    distro: str | None = None  # that the package is for, as `wsgen new` has recorded it


def read_settings(package: Path) -> tuple[Settings, tuple[Diagnostic, ...]]:
    """Read the settings of the package in a folder; the defaults where it has none."""
    file = package / FILE
    try:
        document = tomlfile.load(file)
    except FileNotFoundError:
        return Settings(file=file), ()
    except OSError as error:
        return Settings(file=file), (
            _lost(file, f"{FILE} cannot be read: {error.strerror}.", "Make it readable."),
        )
    except ValueError as error:
        return Settings(file=file), (
            _lost(file, f"{FILE} is not TOML: {error}.", "Fix it, or remove it."),
        )
    behaviors, found = _behaviors(document, file)
    settings = Settings(file=file, behaviors=behaviors, distro=_distro(document))
    found = (*_unknown(document, file), *found)
    allow = _allow(document)
    if allow is None:
        return settings, (
            *found,
            _wrong(
                file,
                "`allow` in [validate] is not a list of names.",
                'Write for example: allow = ["massless-root"]',
            ),
        )
    unknown = sorted(set(document.get("validate", {})) - {"allow"})
    return replace(settings, allow=allow), (
        *found,
        *(
            _wrong(file, f"[validate] knows no key `{key}`.", "It knows `allow`.")
            for key in unknown
        ),
    )


def _distro(document: dict[str, Any]) -> str | None:
    target = document.get("target")
    distro = target.get("distro") if isinstance(target, dict) else None
    return distro if isinstance(distro, str) else None


def _behaviors(
    document: dict[str, Any], file: Path
) -> tuple[tuple[Behavior, ...], tuple[Diagnostic, ...]]:
    """Most packages have none, and load nothing for them."""
    if "behavior" not in document:
        return (), ()
    from wsgen.workspace.behaviors import read_behaviors  # noqa: PLC0415

    return read_behaviors(document, file, file.read_text(encoding="utf-8"))


def _unknown(document: dict[str, Any], file: Path) -> Iterator[Diagnostic]:
    """What nobody reads is a mistake: a behavior that is misspelt would never be tried."""
    for key in document:
        if key not in KNOWN:
            yield _lost(file, f"{FILE} knows no key `{key}`.", suggest(key.lower(), KNOWN))


def _allow(document: dict[str, Any]) -> tuple[str, ...] | None:
    section = document.get("validate", {})
    names = section.get("allow", []) if isinstance(section, dict) else None
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        return None
    return tuple(names)


def _lost(file: Path, message: str, hint: str) -> Diagnostic:
    """Something that the package wants and does not get."""
    return Diagnostic(code="PKG060", severity=Severity.ERROR, message=message, file=file, hint=hint)


def _wrong(file: Path, message: str, hint: str) -> Diagnostic:
    return Diagnostic(
        code="PKG060", severity=Severity.WARNING, message=message, file=file, hint=hint
    )
