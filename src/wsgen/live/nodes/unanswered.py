"""What to say where nobody answers: `wsgen topic` and `wsgen node` find nothing, or a service.

ros2cli says nothing then. Its output, on stdout, stays as it is.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from wsgen.isolation.parent import is_held
from wsgen.text.suggestions import ask_for_nearest, some_of

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence


SECONDS = 1.0  # of the clock, after which somebody who waits hears for what
TOOL = "_ros2cli_"  # in the names of nodes of `wsgen topic` and its like, and of ros2cli
OWN_TOPICS = frozenset({"/rosout", "/parameter_events"})  # that each node has
SECONDS_TO_START = 15.0  # in which the nodes of a run may not be there yet
MOST_RUNS, MOST_TOPICS = 3, 8  # that are named


class Run(NamedTuple):
    """A live run on this machine."""

    domain: str
    launched: str  # what was launched: "PACKAGE FILE"
    drawn: str = ""  # the video that is still drawn of a run that has ended; empty: it goes on
    begun: float = 0.0  # seconds since 1970
    ended: str = ""  # the file that is in its folder, which is held until then, when it has ended

    def has_ended(self) -> bool:
        """Whether it has ended, perhaps since it was found; also where it was killed."""
        if self.drawn or not self.ended:
            return bool(self.drawn)
        file = Path(self.ended)
        return file.exists() or not file.parent.exists() or not is_held(str(file.parents[1]))


class Silence:
    """Says what is waited for, and why nothing comes: each once."""

    def __init__(self, node: Any, *, domain: str, runs: Sequence[Run], command: str) -> None:
        """Begin.

        Args:
            node: The node that listens.
            domain: Its ROS_DOMAIN_ID.
            runs: The live runs of this user.
            command: What the user has called, for a shell.
        """
        self._node = node
        self._domain = domain
        self._runs = runs
        self._command = command
        self._said: set[str] = set()

    @classmethod
    def of(cls, node: Any, request: Mapping[str, Any]) -> Silence:
        """That of a request; see `wsgen.cli.ros_tool`."""
        runs = [Run(*one) for one in request["runs"]]
        return cls(node, domain=request["domain"], runs=runs, command=request["command"])

    def say(self, text: str) -> None:
        """Write a text to stderr, once."""
        if text not in self._said:
            self._said.add(text)
            print(text, file=sys.stderr, flush=True)

    def is_alone(self) -> bool:
        """Whether no other node is found, but for tools like this one."""
        own = self._node.get_fully_qualified_name()
        found = self._node.get_node_names_and_namespaces()
        names = {f"{space.rstrip('/')}/{name}" for name, space in found}
        return all(name == own or name.startswith(f"/{TOOL}") for name in names)

    def expects_nodes(self) -> bool:
        """Whether no node is there, and those of a run in this domain are only starting."""
        return any(self._is_starting(run) for run in self._runs) and self.is_alone()

    def _is_starting(self, run: Run) -> bool:
        is_new = 0 <= time.time() - run.begun < SECONDS_TO_START  # clocks may be set back
        return is_new and run.domain == self._domain and not run.has_ended()

    def waits(self, what: str | None) -> None:
        """Say what is waited for; without a name, it is any node."""
        if self.is_alone():
            self.say(f"Waiting for nodes in ROS_DOMAIN_ID {self._domain} ...")
        elif what is not None:
            self.say(f"Waiting for {what} ...")

    def nothing_runs(self) -> str:
        """Why nobody is found, and the next step."""
        ended = [run for run in self._runs if run.has_ended()]
        going_on = [run for run in self._runs if run not in ended]
        here = [run for run in going_on if run.domain == self._domain]
        elsewhere = [run for run in going_on if run.domain != self._domain]
        lines = [f"No node is found in ROS_DOMAIN_ID {self._domain}."]
        starting = next(filter(self._is_starting, here), None)
        if starting is not None:
            lines.append(
                f"`{starting.launched}` has just been started, and its nodes are not there yet: "
                "start this command again in a few seconds."
            )
        elif here:
            lines.append(
                f"`{here[0].launched}` runs in this domain: start this command with the same "
                "ROS_AUTOMATIC_DISCOVERY_RANGE and RMW_IMPLEMENTATION."
            )
        lines += [
            f"`{run.launched}` has ended"
            + (f"; {run.drawn} is still being drawn of it." if run.drawn else ".")
            for run in ended
            if run.domain == self._domain
        ]
        lines += [
            f"`{run.launched}` runs in ROS_DOMAIN_ID {run.domain}. To see it: "
            f"ROS_DOMAIN_ID={run.domain} {self._command}"
            for run in elsewhere[:MOST_RUNS]
        ]
        if elsewhere[MOST_RUNS:]:
            lines.append(f"{len(elsewhere) - MOST_RUNS} more live runs have other domains.")
        if not going_on:
            lines.append("Start a launch file in another terminal: wsgen launch PACKAGE FILE --run")
        return "\n".join(lines)

    def say_nothing_comes(self, topic: str, kind: str) -> None:
        """Say why no message of a type has come on a topic."""
        publishers = self._node.get_publishers_info_by_topic(topic)
        types = sorted({one.topic_type for one in publishers})
        if self.is_alone():
            self.say(self.nothing_runs())
        elif not publishers:
            near = self._near(topic, "publishers", self._node.count_publishers)
            self.say(f"No node publishes on {topic}. {near}Waiting ...")
        elif kind not in types:
            self.say(f"{topic} has {', '.join(types)}, and not {kind}: nothing will come.")
        else:
            self.say(f"Nothing has come on {topic}; its publishers are there. Waiting ...")

    def say_nobody_takes(self, topic: str, kind: str) -> None:
        """Say why nobody takes the messages of a type on a topic."""
        subscriptions = self._node.get_subscriptions_info_by_topic(topic)
        types = sorted({one.topic_type for one in subscriptions})
        if self.is_alone():
            self.say(self.nothing_runs())
        elif not subscriptions:
            near = self._near(topic, "subscriptions", self._node.count_subscribers)
            self.say(f"No node subscribes to {topic}. {near}".rstrip())
        elif kind not in types:
            self.say(f"Those who subscribe to {topic} want {', '.join(types)}, and not {kind}.")
        else:
            self.say(f"Those who subscribe to {topic} have not been matched: compare the QoS.")

    def _near(self, topic: str, what: str, count: Callable[[str], int]) -> str:
        """Which topic may be meant, of those that have publishers or subscriptions."""
        names = [name for name, _ in self._node.get_topic_names_and_types()]
        known = [one for one in names if one not in OWN_TOPICS and one != topic and count(one)]
        listed = f"Topics with {what}: {some_of(sorted(known), MOST_TOPICS)}. " if known else ""
        return ask_for_nearest(topic, known) or listed


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
