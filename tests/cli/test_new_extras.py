"""What `wsgen new` writes into the workspace: .gitignore, and workflows with --ci."""

import errno
import json
import os
import re
import shlex
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import click
import pytest
import yaml

from wsgen import __version__
from wsgen.cli import CommandTable, run
from wsgen.cli import wsgen as group
from wsgen.model.target import TARGETS, Target, choose_target
from wsgen.templating.render import WORKFLOWS, render_workflow

SERVICES = {"github": ".github/workflows/wsgen.yml", "gitlab": ".gitlab-ci.yml"}
GIVEN = ("--maintainer-name", "Ada", "--maintainer-email", "ada@example.com")
# Programs that a workflow may call: those of the images, beside wsgen.
PROGRAMS = {"python", "mkdir", "apt-get", "rosdep", "source", "colcon", "wsgen"}
# https://docs.github.com/actions/reference/workflows-and-actions/workflow-syntax
GITHUB_JOB = {
    "name",
    "runs-on",
    "timeout-minutes",
    "strategy",
    "container",
    "env",
    "defaults",
    "steps",
}
# https://docs.gitlab.com/ci/yaml
GITLAB_JOB = {"image", "timeout", "parallel", "script", "artifacts", "variables"}
ROOT_IS_SPECIAL = pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty current folder, and no ROS."""
    monkeypatch.delenv("ROS_DISTRO", raising=False)
    folder = tmp_path / "here"
    folder.mkdir()
    monkeypatch.chdir(folder)
    return folder


def new(*arguments: str) -> int:
    return run(["new", *arguments, *GIVEN])


def texts(folder: Path) -> dict[str, str]:
    return {
        path.relative_to(folder).as_posix(): path.read_text(encoding="utf-8")
        for path in folder.rglob("*")
        if path.is_file()
    }


def workflow(service: str, target: Target) -> Any:
    """As the service reads it; YAML 1.1 takes the key `on` for a truth value."""
    (text,) = render_workflow(service, target).values()
    return yaml.safe_load(re.sub(r"^on:", '"on":', text, flags=re.MULTILINE))


def commands(service: str, target: Target) -> Iterator[list[str]]:
    """The words of every command of a workflow."""
    document = workflow(service, target)
    if service == "github":
        jobs = document["jobs"].values()
        lines = [step["run"] for job in jobs for step in job["steps"] if "run" in step]
    else:
        lines = [line for job in document.values() for line in job["script"]]
    for line in filter(None, "\n".join(lines).splitlines()):
        for command in line.split("&&"):
            yield shlex.split(command)


@pytest.mark.parametrize("service", SERVICES)
@pytest.mark.parametrize("target", TARGETS, ids=lambda target: target.name)
class TestEveryWorkflow:
    def test_the_text(self, service: str, target: Target) -> None:
        ((path, text),) = render_workflow(service, target).items()
        assert path == SERVICES[service]
        assert text.endswith("\n")
        for line in text.splitlines():
            assert "\t" not in line
            assert line == line.rstrip()
            assert len(line) <= 110
            assert "{%" not in line
            assert re.findall(r"\$\{\{ .+? \}\}|\$?\{\{", line).count("{{") == 0

    def test_wsgen_knows_its_commands(self, service: str, target: Target) -> None:
        """click takes every word of them; nothing is run."""
        called = [words[1:] for words in commands(service, target) if words[0] == "wsgen"]
        assert [words[0] for words in called] == ["check", "build", "validate"]
        assert isinstance(group, CommandTable)
        for name, *arguments in called:
            command = group.get_command(click.Context(group), name)
            assert command is not None
            given = command.make_context(name, _before_redirection(arguments)).params
            assert name != "check" or given["output_format"] in {"github", "junit"}
            if name == "validate":
                assert given["json_file"].startswith(f"{given['picture']}/")
                assert given["junit_file"].startswith(f"{given['picture']}/")
            if service == "github" and name != "build":
                assert given["output_format"] == "github"
                assert given["summary_file"] == "$GITHUB_STEP_SUMMARY"

    def test_only_programs_that_are_there(self, service: str, target: Target) -> None:
        assert {words[0] for words in commands(service, target)} == PROGRAMS

    def test_the_ros_of_the_target(self, service: str, target: Target) -> None:
        (text,) = render_workflow(service, target).values()
        assert f"ros:{target.distro}-ros-base" in text
        assert f"source /opt/ros/{target.distro}/setup.bash" in text
        words = list(commands(service, target))
        (update,) = (one for one in words if one[:2] == ["rosdep", "update"])
        assert ("--include-eol-distros" in update) == (target.distro == "iron")
        assert ["colcon", "build"] in words
        # `colcon test` itself ends with 0 whatever the tests say.
        assert words.index(["colcon", "test"]) < words.index(["colcon", "test-result", "--verbose"])

    def test_the_pythons(self, service: str, target: Target) -> None:
        document = workflow(service, target)
        if service == "github":
            versions = document["jobs"]["wsgen"]["strategy"]["matrix"]["python"]
        else:
            versions = document["wsgen"]["parallel"]["matrix"][0]["PYTHON"]
        assert target.fact("python") in versions
        assert "3.13" in versions
        # As numbers 3.10 would be 3.1.
        assert all(isinstance(version, str) for version in versions)
        assert versions == sorted(versions)


def _before_redirection(words: list[str]) -> list[str]:
    return words[: words.index(">")] if ">" in words else words


def test_the_keys_of_github() -> None:
    document = workflow("github", choose_target("iron"))
    assert set(document) == {"name", "on", "permissions", "jobs"}
    assert document["on"] == {"push": None, "pull_request": None}
    assert document["permissions"] == {"contents": "read"}
    for job in document["jobs"].values():
        assert set(job) <= GITHUB_JOB
        assert {"runs-on", "steps", "timeout-minutes"} <= set(job)
        for step in job["steps"]:
            assert ("uses" in step) != ("run" in step)
            assert set(step) <= {"name", "uses", "with", "run", "if"}
            assert re.fullmatch(r"actions/[a-z-]+@v\d+", step.get("uses", "actions/checkout@v6"))
    upload = document["jobs"]["wsgen"]["steps"][-1]
    assert upload["if"] == "always()"
    assert upload["with"]["path"] == "wsgen-results"
    assert "${{ matrix.python }}" in upload["with"]["name"]  # names of artefacts are unique


def test_the_keys_of_gitlab() -> None:
    document = workflow("gitlab", choose_target("iron"))
    for job in document.values():
        assert set(job) <= GITLAB_JOB
        assert all(isinstance(line, str) for line in job["script"])
    assert document["wsgen"]["artifacts"] == {
        "when": "always",
        "paths": ["wsgen-results/"],
        "reports": {"junit": "wsgen-results/*.xml"},
    }
    assert set(document["ros"]["artifacts"]) == {"when", "reports"}


def test_every_service_has_a_source() -> None:
    assert {service: path for service, (path, _) in WORKFLOWS.items()} == SERVICES


@pytest.mark.parametrize(("service", "path"), SERVICES.items())
def test_new_workspace(
    here: Path, service: str, path: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert new("some_robot", "--ci", service) == 0
    written = texts(here / "ws_gazebo")
    assert f"wsgen>={__version__}" in written[path]
    assert f"Wrote ws_gazebo/{path}\n" in capsys.readouterr().out
    assert {name for name in written if not name.startswith("src/")} == {".gitignore", path}


@pytest.mark.slow
def test_the_second_package_keeps_the_workflow(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert new("some_robot", "--ci", "github") == 0
    before = texts(here)
    capsys.readouterr()
    assert new("other_robot", "-w", "ws_gazebo", "--ci", "github") == 3
    assert texts(here) == before
    output = capsys.readouterr()
    assert output.out == ""
    assert "wsgen.yml already exists; nothing was written." in output.err
    assert "Omit --ci" in output.err
    assert new("other_robot", "-w", "ws_gazebo", "--ci", "github", "--dry-run") == 3
    assert new("other_robot", "-w", "ws_gazebo", "--ci", "gitlab") == 0
    assert (here / "ws_gazebo" / ".gitlab-ci.yml").is_file()


def test_dry_run(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert new("some_robot", "--ci", "gitlab", "--dry-run") == 0
    assert not list(here.iterdir())
    lines = capsys.readouterr().out.splitlines()
    assert str(here / "ws_gazebo" / ".gitlab-ci.yml") in lines
    assert str(here / "ws_gazebo" / ".gitignore") in lines


def test_json(capsys: pytest.CaptureFixture[str]) -> None:
    assert new("some_robot", "--ci", "gitlab", "--format", "json") == 0
    output = json.loads(capsys.readouterr().out)
    assert output["workspace_files"] == [".gitignore", ".gitlab-ci.yml"]


def test_a_service_that_is_not_known(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert new("some_robot", "--ci", "jenkins") == 2
    assert "'jenkins' is not one of 'github', 'gitlab'" in capsys.readouterr().err
    assert not list(here.iterdir())


@pytest.mark.parametrize("folder", [".github", ".github/workflows"])
def test_a_link_leads_out_of_the_workspace(
    here: Path, folder: str, capsys: pytest.CaptureFixture[str]
) -> None:
    (here / "elsewhere" / "workflows").mkdir(parents=True)
    link = here / "ws" / folder
    link.parent.mkdir(parents=True)
    link.symlink_to(here / "elsewhere")
    assert new("some_robot", "-w", "ws", "--ci", "github") == 4
    assert f"{link} is a link; nothing was written." in capsys.readouterr().err
    assert texts(here) == {}
    assert not (here / "ws" / "src").exists()


@pytest.mark.parametrize("target", ["elsewhere", "nowhere"])
def test_a_link_in_the_place_of_the_file(here: Path, target: str) -> None:
    (here / "elsewhere").write_text("mine")
    (here / "ws").mkdir()
    (here / "ws" / ".gitlab-ci.yml").symlink_to(here / target)
    assert new("some_robot", "-w", "ws", "--ci", "gitlab") == 3
    assert [path.name for path in (here / "ws").iterdir()] == [".gitlab-ci.yml"]
    assert (here / "elsewhere").read_text() == "mine"
    assert not (here / "nowhere").exists()


def test_a_file_in_the_place_of_a_folder(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (here / "ws").mkdir()
    (here / "ws" / ".github").write_text("mine")
    assert new("some_robot", "-w", "ws", "--ci", "github") == 4
    assert "Not a directory" in capsys.readouterr().err
    assert texts(here) == {"ws/.github": "mine"}


@ROOT_IS_SPECIAL
def test_a_folder_that_is_read_only(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (here / "ws" / "src").mkdir(parents=True)
    (here / "ws").chmod(0o555)
    try:
        assert new("some_robot", "-w", "ws", "--ci", "github") == 4
        assert "Permission denied" in capsys.readouterr().err
        assert texts(here) == {}
    finally:
        (here / "ws").chmod(0o755)


def test_a_disk_that_is_read_only(
    here: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def refuse(*_: object) -> None:
        raise OSError(errno.EROFS, os.strerror(errno.EROFS), str(here / "ws"))

    monkeypatch.setattr(os, "link", refuse)
    assert new("some_robot", "-w", "ws", "--ci", "github") == 4
    assert "mounted read-only" in capsys.readouterr().err
    assert not list(here.iterdir())


@pytest.mark.slow
def test_the_workspace_is_no_repository_of_its_own(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (here / ".git").mkdir()
    assert new("some_robot", "-w", "robots/ws", "--ci", "github") == 0
    assert f"top of the repository, {here}." in capsys.readouterr().err
    (here / "robots" / "ws" / ".git").mkdir()
    assert new("other_robot", "-w", "robots/ws", "--ci", "gitlab") == 0
    assert "top of the repository" not in capsys.readouterr().err


def test_what_git_ignores(here: Path) -> None:
    assert new("some_robot") == 0
    workspace = here / "ws_gazebo"
    for folder in ("build/some_robot", "install", "log", "src/some_robot/log"):
        (workspace / folder).mkdir(parents=True)
        (workspace / folder / "file").touch()
    subprocess.run(["git", "init", "-q"], cwd=workspace, check=True)
    run_ = subprocess.run(
        ["git", "ls-files", "--others", "--exclude-standard"],
        cwd=workspace,
        check=True,
        capture_output=True,
        text=True,
    )
    listed = run_.stdout.split()
    assert "src/some_robot/log/file" in listed  # a package's own folder of that name
    assert not [name for name in listed if name.startswith(("build/", "install/", "log/"))]
    assert ".gitignore" in listed


def test_a_gitignore_that_is_there_stays(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (here / "ws").mkdir()
    (here / "ws" / ".gitignore").write_text("mine\n")
    assert new("some_robot", "-w", "ws", "--distro", "jazzy", "-v") == 0
    assert (here / "ws" / ".gitignore").read_text() == "mine\n"
    assert capsys.readouterr().err == "note: ws/.gitignore already exists and is not changed.\n"


def test_a_workspace_that_is_there_gets_none(here: Path) -> None:
    (here / "ws" / "src").mkdir(parents=True)
    assert new("some_robot", "-w", "ws") == 0
    assert not (here / "ws" / ".gitignore").exists()


def test_a_package_that_fails_leaves_no_extras(
    here: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def fail(*_: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr("wsgen.templating.write._publish", fail)
    assert new("some_robot", "-w", "deep/ws", "--ci", "github") == 4
    assert "No space left" in capsys.readouterr().err
    assert not list(here.iterdir())
