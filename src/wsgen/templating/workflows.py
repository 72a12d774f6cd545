"""Render workflows for services that build a repository after each push."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from wsgen import __version__
from wsgen.model.installation import image
from wsgen.templating.environment import Environment

if TYPE_CHECKING:
    from wsgen.model.target import Target
    from wsgen.templating.render import RenderedTree


# Service -> path of its workflow in the repository, and the source.
WORKFLOWS = {
    "github": (".github/workflows/wsgen.yml", "wsgen:workspace/github.yml.j2"),
    "gitlab": (".gitlab-ci.yml", "wsgen:workspace/gitlab.yml.j2"),
}
# The newest that has wheels of PyBullet (pyproject.toml); on a newer one wsgen takes MuJoCo.
NEWEST_PYTHON = (3, 13)


def render_workflow(service: str, target: Target) -> RenderedTree:
    """Render the workflow of a service (a key of WORKFLOWS), by its path in the workspace.

    It builds and validates on the Python of the target, which will run the launch files, and on
    the newest Python with PyBullet.
    """
    path, source = WORKFLOWS[service]
    python = tuple(int(part) for part in target.fact("python").split("."))
    versions = [".".join(map(str, version)) for version in sorted({python, NEWEST_PYTHON})]
    environment = Environment(Path())
    text = environment.get_template(source).render(
        target=target, image=image(target), pythons=versions, wsgen_version=__version__
    )
    environment.keep_compiled()
    return {path: text}
