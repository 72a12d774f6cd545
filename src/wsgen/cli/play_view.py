"""`wsgen launch --play --view`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.errors import EXIT_FAILED, EXIT_PASSED

if TYPE_CHECKING:
    from wsgen.pipeline.requests import SelectedLaunchFile, ValidateRequest


def view_simulation(
    selected: SelectedLaunchFile,
    request: ValidateRequest,
    host: str,
    port: int | None,
    *,
    opens: bool,
    quiet: bool,
    verbose: bool,
) -> int:
    """Simulate what a launch file spawns, and show it until the user ends it with Ctrl-C."""
    from contextlib import closing, suppress
    from dataclasses import replace

    from wsgen.cli.browser import announce
    from wsgen.cli.progress import listening
    from wsgen.cli.view import print_diagnostics
    from wsgen.isolation.parent import make_scratch
    from wsgen.pipeline.describe import describe_launch
    from wsgen.pipeline.engines import check_engines
    from wsgen.pipeline.run_robots import spawned_robots
    from wsgen.reporting.viewing.view import check_viewer, choose_port
    from wsgen.simulation.scene import Scene
    from wsgen.simulation.session import Session

    check_viewer()
    check_engines(request.engines)
    port = choose_port(host, port)
    viewed = replace(request, is_viewed=True)
    with make_scratch() as folder:
        with listening(quiet=quiet, verbose=verbose) as listener:
            found = describe_launch(selected, viewed, folder, listener=listener)
        print_diagnostics(found, verbose=verbose)
        runnable = [robot for robot in found.robots if robot.can_run]
        if found.world is None or all(robot.is_static_model for robot in runnable):
            return EXIT_FAILED
        robots = spawned_robots(runnable)
        scene = Scene(world=found.world, robots=robots, engine=request.engines[0])
        # It takes half a second to import, and serves nothing that has an error.
        from wsgen.reporting.viewing.play import Player
        from wsgen.reporting.viewing.simulation_page import SimulationPage

        with suppress(KeyboardInterrupt):
            page = SimulationPage(host=host, port=port, title=found.name)
            try:
                with closing(Player(found, lambda: Session(scene, remembered=0), page)) as player:
                    announce(host, page.port, opens=opens, quiet=quiet)
                    player.run()
            finally:
                page.stop()
    return EXIT_PASSED
