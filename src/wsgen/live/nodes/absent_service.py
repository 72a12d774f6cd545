"""What to say of a service that cannot be called."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.text.suggestions import ask_for_nearest, some_of

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

MOST = 8  # services in a hint
# The last parts of the names of those that each node has for its parameters and its type hashes.
OF_EACH_NODE = frozenset(
    (
        *("describe_parameters", "get_parameter_types", "get_parameters", "list_parameters"),
        *("set_parameters", "set_parameters_atomically", "get_type_description"),
    )
)


def absent_service(name: str, wanted: str, offered: Mapping[str, Sequence[str]]) -> tuple[str, str]:
    """The message and the hint for a service that no node offers with a type.

    Args:
        name: Of the service.
        wanted: Its type.
        offered: The types of the services that nodes offer, by name.
    """
    name = name if name.startswith(("/", "~")) else f"/{name}"
    if name in offered:
        types = " and ".join(offered[name])
        return (
            f"The service {name} has the type {types}, and not {wanted}.",
            f'Call it with "{offered[name][0]}".',
        )
    own = {one for one in offered if one.rpartition("/")[2] not in OF_EACH_NODE}
    of_type = sorted(one for one in own if wanted in offered[one])
    if of_type:
        listed = f"Services of this type: {some_of(of_type, MOST)}."
    elif own:
        listed = f"No service has the type {wanted}. Services: {some_of(sorted(own), MOST)}."
    else:
        listed = "No node offers services: look whether the one that should has started."
    near = ask_for_nearest(name, of_type) or ask_for_nearest(name, own)
    return f"No node offers the service {name}.", f"{near}{listed}"
