"""What the commands load: start-up is guarded by modules, not by a clock."""

import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = """
import sys
from wsgen.cli import run
code = run({arguments!r})
print("\\n".join(["<modules>", *sys.modules]))
sys.exit(code)
"""

# Each of these costs more than the work of `wsgen new`.
HEAVY = {
    "rich",
    "lxml",
    "xacro",
    "yaml",
    "numpy",
    "pybullet",
    "PIL",
    "colcon_core",
    "catkin_pkg",
    "importlib.metadata",
    "subprocess",
    "asyncio",
    "email",
    "http",
    "urllib.request",
    "argparse",
    "logging",
    "difflib",
}


def of_libraries(*names: str) -> set[str]:
    """What importing these libraries loads by itself, on this Python."""
    script = f"import sys, {', '.join(names)}; print(*sys.modules)"
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    return set(run.stdout.split())


def loaded(folder: Path, *arguments: str, expect: int = 0) -> set[str]:
    """The modules that a command leaves loaded."""
    run = subprocess.run(
        [sys.executable, "-c", SCRIPT.format(arguments=list(arguments))],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == expect, run.stderr
    return set(run.stdout.split("<modules>\n")[1].split())


def test_help_loads_the_table_of_commands_alone(tmp_path: Path) -> None:
    modules = loaded(tmp_path, "--help")
    assert {name for name in modules if name.startswith("wsgen")} == {
        "wsgen",
        "wsgen.cli",
        "wsgen.errors",
    }
    assert not modules & (HEAVY | {"jinja2", "dataclasses", "json"}) - of_libraries("click")


def rooms(modules: set[str]) -> set[str]:
    """The parts of wsgen that modules are in."""
    parts = [name.split(".")[1:] for name in modules if name.startswith("wsgen.")]
    inside = ("packages", "ros", "text")
    return {
        ".".join(one[:2]) if one[0] in inside else one[0]
        for one in parts
        if one[0] not in inside or len(one) > 1
    }


@pytest.mark.slow
def test_new_loads_what_it_renders_with(tmp_path: Path) -> None:
    modules = loaded(
        tmp_path, "new", "some_robot", "--maintainer-name", "A", "--maintainer-email", "a@b.cd"
    )
    packages = rooms(modules)
    assert packages <= {
        "cli",
        "diagnostics",
        "errors",
        "model",
        "packages.workspace",
        "pipeline",  # `create` alone
        "ros.names",  # whether ROS has the name
        "templating",
        "text.files",
        "text.printable",
        "text.suggestions",
        "text.tomlfile",
        "text.values",
        "text.xmlsyntax",
    }
    assert not modules & HEAVY - of_libraries("click", "jinja2")
    assert {name for name in modules if name.startswith("wsgen.model.")} <= {
        "wsgen.model.facts",
        "wsgen.model.package",
        "wsgen.model.target",
    }


@pytest.mark.slow
def test_doctor_loads_no_library_but_what_draws_its_table(tmp_path: Path) -> None:
    modules = loaded(tmp_path, "doctor")
    packages = rooms(modules)
    assert packages <= {
        "building",
        "cli",
        "diagnostics",
        "errors",
        "isolation",  # a child draws a picture
        "model",
        "packages.workspace",
        "ros.environment",  # what is sourced
        "text.files",
        "text.printable",
        "text.suggestions",
        "text.values",
        "text.xmlsyntax",
        "text.xmltree",
    }
    drawing = of_libraries("rich.console", "rich.table", "rich.ansi")
    assert not modules & (HEAVY | {"jinja2", "cmake", "dartpy", "av", "shapely", "trimesh"}) - (
        of_libraries("click", "platform", "subprocess", "tempfile") | drawing
    )


@pytest.mark.slow
def test_build_loads_no_simulator(tmp_path: Path) -> None:
    modules = loaded(tmp_path, "build", "--help")
    assert not modules & HEAVY - of_libraries("click")


@pytest.mark.slow
def test_validate_leaves_engine_and_xacro_to_its_children(tmp_path: Path) -> None:
    """A package without a launch file comes as far as loading all stages."""
    (tmp_path / "src" / "p").mkdir(parents=True)
    (tmp_path / "src" / "p" / "package.xml").write_text("<package><name>p</name></package>")
    modules = loaded(tmp_path, "validate", expect=0)
    assert "wsgen.pipeline" in modules
    assert not modules & {"rich", "numpy", "pybullet", "PIL", "xacro", "colcon_core", "catkin_pkg"}
    assert not modules & {"jinja2", "asyncio", "logging", "wsgen.launching.worker"}
