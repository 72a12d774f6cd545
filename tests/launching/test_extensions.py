"""Tags and substitutions that installed packages add to XML and YAML."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from install_space import InstallSpace

PACKAGE = """
from typing import List, Optional
from launch.action import Action
from launch.frontend import Entity, Parser, expose_action, expose_substitution
from launch.some_substitutions_type import SomeSubstitutionsType
from launch.substitution import Substitution
from launch.utilities import normalize_to_list_of_substitutions, perform_substitutions
from launch_ros.actions import Node


@expose_action('wheel')
class Wheel(Node):
    def __init__(self, *, radius, sides, **kwargs):
        super().__init__(package='pkg_a', executable='e', arguments=[str(radius), *sides], **kwargs)

    @classmethod
    def parse(cls, entity: Entity, parser: Parser):
        entity.get_attr('exec', optional=True)
        _, kwargs = Action.parse(entity, parser)
        kwargs['radius'] = entity.get_attr('radius', data_type=float)
        kwargs['name'] = parser.parse_substitution(entity.get_attr('name'))
        sides = entity.get_attr('side', data_type=List[Entity], optional=True) or []
        kwargs['sides'] = [parser.parse_substitution(side.get_attr('of')) for side in sides]
        for side in sides:
            side.assert_entity_completely_parsed()
        return cls, kwargs


@expose_action('named')
class Named(Node):
    @classmethod
    def parse(cls, entity: Entity, parser: Parser):
        _, kwargs = super().parse(entity, parser)
        kwargs['arguments'] = [kwargs['name']]
        return cls, kwargs


@expose_action('both')
def both(entity: Entity, parser: Parser):
    from launch.actions import GroupAction
    return GroupAction, {'actions': [parser.parse_action(child) for child in entity.children]}


@expose_substitution('twice')
class Twice(Substitution):
    def __init__(self, what: SomeSubstitutionsType) -> None:
        super().__init__()
        self.what = normalize_to_list_of_substitutions(what)

    @classmethod
    def parse(cls, data):
        return cls, {'what': data[0]}

    def perform(self, context):
        return 2 * perform_substitutions(context, self.what)
"""
METADATA = "Metadata-Version: 2.1\nName: wheels\nVersion: 1\n"


@pytest.fixture
def environment(space: InstallSpace, tmp_path: Path) -> Mapping[str, str]:
    modules = tmp_path / "python"
    files = {
        "wheels/__init__.py": PACKAGE,
        "broken/__init__.py": "import nowhere_to_be_found",
        "wheels-1.dist-info/METADATA": METADATA,
        "wheels-1.dist-info/entry_points.txt": (
            "[launch.frontend.launch_extension]\nbroken = broken\nwheels = wheels\n"
        ),
    }
    for name, text in files.items():
        modules.joinpath(name).parent.mkdir(parents=True, exist_ok=True)
        modules.joinpath(name).write_text(text, encoding="utf-8")
    space.add("pkg_a")
    space.add_program("pkg_a", "e")
    return {"PYTHONPATH": str(modules)}


@pytest.mark.slow
def test_tags_and_substitutions_of_a_package(
    space: InstallSpace, environment: Mapping[str, str]
) -> None:
    text = """<launch><arg name="side" default="left"/>
    <both>
      <wheel radius="0.5" name="$(twice ab)"><side of="$(var side)"/><side of="right"/></wheel>
      <wheel radius="1" name="c" if="false"/>
    </both>
    <named pkg="pkg_a" exec="e" name="n"/></launch>"""
    share = space.add("my_robot", {"a.launch.xml": text})
    plan = space.evaluate(share / "a.launch.xml", environment=environment)
    assert not plan.diagnostics
    assert [(one.name, one.arguments, one.line) for one in plan.processes] == [
        ("abab", ("0.5", "left", "right"), 3),
        ("n", ("n",), 6),
    ]
    assert [one.what for one in plan.unresolved] == ["broken"]


@pytest.mark.slow
def test_tags_of_a_package_in_yaml(space: InstallSpace, environment: Mapping[str, str]) -> None:
    text = "launch:\n- wheel: {radius: 0.5, name: w, side: [{of: left}]}\n"
    share = space.add("my_robot", {"a.launch.yaml": text})
    plan = space.evaluate(share / "a.launch.yaml", environment=environment)
    assert not plan.diagnostics
    assert plan.processes[0].arguments == ("0.5", "left")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("element", "message"),
    [
        ('<wheel name="w"/>', "Attribute 'radius' of type '<class 'float'>' not found"),
        ('<wheel name="w" radius="1" color="red"/>', "Unexpected attribute(s) found in `wheel`"),
        ('<weel name="w"/>', "Unrecognized entity of the type: weel"),
    ],
)
def test_what_a_package_does_not_take(
    space: InstallSpace, environment: Mapping[str, str], element: str, message: str
) -> None:
    share = space.add("my_robot", {"a.launch.xml": f"<launch>{element}</launch>"})
    (diagnostic,) = space.evaluate(share / "a.launch.xml", environment=environment).diagnostics
    assert message in diagnostic.message
