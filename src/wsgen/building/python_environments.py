"""Keep colcon from searching for packages in environments of Python.

Who has just installed wsgen into a folder `venv` of the workspace would build ament_cmake, whose
wheels have manifests. colcon asks its extension for COLCON_IGNORE first in each folder.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from colcon_core.package_identification import IgnoreLocationException
from colcon_core.package_identification.ignore import IgnorePackageIdentification

if TYPE_CHECKING:
    from colcon_core.package_descriptor import PackageDescriptor


def ignore_python_environments() -> None:
    """Let colcon ignore them in this process."""
    ignores = IgnorePackageIdentification.identify

    def identify(self: IgnorePackageIdentification, desc: PackageDescriptor) -> None:
        ignores(self, desc)
        # Every command of colcon loads this module, and some look for no packages.
        from wsgen.packages.workspace.layout import is_python_environment  # noqa: PLC0415

        try:
            names = [path.name for path in Path(desc.path).iterdir()]
        except OSError:  # colcon says so, or passes it over
            return
        if is_python_environment(names):
            raise IgnoreLocationException

    IgnorePackageIdentification.identify = identify
