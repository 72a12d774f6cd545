"""Where nodes write their logs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from launch.actions.set_environment_variable import SetEnvironmentVariable

if TYPE_CHECKING:
    from launch.some_substitutions_type import SomeSubstitutionsType


class SetROSLogDir(SetEnvironmentVariable):
    """Sets the variable that nodes read it from."""

    def __init__(self, new_log_dir: SomeSubstitutionsType, **kwargs: Any) -> None:
        super().__init__("ROS_LOG_DIR", new_log_dir, **kwargs)
