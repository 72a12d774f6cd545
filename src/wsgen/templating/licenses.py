"""The licences whose texts come with wsgen."""

from __future__ import annotations

from wsgen.errors import RequestError
from wsgen.templating.location import templates_folder

_FOLDER = "base/licenses"
_ENDING = ".txt.j2"


def license_names() -> list[str]:
    """SPDX identifiers, sorted."""
    files = (templates_folder() / _FOLDER).glob(f"*{_ENDING}")
    return sorted(file.name.removesuffix(_ENDING) for file in files)


def find_license(name: str) -> str:
    """The SPDX identifier in its own spelling; capitals do not matter in `name`.

    Raises:
        RequestError: no text of such a licence is here.
    """
    known = license_names()
    for license_name in known:
        if license_name.lower() == name.lower():
            return license_name
    raise RequestError(
        f"wsgen has no text of a licence {name!r}.",
        hint=f"Take --license {' or '.join(known)}; for another one change the file LICENSE and the"
        " <license> of package.xml afterwards.",
    )
