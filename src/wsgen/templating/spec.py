"""Make a PackageSpec from a request: check its names, answers, license and maintainer.

Text of users goes only into package.xml, wsgen.toml, README.md and the license. All other files get
checked names and numbers. A maintainer whom the request does not name is that of git, or the login.
"""

from __future__ import annotations

import math
import re
import string
from typing import TYPE_CHECKING, NamedTuple

from wsgen.errors import RequestError
from wsgen.model.package import Maintainer, PackageSpec, check_package_name, suggest_package_name
from wsgen.templating.sources import templates_folder
from wsgen.text.suggestions import ask_for_nearest
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from wsgen.model.package import Answer
    from wsgen.model.target import Target
    from wsgen.templating.template import Template


TYPES = ("number", "integer", "string", "boolean", "choice")
MAXIMUM_LENGTH = 100
# A text goes into XML, Python, YAML and TOML as it is, so none of these may be special there.
_TEXT = frozenset(f"{string.ascii_letters}{string.digits}_./+- ")
_TRUTHS = {"true": True, "1": True, "false": False, "0": False}


class Variable(NamedTuple):
    """What a user may set with `--set NAME=VALUE`.

    A named tuple: `wsgen new` pays for every dataclass that is defined.
    """

    name: str
    help: str
    type: str  # one of TYPES
    default: Answer
    unit: str = ""  # SI; empty where there is none
    minimum: float = -math.inf  # included; of a number or an integer
    maximum: float = math.inf  # included
    choices: tuple[str, ...] = ()  # of a choice

    def accepts(self, value: object) -> bool:
        """Whether a value has the variable's type and lies within its bounds."""
        if self.type == "boolean":
            return isinstance(value, bool)
        if self.type == "choice":
            return value in self.choices
        if self.type == "string":
            return isinstance(value, str) and _is_plain(value)
        kinds = (int,) if self.type == "integer" else (int, float)
        return (
            isinstance(value, kinds)
            and not isinstance(value, bool)
            and self.minimum <= value <= self.maximum  # not-a-number is not
        )

    @property
    def expected(self) -> str:
        """The values that it accepts; continues a sentence with "must be"."""
        if self.type == "boolean":
            return "true or false"
        if self.type == "choice":
            return f"one of {', '.join(self.choices)}"
        if self.type == "string":
            return (
                f"a text of up to {MAXIMUM_LENGTH} letters a to z, digits, single spaces and _./+-"
            )
        article = "an" if self.type == "integer" else "a"
        unit = f" {self.unit}" if self.unit else ""
        return f"{article} {self.type} from {self.minimum:g} to {self.maximum:g}{unit}"


def resolve_answers(
    variables: Mapping[str, Variable], settings: Iterable[str], template: str
) -> dict[str, Answer]:
    """Return the value of every variable: its default, or that of the last `NAME=VALUE` for it.

    Raises:
        RequestError: a variable is unknown, or a value has another type or is out of bounds.
    """
    answers: dict[str, Answer] = {name: one.default for name, one in variables.items()}
    for setting in settings:
        name, separator, text = setting.partition("=")
        if not separator or name not in variables:
            problem = f"template {template!r} has no variable {name!r}" if separator else "no '='"
            known = ", ".join(variables) or "none"
            raise RequestError(
                f"--set {setting}: {problem}.",
                hint=f"{ask_for_nearest(name, variables)}Write --set NAME=VALUE; variables: "
                f"{known}.",
            )
        answers[name] = _read(variables[name], text, setting)
    return answers


def _is_plain(text: str) -> bool:
    return len(text) <= MAXIMUM_LENGTH and _TEXT.issuperset(text) and " ".join(text.split()) == text


def show(value: Answer) -> str:
    """Format a value as a user types it."""
    if isinstance(value, bool):
        return "true" if value else "false"
    return f"{value:g}" if isinstance(value, float) else str(value)


def _read(variable: Variable, text: str, setting: str) -> Answer:
    value: Answer | None
    try:
        if variable.type == "boolean":
            value = _TRUTHS.get(text.lower())
        elif variable.type == "integer":
            value = int(text)
        elif variable.type == "number":
            value = float(text)
        else:
            value = text
    except ValueError:
        value = None
    if value is None or not variable.accepts(value):
        comma = "," in text and variable.type in {"number", "integer"}
        raise RequestError(
            f"--set {setting}: `{variable.name}` must be {variable.expected}.",
            hint=f"{'Replace the comma by a point. ' if comma else ''}"
            f"Write for example --set {variable.name}={show(variable.default)}",
        )
    return value


_FOLDER = "base/licenses"
_ENDING = ".txt.j2"
# First and last of each range of characters in XML 1.0, without the control characters and the line
# ends of Unicode that break TOML, Python or a terminal.
_USABLE = (
    ("\t", "\n"),
    (" ", "~"),
    ("\xa0", "\u2027"),
    ("\u202a", "\ud7ff"),
    ("\ue000", "\ufffd"),
    ("\U00010000", "\U0010ffff"),
)
# ament_cmake writes the maintainer into a quoted CMake string as it is.
_BREAKS_CMAKE = ('"', "\\", "${", "$ENV{", "$CACHE{")
# EmailType of package_common.xsd.
_EMAIL = lazy_pattern(
    r"[-\w%+]+(\.[-\w%+]+)*@[-a-z0-9%]+(\.[-a-z0-9%]+)*\.[a-z]{2,}", re.ASCII | re.IGNORECASE
)


def license_names() -> list[str]:
    """List the SPDX identifiers of the licenses that come with wsgen, sorted."""
    files = (templates_folder() / _FOLDER).glob(f"*{_ENDING}")
    return sorted(file.name.removesuffix(_ENDING) for file in files)


def find_license(name: str) -> str:
    """Return the SPDX identifier in its own spelling; case does not matter in `name`.

    Raises:
        RequestError: wsgen does not have the text of this license.
    """
    known = license_names()
    for license_name in known:
        if license_name.lower() == name.lower():
            return license_name
    raise RequestError(
        f"wsgen does not have the text of the license {name!r}.",
        hint=f"Use --license {' or '.join(known)}; for another one change the file LICENSE and the"
        " <license> of package.xml afterwards.",
    )


def make_spec(  # noqa: PLR0913  the words of the request, all by keyword
    name: str,
    *,
    template: Template,
    target: Target,
    maintainer: Maintainer,
    license_name: str,
    settings: Iterable[str] = (),
    description: str | None = None,
) -> PackageSpec:
    """Check the request and fill in what it leaves out.

    Raises:
        RequestError: for the first mistake, with a valid value.
    """
    check_target(template, target)
    answers = resolve_answers(template.variables, settings, template.name)
    dependencies = template.dependencies(target, answers)
    _check_name(name, dependencies)
    return PackageSpec(
        name=name,
        license=find_license(license_name),
        answers=answers,
        description=check_description(template.description if description is None else description),
        maintainer=maintainer,
        template=template.name,
        target=target,
        dependencies=dependencies,
    )


def check_target(template: Template, target: Target) -> None:
    """Refuse a target that a template is not made for.

    Raises:
        RequestError: it is not; names the nearest one.
    """
    if target not in template.targets:
        same = (one for one in template.targets if one.distro == target.distro)
        nearest = next(same, template.targets[-1])
        raise RequestError(
            f"Template {template.name!r} is not made for {target.ros} with {target.gazebo}.",
            hint=f"Use --distro {nearest.distro} --sim {nearest.simulator}; it is made for"
            f" {', '.join(one.name for one in template.targets)}.",
        )


def _check_name(name: str, dependencies: Mapping[str, tuple[str, ...]]) -> None:
    broken = check_package_name(name)
    if broken is not None:
        suggestion = suggest_package_name(name)
    elif any(name in needed for needed in dependencies.values()):
        broken = "is the name of a package that the new one depends on"
        suggestion = f"{name}_robot"
    else:
        return
    shown = name if len(name) <= 40 else f"{name[:40]}..."  # noqa: PLR2004  enough to know it
    raise RequestError(
        f"The package name {shown!r} {broken}.", hint=f"Use for example {suggestion}"
    )


def check_description(text: str) -> str:
    """Check a description of one or more lines, and strip it.

    Raises:
        RequestError: it is empty or has characters that package.xml cannot hold.
    """
    text = text.replace("\r\n", "\n").strip()
    if not text:
        raise RequestError(
            "The description is empty; package.xml requires one.",
            hint="Describe in a sentence what the package is for, or omit --description.",
        )
    _check_characters("description", text)
    return text


def check_maintainer_name(text: str) -> str:
    """Check a name on one line that package.xml and CMake can hold, and strip it.

    Raises:
        RequestError: it is invalid.
    """
    text = text.strip()
    if not text or "\n" in text or "\t" in text:
        raise RequestError(
            "The maintainer's name is empty or has several lines.",
            hint="Use --maintainer-name 'First Last'.",
        )
    _check_characters("maintainer's name", text)
    broken = [sign for sign in _BREAKS_CMAKE if sign in text]
    if broken:
        raise RequestError(
            f"The maintainer's name contains {broken[0]}, which breaks the string of CMake into"
            " which ament_cmake copies the name.",
            hint="Use a --maintainer-name without double quotes, backslashes and ${.",
        )
    return text


def check_maintainer_email(text: str) -> str:
    """Check an address against the schema of package.xml.

    Raises:
        RequestError: it is invalid.
    """
    if not _EMAIL.fullmatch(text):
        raise RequestError(
            f"{text!r} is not a valid e-mail address in package.xml.",
            hint="Use --maintainer-email name@example.com, in ASCII letters.",
        )
    return text


def _check_characters(what: str, text: str) -> None:
    for character in text:
        if not any(first <= character <= last for first, last in _USABLE):
            raise RequestError(
                f"The {what} contains the character U+{ord(character):04X}, which package.xml"
                " cannot hold.",
                hint="Remove it: control characters and bytes that are not UTF-8 are invalid.",
            )


def make_maintainer(name: str, email: str) -> Maintainer:
    """Check name and address.

    Raises:
        RequestError: one of them is not valid in package.xml.
    """
    return Maintainer(name=check_maintainer_name(name), email=check_maintainer_email(email))


# What `ros2 pkg create` writes for an unknown address.
UNKNOWN_DOMAIN = "todo.todo"
GIT_TIMEOUT = 5.0  # s; git answers in milliseconds unless its files lie on a dead network disk


def find_maintainer(name: str | None, email: str | None) -> Maintainer:
    """Return the given name and address, or else those of git, or else of the login.

    Values of git that package.xml cannot hold are ignored.

    Raises:
        RequestError: a given name or address is not valid in package.xml.
    """
    known = _ask_git()
    login = _login()
    if name is None:
        name = _usable(known.get("user.name"), check_maintainer_name) or login
    if email is None:
        email = _usable(known.get("user.email"), check_maintainer_email)
    return make_maintainer(name, email or f"{login}@{UNKNOWN_DOMAIN}")


def _usable(text: str | None, check: Callable[[str], str]) -> str | None:
    try:
        return None if text is None else check(text)
    except RequestError:
        return None


def _ask_git() -> Mapping[str, str]:
    """Read user.name and user.email with git itself, which knows its includes and scopes."""
    import subprocess  # noqa: PLC0415  who names the maintainer pays nothing

    command = ("git", "config", "--null", "--get-regexp", r"^user\.(name|email)$")
    try:
        answer = subprocess.run(  # noqa: PLW1510  1 means that nothing is set
            command, stdin=subprocess.DEVNULL, capture_output=True, timeout=GIT_TIMEOUT
        )
    except (OSError, subprocess.SubprocessError):
        return {}
    records = answer.stdout.decode("utf-8", "replace").split("\0")
    # A key, a line end, the value; of several values the last one counts.
    return dict(record.split("\n", 1) for record in records if "\n" in record)


def _login() -> str:
    """Return the login's name, without characters that are invalid before the @ of an address."""
    import getpass  # noqa: PLC0415  as above

    try:
        name = getpass.getuser()
    except (ImportError, KeyError, OSError):  # a container that runs under a number
        name = ""
    return re.sub(r"[^A-Za-z0-9_-]", "", name) or "user"
