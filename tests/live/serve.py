"""`serve.py FILE FOLDER OPTIONS`: plays a launch file as `wsgen launch --run`, without robots."""

import json
import os
import sys
from pathlib import Path

from wsgen.launching.known_packages import prefix
from wsgen.live.request import ServiceRequest
from wsgen.live.service_child import start_service
from wsgen.model.plan import LaunchRequest


def main() -> int:
    launch_file, folder, options = Path(sys.argv[1]), Path(sys.argv[2]), json.loads(sys.argv[3])
    arguments = options.pop("arguments", {})
    python = Path(options.pop("python", sys.executable))
    launch = LaunchRequest(launch_file=launch_file, package=None, arguments=arguments)
    request = ServiceRequest(
        launch=launch,
        folder=folder,
        python=python,
        environment={"AMENT_PREFIX_PATH": prefix(), **os.environ},
        **options,
    )
    with start_service(folder, request.environment) as service:
        service.go(request)
        return service.wait()


if __name__ == "__main__":
    sys.exit(main())
