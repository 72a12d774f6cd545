"""What is to be done next, on narrow terminals."""

from __future__ import annotations

import shlex

import pytest

from wsgen.cli.terminal import _next_lines

RUN = (
    "Next: wsgen launch my_robot 'gazebo model.launch.py' --run --view --arg world:=a  "
    "(starts its nodes, too, without ROS; in another terminal while the run goes on)"
)


@pytest.mark.parametrize("width", [60, 40])
def test_a_command_stays_one(width: int) -> None:
    lines = list(_next_lines(RUN, width))
    assert all(len(line) <= width for line in lines)
    command, _, comment = "\n".join(lines).partition("(")
    joined = command.replace("\\\n", "")  # as a shell reads it
    assert shlex.split(joined) == shlex.split(RUN.partition("  (")[0])
    assert " ".join(comment.split()) == RUN.partition("(")[2]


def test_a_sentence_is_wrapped() -> None:
    line = "Next: fix the errors, or validate what is built: wsgen validate"
    assert list(_next_lines(line, 60)) == [
        "Next: fix the errors, or validate what is built: wsgen",
        "        validate",
    ]
    assert list(_next_lines(line, 80)) == [line]
