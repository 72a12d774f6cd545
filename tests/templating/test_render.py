import ast
import re
import sys
from xml.etree import ElementTree as ET

import pytest

from golden_support import CASES
from wsgen import __version__
from wsgen.model.package import Maintainer
from wsgen.model.target import DEFAULT_TARGET
from wsgen.templating.render import RenderedTree, render_package
from wsgen.templating.spec import license_names, make_spec
from wsgen.templating.states import made_of
from wsgen.templating.template import load_template

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

ODD = '<a href="x"> & \'b\' ${x} {{x}} {% raw %} $(find y)\n# \\ 🤖 ]]> --> """'


def render(
    name: str = "some_robot", *, template_name: str = "simple", **words: object
) -> RenderedTree:
    template = load_template(template_name)
    request: dict[str, object] = {
        "template": template,
        "target": DEFAULT_TARGET,
        "maintainer": Maintainer(name="Ada Lovelace", email="ada@example.com"),
        "license_name": "MIT",
    }
    spec = make_spec(name, **(request | words))  # type: ignore[arg-type]
    return render_package(spec, template)


@pytest.mark.parametrize("case", CASES)
def test_texts_end_with_one_line_end(case: str) -> None:
    template_name, target = CASES[case]
    for path, text in render(template_name=template_name, target=target).items():
        assert text.endswith("\n"), path
        assert not text.endswith("\n\n"), path
        assert not re.search(r"\n\n\n(?!(?:class|def|if) |@)|\n{4}", text), path
        assert not [line for line in text.split("\n") if line != line.rstrip()], path


def test_odd_text_gives_valid_files() -> None:
    maintainer = Maintainer(name="A <b> & 'c' {{x}} $(y) 🤖", email="a@b.cd")
    tree = render(description=ODD, maintainer=maintainer)
    manifest = ET.fromstring(tree["package.xml"])
    assert manifest.findtext("description") == ODD
    assert manifest.findtext("maintainer") == maintainer.name
    recorded = tomllib.loads(tree["wsgen.toml"])["package"]
    assert recorded["description"] == ODD
    assert recorded["maintainer_name"] == maintainer.name
    assert f"Copyright (c) {maintainer.name}" in tree["LICENSE"]


def test_users_text_stays_out_of_code() -> None:
    plain = render()
    odd = render(description=ODD, maintainer=Maintainer(name="{{x}}", email="x@y.zz"))
    changed = {path for path in plain if plain[path] != odd[path]}
    assert changed == {"LICENSE", "README.md", "package.xml", "wsgen.toml"}


def test_wsgen_toml_records_how_the_package_was_made() -> None:
    tree = render(settings=["length=0.25"])
    assert tomllib.loads(tree["wsgen.toml"]) == {
        "schema": 1,
        "wsgen": __version__,
        "template": "simple",
        "state": made_of(load_template("simple"))["state"],
        "target": {"distro": "iron", "simulator": "classic"},
        "package": {
            "name": "some_robot",
            "description": "The tutorial's robot: a green cylinder that stands on the ground.",
            "license": "MIT",
            "maintainer_name": "Ada Lovelace",
            "maintainer_email": "ada@example.com",
        },
        "answers": {"length": 0.25, "radius": 0.4, "mass": 1.0},
        "validate": {"allow": ["massless-root"]},
    }


@pytest.mark.parametrize(("length", "height"), [("0.5", "0.3"), ("0.001", "0.0505"), ("3", "1.55")])
def test_the_robot_is_spawned_above_the_ground(length: str, height: str) -> None:
    launch = ast.parse(render(settings=[f"length={length}"])["launch/gazebo_model.launch.py"])
    defaults = {
        call.args[0].value: call.keywords[0].value.value
        for call in ast.walk(launch)
        if isinstance(call, ast.Call)
        and isinstance(call.func, ast.Name)
        and call.func.id == "DeclareLaunchArgument"
        and isinstance(call.args[0], ast.Constant)
        and isinstance(call.keywords[0].value, ast.Constant)
    }
    assert defaults == {
        "x": "0.0",
        "y": "0.0",
        "z": height,
        "gui": "true",
        "use_sim_time": "true",
    }


def test_answers_are_xacro_arguments() -> None:
    robot = ET.fromstring(render(settings=["mass=2.5", "radius=0.01"])["model/robot.xacro"])
    xacro = "{http://www.ros.org/wiki/xacro}"
    arguments = {
        element.get("name"): element.get("default") for element in robot.iter(f"{xacro}arg")
    }
    assert arguments == {"length": "0.5", "radius": "0.01", "mass": "2.5"}
    assert {element.get("name") for element in robot.iter(f"{xacro}property")} == set(arguments)


@pytest.mark.parametrize("name", license_names())
def test_license_text(name: str) -> None:
    tree = render(license_name=name)
    assert ET.fromstring(tree["package.xml"]).findtext("license") == name
    assert ("Ada Lovelace" in tree["LICENSE"]) == (name != "Apache-2.0")
    assert len(tree["LICENSE"]) > 1000


@pytest.mark.parametrize("case", CASES)
def test_the_readme_names_every_file_but_the_obvious_ones(case: str) -> None:
    template_name, target = CASES[case]
    tree = render(template_name=template_name, target=target)
    for path in set(tree) - {"README.md"}:
        assert f"`{path}`" in tree["README.md"]


def test_rendering_is_the_same_from_compiled_templates(
    tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch
) -> None:
    cache = tmp_path_factory.mktemp("cache")
    monkeypatch.setenv("XDG_CACHE_HOME", str(cache))
    from_source = render()
    (compiled,) = (cache / "wsgen").iterdir()
    written = compiled.stat().st_mtime_ns
    assert render() == from_source
    assert compiled.stat().st_mtime_ns == written
