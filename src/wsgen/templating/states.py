"""What `wsgen.toml` says of the templates that a package was made of; see `history`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.templating.sources import is_past

if TYPE_CHECKING:
    from wsgen.templating.template import Template


FACTS = "facts"
STATES_FILE = Path(__file__).with_name("states.txt")  # of the folders of templates, now


def made_of(template: Template) -> dict[str, str]:
    """The states of the folders that a template is made of; nothing if it cannot be updated.

    A template of the user may name any source of wsgen.
    """
    if is_past() or (template.is_shipped and template.is_abstract):
        return {}
    states = STATES_FILE.read_text(encoding="utf-8").split()
    names = {*template.shipped, FACTS}
    wanted = [one for one in states if not template.is_shipped or one.rpartition("-")[0] in names]
    return {"state": " ".join(wanted)}
