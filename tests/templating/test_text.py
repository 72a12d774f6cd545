import sys
from xml.etree import ElementTree as ET

import pytest

from wsgen.errors import RequestError
from wsgen.templating.environment import markdown_message, markdown_text, toml_string, xml_text
from wsgen.templating.spec import check_description, check_maintainer_email, check_maintainer_name

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

ODD = [
    "a < b & c > d \"e\" 'f'",
    "]]> <!-- --> <![CDATA[ x",
    "${x} {{x}} {% raw %} {# x #} $(find y) @Z@ $ENV{HOME}",
    "back\\slash \\n \\u0041 %s",
    "first\nsecond\n\nthird\ttabbed",
    "🤖 👩‍🚀 e\u0301 ünï 机器人 עברית\u00a0x",
    "---\n# no heading | x | *y* `z` [a](b)",
]


@pytest.mark.parametrize("text", ODD)
def test_odd_text_survives(text: str) -> None:
    assert check_description(text) == text
    assert ET.fromstring(f"<a>{xml_text(text)}</a>").text == text
    assert tomllib.loads(f"a = {toml_string(text)}") == {"a": text}


@pytest.mark.parametrize(
    "text", ["\x00", "\x1b[31m", "a\x7f", "a\x85b", "a\u2028b", "\udcff", "\ufffe", "a\rb"]
)
def test_characters_that_xml_cannot_hold(text: str) -> None:
    with pytest.raises(RequestError, match=r"description contains the character U\+[0-9A-F]{4}"):
        check_description(f"x{text}y")
    with pytest.raises(RequestError, match=r"maintainer's name contains the character U\+"):
        check_maintainer_name(f"x{text}y")


def test_line_ends_of_windows_become_those_of_unix() -> None:
    assert check_description("a\r\nb\r\n") == "a\nb"


@pytest.mark.parametrize("text", ["", "  ", "\n\t\n"])
def test_empty_description(text: str) -> None:
    with pytest.raises(RequestError, match="description is empty"):
        check_description(text)


@pytest.mark.parametrize("name", ["Ada Lovelace", "O'Neill <x> & Söhne", "Ke$ha {{x}} @y@", "🤖"])
def test_good_maintainer_name(name: str) -> None:
    assert check_maintainer_name(f" {name} ") == name


@pytest.mark.parametrize("name", ['A "B" C', "A \\B", "A ${x}", "$ENV{HOME}", "$CACHE{x}"])
def test_maintainer_name_that_breaks_cmake(name: str) -> None:
    with pytest.raises(RequestError, match="CMake"):
        check_maintainer_name(name)


@pytest.mark.parametrize("name", ["", " ", "a\nb", "a\tb"])
def test_maintainer_name_of_one_line(name: str) -> None:
    with pytest.raises(RequestError, match="empty or has several lines"):
        check_maintainer_name(name)


@pytest.mark.parametrize("email", ["a@b.cd", "first.last+tag@mail.example.com", "x_%1@1-a.org"])
def test_good_email(email: str) -> None:
    assert check_maintainer_email(email) == email


@pytest.mark.parametrize(
    "email",
    [
        "",
        "a",
        "a@localhost",
        "a@b.c",
        "a@@b.cd",
        "ü@b.cd",
        "a b@c.de",
        "a@b.cd\n",
        "<a@b.cd>",
        "a@b.c1",
    ],
)
def test_bad_email(email: str) -> None:
    with pytest.raises(RequestError, match="not a valid e-mail address"):
        check_maintainer_email(email)


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("a robot's arm", "a robot's arm"),
        ("a\n  b", "a b"),
        ("# a | *b*", "\\# a \\| \\*b\\*"),
        ("- a", "\\- a"),
        ("1. a", "1\\. a"),
        ("2 robots", "2 robots"),
        ("<b> & c", "\\<b\\> \\& c"),
    ],
)
def test_markdown_shows_the_text_as_it_is(text: str, shown: str) -> None:
    assert markdown_text(text) == shown


def test_markdown_shows_a_message_with_its_names() -> None:
    message = "The mesh `my_leg.stl` of <leg_2>\nis *gone*."
    assert markdown_message(message) == r"The mesh `my_leg.stl` of \<leg\_2\> is \*gone\*."
