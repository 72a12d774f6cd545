"""Open what is swept: a package, a robot file or a template."""

from __future__ import annotations

from contextlib import ExitStack, contextmanager
from typing import TYPE_CHECKING

from wsgen.errors import RequestError
from wsgen.isolation.fork_server import ForkServer
from wsgen.isolation.parent import make_scratch
from wsgen.launching.evaluate import PlainLaunches
from wsgen.launching.known_packages import prefix
from wsgen.packages.workspace.overlay import open_overlay
from wsgen.pipeline.requests import ValidateRequest
from wsgen.pipeline.validate import check_request, overlays_of_files

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from wsgen.events import Listener
    from wsgen.sweeping.subject import Subject, SubjectRequest


@contextmanager
def open_subject(
    request: SubjectRequest,
    *,
    environment: Mapping[str, str],
    listener: Listener | None = None,
) -> Iterator[Subject]:
    """Open what is swept. Files of its blueprints are there until the context is left.

    Raises:
        RequestError: The request names nothing, or more than one; no such package, launch file or
            template; the launch files that spawn robots are none, or several; or an option is
            given that has no effect.
        NotFoundError: The file does not exist, or the package cannot be read.
        NotReadableError: The file is no regular file, or the setup file of the workspace fails.
        BrokenTemplateError: The template is invalid.
    """
    _check(request)
    with ExitStack() as stack:
        folder = stack.enter_context(make_scratch())
        fork_server = stack.enter_context(ForkServer())
        run = stack.enter_context(PlainLaunches(fork_server.run)).run
        if request.template is not None:
            # A package needs nothing of what renders, and a template nothing of what reads files.
            from wsgen.sweeping.template_subject import TemplateSubject  # noqa: PLC0415

            yield TemplateSubject(request, environment, folder, run)
        elif request.file is not None:
            from wsgen.sweeping.robot_subjects import FileSubject  # noqa: PLC0415

            files = (request.file,)
            check_request(
                ValidateRequest(
                    files=files,
                    engines=(),
                    launch_file=request.launch_file,
                    launch_arguments=request.launch_arguments,
                )
            )
            (overlay,) = overlays_of_files(files, request.workspace, environment, stack)
            yield FileSubject(request.file, request, overlay, folder, run)
        else:
            from wsgen.sweeping.robot_subjects import PackageSubject  # noqa: PLC0415

            workspaces = [] if request.workspace is None else [request.workspace]
            if not workspaces:  # a sourced ROS may have it, and what wsgen knows of ROS
                environment = {"AMENT_PREFIX_PATH": prefix(), **environment}
            overlay = stack.enter_context(open_overlay(workspaces, environment))
            yield PackageSubject(request, overlay, folder, run, listener)


def _check(request: SubjectRequest) -> None:
    given = [one for one in (request.package, request.file, request.template) if one is not None]
    if len(given) != 1:
        raise RequestError(
            "A sweep is of one package, one file or one template; "
            f"{len(given) or 'none'} {'are' if len(given) > 1 else 'is'} given.",
            hint="Write for example: wsgen sweep my_robot --over world.slope=0:30deg:31",
        )
    if request.template is None and (request.settings or request.target):
        what = "--set" if request.settings else "--distro and --sim"
        raise RequestError(
            f"{what} {'has' if request.settings else 'have'} no effect without a template.",
            hint=f"Remove {what}, or sweep a template: -t NAME",
        )
