"""A template of the user in a folder, whole or with something wrong in it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.model.package import Maintainer, PackageSpec
from wsgen.model.target import DEFAULT_TARGET, Target
from wsgen.templating.spec import make_spec
from wsgen.templating.template import Template, load_template

if TYPE_CHECKING:
    from pathlib import Path


HEAD = 'schema = 1\nextends = "base"\ndescription = "A robot."\n'
FILES = '[files]\n"model/robot.xacro" = "robot.xacro.j2"\n'


def write_template(
    folder: Path, manifest: str = HEAD + FILES, *, robot: str = "<robot/>\n", **sources: str
) -> Path:
    """Write a template; `sources` are further files, with `__` for the point in their names."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "template.toml").write_text(manifest, encoding="utf-8")
    (folder / "robot.xacro.j2").write_text(robot, encoding="utf-8")
    for name, text in sources.items():
        (folder / name.replace("__", ".")).write_text(text, encoding="utf-8")
    return folder


def spec_for(
    template: Template, *settings: str, target: Target = DEFAULT_TARGET, name: str = "some_robot"
) -> PackageSpec:
    """A package of the template."""
    return make_spec(
        name,
        template=template,
        target=target,
        maintainer=Maintainer(name="Ada", email="ada@example.com"),
        license_name="MIT",
        settings=settings,
    )


def load(folder: Path) -> Template:
    """The template in a folder."""
    return load_template(str(folder))
