"""What wsgen says is plain English: all messages, hints and help texts are read.

The sources are read, not what tests provoke: each alternative of a message counts.
"""

from __future__ import annotations

import ast
import re
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import click
import pytest

from test_words import texts, unwanted
from wsgen.cli import COMMANDS, wsgen

if TYPE_CHECKING:
    from collections.abc import Iterator

SOURCES = Path(__file__).parents[1] / "src" / "wsgen"
VALUE = "\0"  # in the place of what is filled in
MOST = 64  # alternatives of one text

# What nobody says -> how it is said.
PHRASES = {
    r"there (?:is|are|was|were|can be) (?:no|none|nothing)\b": "NAME does not exist, has no NAME",
    r"there (?:is|are) none\b": "none exists",
    r"(?:is|are|was|were|be) no (?!longer\b|more\b|less\b|larger\b|smaller\b|better\b)": "is not a",
    r"of (?:one's|its|their) own\b": "its own NAME",
    r"(?:reads?|knows?|names?|carries|gets?) no\b": "does not read any",
    r"(?:nobody|somebody|told|tells?)\b(?!@)": "name who or what does it",
}
UNPLAIN = re.compile(rf"(?<![\w/])(?:{'|'.join(f'({one})' for one in PHRASES)})", re.IGNORECASE)

# How hints begin. A verb that is missing here is added; what is not a verb is written otherwise.
IMPERATIVES = frozenset(
    re.findall(
        r"\w+",
        """
        Add Attach Begin Break Build Call Change Check Choose Clone Close Combine Commit Compute
        Connect Convert Copy Correct Create Deactivate Declare Define Delete Describe Divide
        Download End Expand Export Extend Fix Free Give Go Include Indent Install Keep Leave Let
        List Look Make Move Name Omit Port Publish Put Raise Read Record Reduce Remove Rename Repeat
        Replace Report Restore Rewrite Run Save Select Separate Set Simulate Source Spawn Start Swap
        Triangulate Try Turn Unpack Use Validate Wait Wrap Write
        """,
    )
)
PROGRAMS = frozenset(("chmod", "docker", "git", "pip", "python3", "ros2", "wsgen"))  # to be run
# Before the verb: a condition, or what it is done for.
BEFORE = re.compile(r"(?:If|In|For|To|Where|Without|With|On|Before|After)\b[^.]*?[,:] ")
NOTHING_TO_DO = ("No action is needed", "Did you mean ")


def unplain(text: str) -> Iterator[str]:
    """The phrases of a text that are written otherwise, with how."""
    for found in UNPLAIN.finditer(text):
        instead = list(PHRASES.values())[(found.lastindex or 1) - 1]
        yield f"{found.group()!r}: write {instead!r}, in: {text.replace(VALUE, '…')[:160]!r}"


def is_advice(hint: str) -> bool:
    """Whether a hint says what to do; one that begins with a value is not known to."""
    rest = BEFORE.sub("", hint.lstrip("\n`"), count=1)
    words = re.split(r"[\s:,]", rest, maxsplit=1)
    first = words[0]
    return (
        VALUE in first
        or first in PROGRAMS
        or first[:1].upper() + first[1:] in IMPERATIVES
        or hint.startswith(NOTHING_TO_DO)
    )


def is_ended(text: str) -> bool:
    """Whether a sentence ends: with a period, or after a colon with what to copy."""
    is_copied = ": " in text or "for example" in text or text.split(maxsplit=1)[0] in PROGRAMS
    return is_copied or text.rstrip()[-1:] in {".", "?", "…", "'", ">", VALUE}


def alternatives(node: ast.expr | None) -> list[str]:
    """The texts that an expression may be, with `VALUE` for each value; empty if it is unknown."""
    if isinstance(node, ast.Constant):
        return [node.value] if isinstance(node.value, str) else []
    if isinstance(node, ast.IfExp):
        return [text for one in (node.body, node.orelse) for text in alternatives(one) or [VALUE]]
    if isinstance(node, ast.BoolOp):
        return [text for one in node.values for text in alternatives(one) or [VALUE]]
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add):
        return _joined([node.left, node.right])
    if isinstance(node, ast.JoinedStr):
        return _joined(
            [one.value if isinstance(one, ast.FormattedValue) else one for one in node.values]
        )
    return []


def _joined(parts: list[ast.expr]) -> list[str]:
    texts = [""]
    for part in parts:
        texts = [text + more for text in texts for more in alternatives(part) or [VALUE]][:MOST]
    return texts


def said(nodes: list[ast.AST]) -> Iterator[tuple[int, str, str]]:
    """Line, kind and text of what a module says to users: "message", "hint", "help", "rule"."""
    for node in nodes:
        if isinstance(node, ast.Dict):
            pairs = [
                (key.value, value)
                for key, value in zip(node.keys, node.values, strict=True)
                if isinstance(key, ast.Constant) and key.value in {"message", "hint"}
            ]
        elif isinstance(node, ast.Call):
            pairs = list(_of_call(node))
        elif isinstance(node, ast.Assign):
            names = {getattr(one, "id", "") for one in node.targets}
            # A message may be continued.
            pairs = [({"hint": "hint"}.get(one, "part"), node.value) for one in names]
        else:
            continue
        for kind, value in pairs:
            for text in alternatives(value):
                if text.strip(VALUE + " "):
                    yield value.lineno, kind, text


KINDS = {"message": "message", "hint": "hint", "help": "help", "summary": "rule", "why": "rule"}


def _of_call(call: ast.Call) -> Iterator[tuple[str, ast.expr]]:
    name = getattr(call.func, "id", getattr(call.func, "attr", ""))
    if name == "Explanation":  # a rule, a message, a hint
        yield from zip(("message", "hint"), call.args[1:3], strict=False)
    if name.endswith("Error") or name in {"Refusal", "echo", "warn", "warning", "error", "info"}:
        yield from (("line", one) for one in call.args[:2])
    if name == "advice":  # which asks for the nearest name before it
        yield from (("hint", one) for one in call.args[2:3])
    if name == "add_argument":  # of programs that print what those of ROS and colcon print
        return
    is_rule = name == "Rule"
    for keyword in call.keywords:
        kind = KINDS.get(keyword.arg or "")
        if kind is not None and (kind != "rule" or is_rule):
            yield kind, keyword.value
        elif keyword.arg == "what" and is_rule:
            yield "rule", keyword.value


@cache
def all_said() -> list[tuple[str, str, str]]:
    """Place, kind and text of all that the sources say; "part" of what comes in other ways."""
    found = []
    for path in sorted(SOURCES.rglob("*.py")):
        nodes = [*ast.walk(ast.parse(path.read_text(encoding="utf-8")))]
        parts = ((text.lineno, "part", str(text.value)) for text in texts(nodes))
        for line, kind, text in (*said(nodes), *parts):
            found.append((f"{path.relative_to(SOURCES)}:{line}", kind, text))
    return found


def help_pages() -> Iterator[tuple[str, str]]:
    """The name and the text of each page of `--help`."""
    group = click.Context(wsgen, info_name="wsgen")
    yield "wsgen --help", wsgen.get_help(group)
    for name in COMMANDS:
        command = wsgen.get_command(group, name)
        assert command is not None
        context = click.Context(command, info_name=name, parent=group)
        yield f"wsgen {name} --help", command.get_help(context)
        if isinstance(command, click.Group):
            for verb in command.list_commands(context):
                below = command.get_command(context, verb)
                assert below is not None
                page = below.get_help(click.Context(below, info_name=verb, parent=context))
                yield f"wsgen {name} {verb} --help", page


def report(wrong: list[str]) -> None:
    if wrong:
        pytest.fail("\n".join(wrong), pytrace=False)


@pytest.mark.slow
def test_all_is_plain_english() -> None:
    wrong = {f"{place}: {one}" for place, _, text in all_said() for one in unplain(text)}
    report(sorted(wrong))


@pytest.mark.slow
def test_it_has_the_words_of_roboticists() -> None:
    wrong = {f"{place}: {word}" for place, _, text in all_said() for _, word in unwanted(text)}
    report(sorted(wrong))


def test_help_is_plain_english() -> None:
    pages = list(help_pages())
    assert len(pages) > len(COMMANDS)
    report([f"{name}: {one}" for name, page in pages for one in unplain(" ".join(page.split()))])


@pytest.mark.slow
def test_sentences_end() -> None:
    kinds = {"message", "hint", "help", "rule"}
    wrong = [
        f"{place}: no period after {text[-80:]!r}"
        for place, kind, text in all_said()
        if kind in kinds and text[:1].isupper() and " " in text and not is_ended(text)
    ]
    report(wrong)


@pytest.mark.slow
def test_hints_say_what_to_do() -> None:
    hints = [(place, text) for place, kind, text in all_said() if kind == "hint"]
    assert len(hints) > 500  # that they are found at all
    report([f"{place}: {text[:120]!r}" for place, text in hints if not is_advice(text)])


@pytest.mark.parametrize(
    ("text", "number"),
    [
        ("There is no file `a`, of which nobody was told.", 3),
        ("`a` is no Python; it reads no variable of its own.", 3),
        ("It is no longer here, has no link, and does not exist.", 0),
    ],
)
def test_what_is_not_plain(text: str, number: int) -> None:
    assert len(list(unplain(text))) == number


@pytest.mark.parametrize(
    ("hint", "is_one"),
    [
        ("Write `a`.", True),
        ("If it is right, write `a`.", True),
        ("Did you mean `a`?", True),
        ("wsgen build", True),
        ("The file is missing.", False),
        ("If that is so, nothing is done.", False),
    ],
)
def test_what_is_advice(hint: str, *, is_one: bool) -> None:
    assert is_advice(hint) is is_one


def test_what_is_read() -> None:
    tree = ast.parse(
        'RULE.at(f, message=f"a {x}." if y else "b", hint="c" + z)\n'
        "raise RequestError(f\"d {x if y else 'e'}\", hint=None)\n"
        'parser.add_argument("--x", help="m")\n'
        'Explanation(RULE, "f", "g")\n'
        'found = {"message": "h", "other": "i"}\n'
        'hint = "n"; other = "o"\n'
        'hint = advice(a, b, "p")\n'
        'Rule(what="j", name="k")\n'
        'call(what="l")\n'
    )
    assert sorted(
        (kind, text.replace(VALUE, "*")) for _, kind, text in said([*ast.walk(tree)])
    ) == [
        ("hint", "c*"),
        ("hint", "g"),
        ("hint", "n"),
        ("hint", "p"),
        ("line", "d *"),
        ("line", "d e"),
        ("message", "a *."),
        ("message", "b"),
        ("message", "f"),
        ("message", "h"),
        ("part", "o"),
        ("rule", "j"),
    ]
