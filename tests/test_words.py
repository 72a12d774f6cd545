"""Words that wsgen does not use in what a user reads, with those that roboticists use instead."""

import ast
import re
from collections.abc import Iterable, Iterator
from pathlib import Path

import click
import pytest

from wsgen.cli import COMMANDS, wsgen

ROOT = Path(__file__).parents[1]

# A pattern -> what to write instead.
WORDS = {
    r"findings?": "diagnostic",
    r"complaints?|complain(?:s|ed)?": "diagnostic, report",
    r"odd(?:ity|ities)": "diagnostic",
    r"flaw(?:s|ed)?": "error, diagnostic",
    r"mend(?:s|ed|ing)?": "fix",
    r"trials?": "simulation",
    r"judg(?:e|es|ed|ing|ement|ements|ment|ments)": "check",
    r"verdicts?": "result",
    r"films?": "video",
    r"studios?|exhibits?": "renderer",
    r"veil(?:s|ed)?": "transparent",
    r"limp|limbs?": "unactuated joints",
    r"nurser(?:y|ies)": "fork server",
    r"lifelines?": "parent-death pipe",
    r"mourn(?:s|ed)?": "report lost children",
    r"inhabitants?": "models of the world",
    r"sceneries|scenery": "static models",
    r"programmes?": "behaviors, plan",
    r"(?:mis)?behaviours?": "behavior",
    r"(?:dis)?colour(?:s|ed|ing|ful|less)?": "color",
    r"neighbours?|favours?|favourites?": "neighbor, favor",
    r"licences?": "license",
    r"grey(?:s|ed)?": "gray",
    r"(?:mis)?spelt|learnt": "misspelled, learned",
    r"born": "spawned, made",
    r"(?:centi|milli|kilo)?metres?|centres?|centred": "meter, center",
    r"(?:re)?cognised?|(?:normal|organ|initial|visual|optim)is(?:e|es|ed|ing|ation)": "-ize",
}
UNWANTED = re.compile(rf"(?<![\w/])(?:{'|'.join(WORDS)})\b", re.IGNORECASE)


def unwanted(text: str) -> Iterator[tuple[int, str]]:
    """Line, from 0, and what to write instead of a word there."""
    for found in UNWANTED.finditer(text):
        word = found.group()
        (instead,) = (
            better
            for pattern, better in WORDS.items()
            if re.fullmatch(pattern, word, re.IGNORECASE)
        )
        yield text.count("\n", 0, found.start()), f"{word!r}: write {instead}"


def texts(nodes: list[ast.AST]) -> Iterator[ast.Constant]:
    """What may reach the user of a module: sentences, names of rules, docstrings of commands.

    Args:
        nodes: Of its syntax tree. `test_sentences.py` reads those of all modules.
    """
    docstrings = set()
    for node in nodes:
        if isinstance(node, ast.Expr):
            docstrings.add(node.value)
        elif isinstance(node, ast.FunctionDef) and node.name == "command":
            yield from strings(ast.walk(node.body[0]))
        elif isinstance(node, ast.Call) and getattr(node.func, "id", "") == "Rule":
            names = (one.value for one in node.keywords if one.arg == "name")
            yield from strings(below for name in names for below in ast.walk(name))
    for text in strings(nodes):
        if text not in docstrings and " " in str(text.value):
            yield text


def strings(nodes: Iterable[ast.AST]) -> Iterator[ast.Constant]:
    """The string constants, those in f-strings included."""
    for node in nodes:
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node


def prose(page: str) -> str:
    """A page without what is code; the lines stay where they are."""
    block = re.compile("^```.*?^```", re.MULTILINE | re.DOTALL)
    page = block.sub(lambda code: "\n" * code.group().count("\n"), page)
    return re.sub(r"`[^`\n]*`|\]\([^)\n]*\)", "", page)


def report(places: list[str]) -> None:
    if places:
        pytest.fail("\n".join(places), pytrace=False)


def test_help() -> None:
    group = click.Context(wsgen, info_name="wsgen")
    pages = {"wsgen --help": wsgen.get_help(group)}
    for name in COMMANDS:
        command = wsgen.get_command(group, name)
        assert command is not None
        context = click.Context(command, info_name=name, parent=group)
        pages[f"wsgen {name} --help"] = command.get_help(context)
    report([f"{name}: {word}" for name, page in pages.items() for _, word in unwanted(page)])


def test_documentation() -> None:
    pages = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]
    report(
        [
            f"{page.relative_to(ROOT)}:{line + 1}: {word}"
            for page in pages
            for line, word in unwanted(prose(page.read_text(encoding="utf-8")))
        ]
    )


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (
            "A finding; colored, color, discoloured and Colours.",
            ["finding", "discoloured", "Colours"],
        ),
        ("judge\njudgment finds a limb, limping", ["judge", "judgment", "limb"]),
        ("dark_grey and a Licence, a license", ["Licence"]),
    ],
)
def test_what_is_unwanted(text: str, words: list[str]) -> None:
    assert [word.split("'")[1] for _, word in unwanted(text)] == words


def test_code_is_not_prose() -> None:
    page = "a `film`\n```\nfilm\n```\nfilm [text](film.md)\n"
    assert [line for line, _ in unwanted(prose(page))] == [4]


def test_which_texts_are_read() -> None:
    tree = ast.parse(
        '"""no"""\n'
        'RULE.at(f, message=f"a {x}", hint="b c" if y else "d e")\n'
        'raise RequestError("f g")\n'
        'Rule(name="h", code="NO001")\n'
        'TABLE = {"no": "i j"}\n'
        'def command():\n    """k l"""\n    "no"\n'
    )
    found = [str(text.value) for text in texts([*ast.walk(tree)])]
    assert sorted(found) == ["a ", "b c", "d e", "f g", "h", "i j", "k l"]
