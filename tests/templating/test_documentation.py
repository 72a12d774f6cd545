"""The lists of docs/templates.md, docs/targets.md and docs/new.md are those of the code."""

import re
from pathlib import Path

import pytest

from golden_support import CASES
from wsgen.model import facts
from wsgen.model.target import SIMULATORS, TARGETS, Target
from wsgen.templating.sources import templates_folder
from wsgen.templating.spec import TYPES
from wsgen.templating.template import KEYS, VARIABLE_KEYS, template_names

ROOT = Path(__file__).parents[2]
TARGETS_HEAD = """# Targets

A target is a ROS 2 distribution with a simulator: `wsgen new --distro NAME --sim classic|gz`. This
page is written from `src/wsgen/model/facts.py`, which says of each fact where it comes from.
"""


def blocks_of_base() -> str:
    """A row for each source of `base` that has blocks."""
    folder = templates_folder() / "base"
    rows = []
    for file in sorted(folder.rglob("*.j2")):
        names = re.findall(r"{% block (\w+) ", file.read_text(encoding="utf-8"))
        if names:
            listed = ", ".join(f"`{name}`" for name in names)
            rows.append(f"| `wsgen:base/{file.relative_to(folder).as_posix()}` | {listed} |\n")
    return "| source | blocks |\n|---|---|\n" + "".join(rows)


def distributions() -> str:
    """A row for each fact, a column for each distribution."""
    lines = [
        f"| | {' | '.join(facts.DISTROS)} | source |\n",
        f"|---|{'---|' * len(facts.DISTROS)}---|\n",
    ]
    for fact, (source, *values) in facts.OF_DISTROS.items():
        cells = " | ".join(value or "-" for value in values)
        lines.append(f"| {fact.replace('_', ' ')} | {cells} | {source} |\n")
    classic = ["yes" if name in facts.RELEASED_FOR["gazebo_ros"] else "-" for name in facts.DISTROS]
    lines.append(f"| Gazebo Classic | {' | '.join(classic)} | ROSDISTRO |\n")
    return "".join(lines)


def plugins(simulator: str) -> str:
    """A row for each plugin of a simulator."""
    rows = [
        f"| `{role}` | `{filename}` | `{name}` | {source} |\n"
        for role, (source, filename, name) in facts.PLUGINS[simulator].items()
    ]
    return "| role | file name | name | source |\n|---|---|---|---|\n" + "".join(rows)


def programs(simulator: str) -> str:
    """A row for each program of a simulator."""
    rows = [
        f"| `{role}` | `{value}` | {source} |\n"
        for role, (source, value) in facts.PROGRAMS[simulator].items()
    ]
    return "| role | | source |\n|---|---|---|\n" + "".join(rows)


def targets_page() -> str:
    """The whole of docs/targets.md."""
    sources = "".join(f"- {key}: {place}\n" for key, place in facts.SOURCES.items())
    sections = [TARGETS_HEAD, f"## Distributions\n\n{distributions()}"]
    sections += [
        f"## {title}: plugins and programs\n\n{plugins(simulator)}\n{programs(simulator)}"
        for simulator, title in SIMULATORS.items()
    ]
    return "\n".join([*sections, f"## Sources\n\n{sources}"])


def target_table() -> str:
    """The table in docs/new.md."""

    def row(target: Target) -> str:
        until = target.end_of_life or "-"
        options = f"`--distro {target.distro} --sim {target.simulator}`"
        return f"| {options} | {target.ubuntu} | {target.gazebo} | {until} |\n"

    head = "| target | Ubuntu | simulator | updates until |\n|---|---|---|---|\n"
    return head + "".join(map(row, TARGETS))


def between(file: Path, name: str, content: str, *, regenerate: bool) -> None:
    """What stands between two marks of a page is this."""
    begin, end = f"<!-- {name} -->\n", f"<!-- {name} end -->\n"
    text = file.read_text(encoding="utf-8")
    before, _, rest = text.partition(begin)
    _, _, after = rest.partition(end)
    if regenerate:
        file.write_text(f"{before}{begin}{content}{end}{after}", encoding="utf-8")
    assert f"{begin}{content}{end}" in file.read_text(encoding="utf-8"), "pytest --regenerate"


def test_blocks(*, regenerate: bool) -> None:
    between(ROOT / "docs/templates.md", "blocks", blocks_of_base(), regenerate=regenerate)


def test_targets_of_new(*, regenerate: bool) -> None:
    between(ROOT / "docs/new.md", "targets", target_table(), regenerate=regenerate)


def test_targets_page(*, regenerate: bool) -> None:
    file = ROOT / "docs" / "targets.md"
    if regenerate:
        file.write_text(targets_page(), encoding="utf-8")
    assert file.read_text(encoding="utf-8") == targets_page(), "pytest --regenerate"


@pytest.mark.parametrize("word", [*KEYS, *VARIABLE_KEYS, *TYPES])
def test_every_key_and_type_is_documented(word: str) -> None:
    page = (ROOT / "docs" / "templates.md").read_text(encoding="utf-8")
    assert f"`{word}`" in page or f"`{word}.NAME`" in page


def test_what_the_page_says_of_targets_is_there() -> None:
    page = (ROOT / "docs" / "templates.md").read_text(encoding="utf-8")
    row = "".join(re.findall(r"^\| `package\.target\..*$", page, re.MULTILINE))
    for name in re.findall(r"`(?:package\.target)?\.([a-z0-9_]+)", row):
        if name not in {"filename", "name"}:
            assert hasattr(Target, name) or name in Target.__dataclass_fields__, name


def test_sources_that_can_be_included_are_there() -> None:
    page = (ROOT / "docs" / "templates.md").read_text(encoding="utf-8")
    named = set(re.findall(r"`wsgen:base/([\w./]+\.j2)`", page))
    assert named
    assert not [name for name in named if not (templates_folder() / "base" / name).is_file()]


@pytest.mark.parametrize("template", template_names())
def test_the_page_of_new_has_every_template(template: str) -> None:
    assert f"\n| `{template}` | " in (ROOT / "docs/new.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("template", ["simple", "diff_drive", "wanderer", "arm"])
def test_there_is_a_golden_for_every_target(template: str) -> None:
    assert {f"{template}-{target.name}" for target in TARGETS} <= set(CASES)


def test_the_index_has_every_page() -> None:
    index = (ROOT / "docs" / "README.md").read_text(encoding="utf-8")
    pages = {file.name for file in (ROOT / "docs").glob("*.md")} - {"README.md"}
    assert {name for name in pages if f"[{name}]({name})" not in index} == set()
