"""All actions."""

from __future__ import annotations

import itertools
import os
import shlex
from collections.abc import Iterable, Mapping
from collections.abc import Iterable as _Iterable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ament_index_python.resources import has_resource
from launch._events import ProcessExited, ProcessStarted, TimerEvent
from launch._events import Shutdown as ShutdownEvent
from launch._finder import show_public_names
from launch._utilities import (
    BEFORE_JAZZY,
    ensure_argument_type,
    normalize_optional,
    normalize_to_list_of_substitutions,
    normalize_typed_substitution,
    perform_substitutions,
    perform_typed_substitution,
)
from launch.base import Action, Event, Substitution, TextSubstitution
from launch.launch_context import NEVER, PROCESS_TIME, LaunchContext
from launch.launch_description import LaunchDescriptionSource
from wsgen.isolation.child import copy_environment
from wsgen.launching import commands, known_packages, written_files
from wsgen.launching.record import RECORD, split_location
from wsgen.model.plan import (
    COMMAND_LINE,
    DEFAULT,
    INCLUDE,
    LAUNCH_FILE,
    Include,
    LaunchArgument,
    Process,
)

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable, Iterator, Sequence

    from launch.base import BaseEventHandler, LaunchDescriptionEntity, SomeSubstitutionsType
    from launch.launch_context import _Configurations
    from launch.launch_description import LaunchDescription


class AppendEnvironmentVariable(Action):
    """Puts a value behind, or before, what a variable holds; sets it where it holds nothing."""

    def __init__(
        self,
        name: SomeSubstitutionsType,
        value: SomeSubstitutionsType,
        prepend: Any = False,  # noqa: FBT002  as the original
        separator: SomeSubstitutionsType = os.pathsep,
        **kwargs: Any,
    ) -> None:
        super().__init__(**kwargs)
        self.__name = normalize_to_list_of_substitutions(name)
        self.__value = normalize_to_list_of_substitutions(value)
        self.__prepend = normalize_typed_substitution(prepend, bool)
        self.__separator = normalize_to_list_of_substitutions(separator)

    def execute(self, context: LaunchContext) -> None:
        """Append it."""
        name = perform_substitutions(context, self.__name)
        value = perform_substitutions(context, self.__value)
        separator = perform_substitutions(context, self.__separator)
        if name not in os.environ:
            os.environ[name] = value
        elif perform_typed_substitution(context, self.__prepend, bool):
            os.environ[name] = value + separator + os.environ[name]
        else:
            os.environ[name] = os.environ[name] + separator + value


class DeclareLaunchArgument(Action):
    """Sets its configuration to the default, unless it is set already."""

    def __init__(
        self,
        name: str,
        *,
        default_value: SomeSubstitutionsType | None = None,
        description: str | None = None,
        choices: Iterable[str] | None = None,
        **kwargs: Any,
    ) -> None:
        super().__init__(**kwargs)
        self.name = name
        self.__description = description
        self.default_value = normalize_optional(default_value)
        if hasattr(choices, "wsgen_is_unknown"):
            choices = None
        self.choices: Sequence[str] | None
        if choices is None or isinstance(choices, str):
            self.choices = choices  # of a text, launch accepts every part, as `in` does
        else:
            self.choices = list(choices)
        if self.choices is not None:
            if not self.choices:
                raise ValueError("Provided choices arg is empty.")
            default = _literal(self.default_value)
            if default is not None and not self._allows(default):
                raise ValueError(
                    f'Provided default_value "{default}" is not in provided choices '
                    f'"{self.choices}".'
                )
        self.conditionally_included = False
        RECORD.argument_use.declared[name] = None

    @property
    def description(self) -> str:
        """What it is for, with its choices."""
        if self.choices is None:
            return "no description given" if self.__description is None else self.__description
        if self.__description is None:
            return f"One of: {self.choices}"
        return f"{self.__description.rstrip('.')}. Valid choices are: {self.choices}"

    def execute(self, context: LaunchContext) -> None:
        """Set the configuration if it is not set."""
        configurations = context.launch_configurations
        if self.name not in configurations:
            if self.default_value is None:
                raise RuntimeError(
                    f"Required launch argument '{self.name}' (description: "
                    f"'{self.description}') was not provided"
                )
            value = perform_substitutions(context, self.default_value)
            configurations.set(self.name, value, DEFAULT, self.wsgen_location)
            self._note(value, value, configurations)
        else:
            value = configurations[self.name]
            self._note(_words(self.default_value), value, configurations)
        if not self._allows(value):
            raise RuntimeError(
                f'Argument "{self.name}" provided value "{value}" is not valid. '
                f"Valid options are: {self.choices}"
            )

    def _allows(self, value: str) -> bool:
        choices = self.choices
        return choices is None or value in choices or any(map(RECORD.is_unknown, [value, *choices]))

    def wsgen_give_up(self, context: LaunchContext) -> None:
        """Set the configuration to what is unknown."""
        _set_unknown(context, self.name, self.wsgen_location)

    def _note(self, default: str | None, value: Any, configurations: _Configurations) -> None:
        if self.wsgen_location is not None:  # not those of the ROS package shims
            setter, place = configurations.setters.get(self.name, (LAUNCH_FILE, None))
            RECORD.arguments.setdefault(
                self.name,
                LaunchArgument(
                    name=str(self.name),
                    default=default,
                    value=str(value),
                    description="" if self.__description is None else str(self.__description),
                    origin=RECORD.origin(self.wsgen_location),
                    set_by=setter,
                    set_at=RECORD.origin(place),
                ),
            )


def _set_unknown(context: LaunchContext, name: str, location: tuple[str, int] | None) -> None:
    """Set a configuration whose value could not be found out, unless it has one."""
    context.launch_configurations.setdefault(
        name, RECORD.note_unknown(f"var {name}", "its value could not be found out", location)
    )


def _literal(default: list[Substitution] | None) -> str | None:
    """The default where it is one plain text."""
    if default is not None and all(isinstance(part, TextSubstitution) for part in default):
        return "".join(part.text for part in default if isinstance(part, TextSubstitution))
    return None


def _words(default: list[Substitution] | None) -> str | None:
    """The default, in words where it is not needed and may not be known."""
    if default is None:
        return None
    literal = _literal(default)
    if literal is not None:
        return literal
    words: list[str] = []
    for is_text, parts in itertools.groupby(
        default, key=lambda part: isinstance(part, TextSubstitution)
    ):
        if is_text:
            text = _literal(list(parts))
            words += [repr(text)] if text else []
        else:
            words += [part.describe() for part in parts]
    return " + ".join(words)


class EmitEvent(Action):
    """Lets the event happen after what is being done."""

    def __init__(self, *, event: Event, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        if not isinstance(event, Event):
            raise TypeError(f"EmitEvent() expected an event instance, got '{event}'")
        self.event = event

    def execute(self, context: LaunchContext) -> None:
        """Let it happen."""
        if isinstance(self.event, ShutdownEvent):
            context.shut_down(self.event)
        else:
            context.emit_event_sync(self.event)


# How a process is run, which decides nothing about what is run: a plan does not look at it.
_RUNNING = {
    "cached_output",
    "emulate_tty",
    "log_cmd",
    "output",
    "output_format",
    "respawn",
    "respawn_delay",
    "respawn_max_retries",
    "sigkill_timeout",
    "sigterm_timeout",
}


class ExecuteLocal(Action):
    """A process; for a plan it is recorded instead of started, and its events happen."""

    wsgen_keywords = _RUNNING  # that are taken and say nothing
    wsgen_endless: Process | None = None  # what was started and does not exit by itself

    def __init__(
        self,
        *,
        process_description: Any = None,
        shell: bool = False,
        on_exit: Any = None,
        **kwargs: Any,
    ) -> None:
        super().__init__(**{name: value for name, value in kwargs.items() if name not in _RUNNING})
        self.process_description = process_description
        self.shell = shell
        self.process_name = ""
        self.process_details: dict[str, Any] | None = None
        self.wsgen_running = {name: value for name, value in kwargs.items() if name in _RUNNING}
        self.wsgen_prefix: list[str] = []  # of the command; what follows is known when prepared
        self.wsgen_folder: str | None = None
        self.wsgen_environment: dict[str, str] = {}
        self.wsgen_cached: dict[int, Callable[[], str]] = {}
        self.__on_exit = on_exit
        self.__executed = False
        self.return_code: int | None = None

    def prepare(self, context: LaunchContext) -> Process:
        """What is recorded of the process, but for when it starts and where it is written."""
        raise NotImplementedError

    def execute(self, context: LaunchContext) -> Iterable[LaunchDescriptionEntity] | None:
        """Note the process, and let it start and, sooner or later, exit."""
        process = self.prepare(context)
        if self.__executed:
            raise RuntimeError("ExecuteLocal action executed more than once")
        self.__executed = True
        if RECORD.live is None:
            written_files.note(process, self.wsgen_location, shell=bool(self.shell))
        if self.__on_exit is not None:
            from launch.event_handlers import OnProcessExit

            context.register_event_handler(
                OnProcessExit(target_action=self, on_exit=self.__on_exit)
            )
        file, line = split_location(self.wsgen_location)
        RECORD.processes.append(
            replace(
                process,
                starts=context.timeline.cause,
                start_time=round(context.timeline.now, 6),
                file=file,
                line=line,
            )
        )
        if RECORD.live is None:
            self._happen(context, process)
        elif not context.is_shutdown:
            from launch._live import starting_of

            RECORD.live.start(starting_of(self, context, process))
        return None

    def wsgen_words(self, process: Process) -> list[str]:
        """What follows the prefix in its command line; of a node, what follows its path."""
        return list(process.command or ())[len(self.wsgen_prefix) :]

    def get_stdout(self) -> str:
        """What it has printed, with `cached_output`."""
        return self._cached(1)

    def get_stderr(self) -> str:
        """What it has printed on standard error, with `cached_output`."""
        return self._cached(2)

    def _cached(self, stream: int) -> str:
        if not self.wsgen_running.get("cached_output"):
            raise RuntimeError("cached output must be true to be able to get what a process prints")
        return self.wsgen_cached[stream]() if stream in self.wsgen_cached else ""

    def wsgen_give_up(self, context: LaunchContext) -> None:
        """Let it start and exit all the same: others may wait for it."""
        self._happen(context, Process(package=None, executable=None))

    def _happen(self, context: LaunchContext, process: Process) -> None:
        command = process.command or process.arguments
        program = process.executable or (command[0].rpartition("/")[2] if command else "")
        self.process_name = process.name or program
        details: dict[str, Any] = {
            "action": self,
            "name": self.process_name,
            "cmd": list(command),
        }
        started = ProcessStarted(**details)
        started.wsgen_cause = f"start of {self.process_name}"
        exited = ProcessExited(**details)
        exited.wsgen_cause = f"exit of {self.process_name}"
        context.timeline.post(started)
        lives_on = commands.runs_for_ever(process)
        self.wsgen_endless = process if lives_on else None
        context.timeline.post(exited, delay=NEVER if lives_on else PROCESS_TIME)

    def _executed(self, context: LaunchContext) -> None:
        """It is complete when the process exits, not when it is started."""


class ExecuteProcess(ExecuteLocal):
    """A command line; each item of `cmd` is one word."""

    def __init__(  # noqa: PLR0913  as the original
        self,
        *,
        cmd: Iterable[SomeSubstitutionsType],
        prefix: SomeSubstitutionsType | None = None,
        name: SomeSubstitutionsType | None = None,
        cwd: SomeSubstitutionsType | None = None,
        env: Mapping[Any, Any] | None = None,
        additional_env: Mapping[Any, Any] | None = None,
        **kwargs: Any,
    ) -> None:
        super().__init__(**kwargs)
        self.cmd = [normalize_to_list_of_substitutions(word) for word in cmd]
        self.__prefix = normalize_optional(prefix)
        self.__name = normalize_optional(name)
        self.__cwd = normalize_optional(cwd)
        self.__replaces_environment = env is not None
        self.__environment = _variables({**(env or {}), **(additional_env or {})})

    @property
    def name(self) -> Any:
        """What the process is called."""
        return self.__name

    @property
    def wsgen_program(self) -> list[list[Substitution]]:
        """What names the program that it would start, before it is executed."""
        return self.cmd

    def execute(self, context: LaunchContext) -> Iterable[LaunchDescriptionEntity] | None:
        """As every process; what `ros2 launch` starts in it is started too."""
        super().execute(context)
        nested = map(commands.nested_launch, commands.programs(RECORD.processes[-1]))
        return [group for include in nested if include for group in self._launched(include)]

    def _launched(self, include: Include) -> Iterator[LaunchDescriptionEntity]:
        """The launch file that `ros2 launch` finds, with no arguments but those it is given."""
        from launch.launch_description_sources import AnyLaunchDescriptionSource

        file = _installed_launch_file(include)
        if file is None and include.package and self.wsgen_location:
            shim = known_packages.LaunchFileShim(include.package, include.file.name)
            if not shim.has_known_arguments:
                RECORD.left_out.append((shim.name, shim.package, self.wsgen_location))
        if file is not None:
            source = AnyLaunchDescriptionSource(file)
            inside = IncludeLaunchDescription(source, launch_arguments=include.arguments.items())
            inside.wsgen_location = self.wsgen_location
            yield GroupAction([ResetLaunchConfigurations(), inside])
        elif RECORD.live is not None:
            yield GroupAction(RECORD.live.included(include) or [])

    def prepare(self, context: LaunchContext) -> Process:
        """Perform the words."""
        prefix = self.__prefix
        if prefix is None:
            words = shlex.split(context.launch_configurations.get("launch-prefix", ""))
        else:
            words = shlex.split(perform_substitutions(context, prefix))
        self.wsgen_prefix = list(words)
        words += [perform_substitutions(context, word) for word in self.cmd]
        if self.__cwd is not None:
            self.wsgen_folder = perform_substitutions(context, self.__cwd)
        name = None if self.__name is None else perform_substitutions(context, self.__name)
        variables = {
            perform_substitutions(context, name): perform_substitutions(context, value)
            for name, value in self.__environment
        }
        inherited = {} if self.__replaces_environment else copy_environment()
        self.wsgen_environment = {**inherited, **variables}
        return Process(
            package=None,
            executable=None,
            name=name,
            command=tuple(words),
            is_shell=bool(self.shell),
            environment={**RECORD.changed_environment(), **variables},
        )


def _installed_launch_file(include: Include) -> str | None:
    """The path of a launch file of an installed package, or of one that is given as a path."""
    if include.package is None:
        return str(include.file) if include.file.is_file() else None
    prefix = has_resource("packages", include.package)
    if prefix is None:
        return None
    found = Path(prefix, "share", include.package).rglob(include.file.name)
    return next((str(file) for file in sorted(found)), None)


def _variables(
    variables: Mapping[Any, Any],
) -> list[tuple[list[Substitution], list[Substitution]]]:
    return [
        (normalize_to_list_of_substitutions(name), normalize_to_list_of_substitutions(value))
        for name, value in variables.items()
    ]


MOST_ITERATIONS = 10_000  # more entities than any launch has


class ForEach(Action):
    """Calls a function with each mapping of a text such as `{name: a};{name: b}`."""

    def __init__(
        self,
        input_values: SomeSubstitutionsType,
        *,
        function: Callable[..., Iterable[LaunchDescriptionEntity] | None],
        **kwargs: Any,
    ) -> None:
        super().__init__(**kwargs)
        self.__input_values = normalize_to_list_of_substitutions(input_values)
        self.__function = function

    def execute(self, context: LaunchContext) -> list[LaunchDescriptionEntity]:
        """Call it for each."""
        import yaml  # see launch.utilities.type_utils

        text = perform_substitutions(context, self.__input_values)
        found: list[LaunchDescriptionEntity] = []
        for part in text.strip().split(";"):
            keywords = yaml.safe_load(part.strip())
            if keywords is not None:
                found.extend(self.__function(**keywords) or ())
        return found


class ForLoop(Action):
    """Calls a function with each number from zero on."""

    def __init__(
        self,
        length: SomeSubstitutionsType,
        *,
        function: Callable[..., Iterable[LaunchDescriptionEntity] | None],
        name: str | None = None,
        **kwargs: Any,
    ) -> None:
        super().__init__(**kwargs)
        del name  # only the substitution `index` of XML and YAML asks for it
        self.__length = normalize_to_list_of_substitutions(length)
        self.__function = function

    def execute(self, context: LaunchContext) -> list[LaunchDescriptionEntity]:
        """Call it for each."""
        length = int(perform_substitutions(context, self.__length))
        if length > MOST_ITERATIONS:
            raise ValueError(f"a loop of {length} iterations; at most {MOST_ITERATIONS} are made")
        return [entity for i in range(length) for entity in self.__function(i=i) or ()]


class PopEnvironment(Action):
    """The environment is as it was when the scope began."""

    def execute(self, context: LaunchContext) -> None:
        """Restore the environment."""
        context._pop_environment()  # noqa: SLF001  a friend of the context


class PopLaunchConfigurations(Action):
    """Configurations are as they were when the scope began."""

    def execute(self, context: LaunchContext) -> None:
        """Restore the configurations."""
        context._pop_launch_configurations()  # noqa: SLF001  a friend of the context


class PushEnvironment(Action):
    """What is set from here on ends with the scope."""

    def execute(self, context: LaunchContext) -> None:
        """Remember the environment."""
        context._push_environment()  # noqa: SLF001  a friend of the context


class PushLaunchConfigurations(Action):
    """What is set from here on ends with the scope."""

    def execute(self, context: LaunchContext) -> None:
        """Remember the configurations."""
        context._push_launch_configurations()  # noqa: SLF001  a friend of the context


class _ResumeLaunchConfigurations(Action):
    """A scope begins with the configurations of another moment."""

    def __init__(self, configurations: Any) -> None:
        super().__init__()
        self.__configurations = configurations

    def execute(self, context: LaunchContext) -> None:
        """Begin the scope."""
        context._resume_launch_configurations(self.__configurations)  # noqa: SLF001  a friend


class ResetEnvironment(Action):
    """The environment is as it was before the launch."""

    def execute(self, context: LaunchContext) -> None:
        """Restore the environment."""
        context._reset_environment()  # noqa: SLF001  a friend of the context


class ResetLaunchConfigurations(Action):
    """Forgets all configurations but those that it is given."""

    def __init__(
        self, launch_configurations: Mapping[Any, Any] | None = None, **kwargs: Any
    ) -> None:
        super().__init__(**kwargs)
        self.__launch_configurations = launch_configurations or {}

    def execute(self, context: LaunchContext) -> None:
        """Evaluate what stays, and forget the rest."""
        kept = {
            perform_substitutions(context, normalize_to_list_of_substitutions(name)): (
                perform_substitutions(context, normalize_to_list_of_substitutions(value))
            )
            for name, value in self.__launch_configurations.items()
        }
        context.launch_configurations.clear()
        context.launch_configurations.update(kept)


class SetLaunchConfiguration(Action):
    """Sets a configuration, whether it was set or not."""

    def __init__(
        self, name: SomeSubstitutionsType, value: SomeSubstitutionsType, **kwargs: Any
    ) -> None:
        super().__init__(**kwargs)
        self.__name = normalize_to_list_of_substitutions(name)
        self.__value = normalize_to_list_of_substitutions(value)
        self.wsgen_setter = (LAUNCH_FILE, self.wsgen_location)

    def execute(self, context: LaunchContext) -> None:
        """Set it."""
        name = perform_substitutions(context, self.__name)
        value = perform_substitutions(context, self.__value)
        context.launch_configurations.set(name, value, *self.wsgen_setter)

    def wsgen_give_up(self, context: LaunchContext) -> None:
        """Set the configuration to what is unknown."""
        _set_unknown(context, perform_substitutions(context, self.__name), self.wsgen_location)


class GroupAction(Action):
    """Its actions; with `scoped`, what they set ends with them.

    Event handlers of the group run after its scope has ended, as in the original; so do its timers
    before jazzy.
    """

    def __init__(
        self,
        actions: Iterable[LaunchDescriptionEntity],
        *,
        scoped: bool = True,
        forwarding: bool = True,
        launch_configurations: Mapping[Any, Any] | None = None,
        **kwargs: Any,
    ) -> None:
        super().__init__(**kwargs)
        self.__actions = list(actions)
        self.__scoped = scoped
        self.__forwarding = forwarding
        self.__launch_configurations = launch_configurations or {}
        self.__sub_entities: list[LaunchDescriptionEntity] | None = None

    def get_sub_entities(self) -> list[LaunchDescriptionEntity]:
        """The actions, with what makes the scope around them."""
        if self.__sub_entities is None:
            settings = [
                SetLaunchConfiguration(name, value)
                for name, value in self.__launch_configurations.items()
            ]
            inside: list[LaunchDescriptionEntity] = [*settings, *self.__actions]
            if self.__scoped and not self.__forwarding:
                inside = [
                    ResetEnvironment(),
                    ResetLaunchConfigurations(self.__launch_configurations),
                    *self.__actions,
                ]
            if self.__scoped:
                inside = [
                    PushLaunchConfigurations(),
                    PushEnvironment(),
                    *inside,
                    PopEnvironment(),
                    PopLaunchConfigurations(),
                ]
            self.__sub_entities = inside
        return self.__sub_entities

    def execute(self, context: LaunchContext) -> Iterable[LaunchDescriptionEntity]:
        """Give the actions in their scope."""
        del context
        return self.get_sub_entities()


class IncludeLaunchDescription(Action):
    """Sets the arguments and visits the description, both in the scope of the caller."""

    def __init__(
        self,
        launch_description_source: LaunchDescriptionSource | SomeSubstitutionsType,
        *,
        launch_arguments: Iterable[tuple[Any, Any]] | None = None,
        **kwargs: Any,
    ) -> None:
        super().__init__(**kwargs)
        if not isinstance(launch_description_source, LaunchDescriptionSource):
            from launch.launch_description_sources import AnyLaunchDescriptionSource

            launch_description_source = AnyLaunchDescriptionSource(launch_description_source)
        self.launch_description_source = launch_description_source
        self.__is_mapping = isinstance(launch_arguments, Mapping)
        self.launch_arguments = () if launch_arguments is None else tuple(launch_arguments)

    def describe(self) -> str:
        """Itself in words."""
        return f"IncludeLaunchDescription({self.launch_description_source.location})"

    def get_sub_entities(self) -> list[LaunchDescriptionEntity]:
        """The description, where it can be known before the launch."""
        description = self.launch_description_source.try_get_launch_description_without_context()
        return [] if description is None else [description]

    def execute(self, context: LaunchContext) -> Iterable[LaunchDescriptionEntity]:
        """Load the description and give it, with the arguments before it."""
        description = self.launch_description_source.get_launch_description(context)
        file = self.launch_description_source.location
        if not RECORD.is_unknown(file):
            file = os.path.abspath(file)
        context.extend_locals(
            {
                "current_launch_file_path": file,
                "current_launch_file_directory": os.path.dirname(file),
            }
        )
        # No line includes the launch file that is played itself.
        location = self.wsgen_location
        is_include = location is not None
        try:
            names = [_text(context, name) for name, _ in self.launch_arguments]
        except ValueError as error:  # they are no pairs
            error.wsgen_is_mapping = self.__is_mapping  # type: ignore[attr-defined]
            raise
        _require_arguments(description, list(names))
        if location is not None:
            is_shim = known_packages.shim_of(file) is not None
            RECORD.argument_use.given += [(name, location, is_shim) for name in names]
            _note_left_out(file, location)
        given = [SetLaunchConfiguration(name, value) for name, value in self.launch_arguments]
        for argument in given:
            argument.wsgen_setter = (INCLUDE if is_include else COMMAND_LINE, location)
        return [
            *given,
            *([_Entrance(file, names)] if is_include else []),
            description,
            *([_Exit()] if is_include and known_packages.shim_of(file) else []),
        ]

    def argument_names_without_context(self) -> list[str]:
        """The names of the arguments, where they can be known before the launch."""
        names = []
        for name, _ in self.launch_arguments:
            try:
                names.append(_text(LaunchContext(), name))
            except Exception:  # noqa: BLE001, S112, PERF203  a name that depends on the launch
                continue
        return names


def _note_left_out(file: str, location: tuple[str, int]) -> None:
    """Note a launch file of which nothing is known but its name and package."""
    shim = known_packages.shim_of(file)
    if shim is not None and not shim.has_known_arguments:
        RECORD.left_out.append((shim.name, shim.package, location))


class _Entrance(Action):
    """Records the include, with its arguments as they were set."""

    def __init__(self, file: str, names: list[str]) -> None:
        super().__init__()
        self.__file = file
        self.__names = names

    def execute(self, context: LaunchContext) -> None:
        """Note it."""
        shim = known_packages.shim_of(self.__file)
        configurations = context.launch_configurations.unread()
        RECORD.includes.append(
            Include(
                package=known_packages.package_of(self.__file),
                file=Path(self.__file),
                arguments={name: str(configurations[name]) for name in self.__names},
                evaluated=shim is None and not RECORD.is_unknown(self.__file),
            )
        )


class _Exit(Action):
    """Records what a launch file that is not installed would have seen."""

    def execute(self, context: LaunchContext) -> Iterable[LaunchDescriptionEntity] | None:
        """Add the configurations that it was not given, and has all the same."""
        include = replace(
            RECORD.includes[-1],
            configurations={
                name: value
                for name, value in context.launch_configurations.unread().items()
                if isinstance(value, str)
            },
        )
        RECORD.includes[-1] = include
        return None if RECORD.live is None else RECORD.live.included(include)


def _text(context: LaunchContext, name: Any) -> str:
    return perform_substitutions(context, normalize_to_list_of_substitutions(name))


def _require_arguments(description: LaunchDescription, given: list[str]) -> None:
    """Refuse an include that lacks a required argument, before anything is done."""
    if hasattr(description, "wsgen_is_unknown"):
        return
    for (
        argument,
        includes,
    ) in description.get_launch_arguments_with_include_launch_description_actions():
        if argument.conditionally_included or argument.default_value is not None:
            continue
        for include in includes:
            given.extend(include.argument_names_without_context())
        if argument.name not in given:
            error = RuntimeError(
                f"Included launch description missing required argument '{argument.name}' "
                f"(description: '{argument.description}'), given: [{', '.join(given)}]"
            )
            error.wsgen_argument = argument.name  # type: ignore[attr-defined]
            raise error


class LogInfo(Action):
    """A message; for a plan it is performed, because that can fail, and not printed."""

    wsgen_level = "INFO"

    def __init__(self, *, msg: SomeSubstitutionsType, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.msg = normalize_to_list_of_substitutions(msg)

    def execute(self, context: LaunchContext) -> None:
        """Perform the message."""
        message = perform_substitutions(context, self.msg)
        if RECORD.live is not None:
            import logging

            logger = logging.getLogger("launch.user")
            logger.log(logging.getLevelName(self._level(context)), "%s", message)

    def _level(self, context: LaunchContext) -> str:
        del context
        return self.wsgen_level


class Log(LogInfo):
    """A message of a level."""

    def __init__(
        self, *, msg: SomeSubstitutionsType, level: SomeSubstitutionsType, **kwargs: Any
    ) -> None:
        super().__init__(msg=msg, **kwargs)
        self.level = normalize_to_list_of_substitutions(level)

    def _level(self, context: LaunchContext) -> str:
        level = perform_substitutions(context, self.level).upper()
        if level not in {"DEBUG", "INFO", "WARNING", "ERROR"}:
            raise KeyError(
                "Invalid log level, expected one of ['DEBUG', 'INFO', 'WARNING', 'ERROR']"
            )
        return level


class LogDebug(LogInfo):
    """A message for developers."""

    wsgen_level = "DEBUG"


class LogWarning(LogInfo):
    """A warning."""

    wsgen_level = "WARNING"


class LogError(LogInfo):
    """An error message."""

    wsgen_level = "ERROR"


LONGEST_WAIT = 1.0  # s of real time, for what never comes because nothing runs


class OpaqueCoroutine(Action):
    """Runs after what is being done; for a plan it sleeps in virtual time, which is not long."""

    def __init__(
        self,
        *,
        coroutine: Callable[..., Awaitable[Any]],
        args: Iterable[Any] | None = None,
        kwargs: Mapping[str, Any] | None = None,
        ignore_context: bool = False,
        **left_over_kwargs: Any,
    ) -> None:
        super().__init__(**left_over_kwargs)
        import asyncio  # what launch files seldom need

        if not asyncio.iscoroutinefunction(coroutine):
            raise TypeError(
                f"OpaqueCoroutine expected a coroutine function for 'coroutine', got '{coroutine}'"
            )
        self.__coroutine = coroutine
        self.__args = () if args is None else tuple(args)
        self.__kwargs = {} if kwargs is None else dict(kwargs)
        self.__ignore_context = ignore_context

    def execute(self, context: LaunchContext) -> None:
        """Let it run later."""
        context.timeline.post(_Turn(self))

    def run(self, context: LaunchContext) -> None:
        """Run it to its end; its result is dropped."""
        import asyncio

        first = () if self.__ignore_context else (context,)
        if RECORD.live is not None:
            coroutine = self.__coroutine(*first, *self.__args, **self.__kwargs)
            RECORD.live.run_coroutine(
                lambda: asyncio.run(coroutine), lambda: self.announce_completion(context)
            )
            return
        sleep = asyncio.sleep
        asyncio.sleep = lambda _delay, result=None: sleep(0, result)
        try:
            asyncio.run(
                asyncio.wait_for(
                    self.__coroutine(*first, *self.__args, **self.__kwargs), LONGEST_WAIT
                )
            )
        except (asyncio.TimeoutError, TimeoutError):
            RECORD.note_unresolved(
                "OpaqueCoroutine", "it waits for what only a launch brings", self.wsgen_location
            )
        finally:
            asyncio.sleep = sleep

    def _executed(self, context: LaunchContext) -> None:
        """It is complete when it has run."""


class _Turn(Event):
    """It is the coroutine's turn."""

    def __init__(self, action: OpaqueCoroutine) -> None:
        self.action = action

    def wsgen_happen(self, context: LaunchContext) -> None:
        """Run it."""
        self.action.run(context)
        if RECORD.live is None:
            self.action.announce_completion(context)


class OpaqueFunction(Action):
    """Called with the context when it is visited; the list it gives is visited next."""

    def __init__(
        self,
        *,
        function: Callable[..., Any],
        args: Iterable[Any] | None = None,
        kwargs: Mapping[str, Any] | None = None,
        **left_over_kwargs: Any,
    ) -> None:
        super().__init__(**left_over_kwargs)
        if not callable(function):
            raise TypeError(
                f"OpaqueFunction expected a callable for 'function', got '{type(function)}'"
            )
        ensure_argument_type(args, [_Iterable, type(None)], "args", "OpaqueFunction")
        ensure_argument_type(kwargs, [dict, type(None)], "kwargs", "OpaqueFunction")
        self.__function = function
        self.__args = () if args is None else tuple(args)
        self.__kwargs = {} if kwargs is None else dict(kwargs)
        RECORD.argument_use.not_run.add(self)

    def execute(self, context: LaunchContext) -> Any:
        """Call it."""
        RECORD.argument_use.not_run.discard(self)
        return self.__function(context, *self.__args, **self.__kwargs)


class RegisterEventHandler(Action):
    """From here on the handler is asked."""

    def __init__(self, event_handler: BaseEventHandler, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.event_handler = event_handler

    def execute(self, context: LaunchContext) -> None:
        """Register it."""
        context.register_event_handler(self.event_handler)

    def describe_conditional_sub_entities(
        self,
    ) -> list[tuple[str, Iterable[LaunchDescriptionEntity]]]:
        """What the handler is known to bring about."""
        text, entities = self.event_handler.describe()
        return [(text, entities)] if entities else []


class SetEnvironmentVariable(Action):
    """Sets a variable of the launch itself, so that what comes later sees it."""

    def __init__(
        self, name: SomeSubstitutionsType, value: SomeSubstitutionsType, **kwargs: Any
    ) -> None:
        super().__init__(**kwargs)
        self.__name = normalize_to_list_of_substitutions(name)
        self.__value = normalize_to_list_of_substitutions(value)

    def execute(self, context: LaunchContext) -> None:
        """Set it."""
        name = perform_substitutions(context, self.__name)
        os.environ[name] = perform_substitutions(context, self.__value)


class Shutdown(EmitEvent):
    """Ends the launch."""

    def __init__(self, *, reason: str = "reason not given", **kwargs: Any) -> None:
        super().__init__(event=ShutdownEvent(reason=reason), **kwargs)


class TimerAction(Action):
    """Its actions, after a period; of virtual time in a plan.

    From launch 3.4.5 (jazzy) on they have the configurations of where the timer was set, and what
    they set ends with them.
    """

    wsgen_is_simulated = False  # whether it is the time of the simulation

    def __init__(
        self,
        *,
        period: Any,
        actions: Iterable[LaunchDescriptionEntity],
        cancel_on_shutdown: Any = True,
        **kwargs: Any,
    ) -> None:
        super().__init__(**kwargs)
        ensure_argument_type(
            period, [str, Substitution, Iterable, float, int], "period", "TimerAction"
        )
        ensure_argument_type(actions, Iterable, "actions", "TimerAction")
        self.period = normalize_to_list_of_substitutions(
            str(period) if isinstance(period, (float, int)) else period
        )
        self.actions = list(actions)
        self.__locals: dict[str, Any] = {}
        self.__configurations: Any = None
        self.wsgen_is_canceled = False
        self.__cancel_on_shutdown = normalize_typed_substitution(cancel_on_shutdown, bool)
        self.wsgen_outlives_shutdown = False

    def cancel(self) -> None:
        """Do nothing when the time comes."""
        self.wsgen_is_canceled = True

    def describe_conditional_sub_entities(
        self,
    ) -> list[tuple[str, Iterable[LaunchDescriptionEntity]]]:
        """What is done when the time comes."""
        return [("the period passes without being canceled", self.actions)]

    def execute(self, context: LaunchContext) -> None:
        """Set the timer."""
        seconds = float(perform_substitutions(context, self.period))
        # What the actions find out about the launch file is what it was here.
        self.__locals = context.get_locals_as_dict()
        if os.environ.get("ROS_DISTRO") not in BEFORE_JAZZY:
            self.__configurations = context.launch_configurations.copy_unread()
        fires = TimerEvent(timer_action=self)
        fires.wsgen_cause = f"timer {seconds}"
        self.wsgen_outlives_shutdown = not perform_typed_substitution(
            context, self.__cancel_on_shutdown, bool
        )
        context.timeline.post(fires, delay=seconds, is_simulated=self.wsgen_is_simulated)

    def handle(self, context: LaunchContext) -> list[LaunchDescriptionEntity]:
        """Give the actions."""
        if self.wsgen_is_canceled:
            return []
        context.extend_locals(self.__locals)
        self.announce_completion(context)
        if self.__configurations is None:
            return self.actions
        return [
            _ResumeLaunchConfigurations(self.__configurations),
            *self.actions,
            PopLaunchConfigurations(),
        ]

    def _executed(self, context: LaunchContext) -> None:
        """It is complete when the time has come, not when the timer is set."""


class UnregisterEventHandler(Action):
    """From here on the handler is not asked any more."""

    def __init__(self, event_handler: BaseEventHandler, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.__event_handler = event_handler

    def execute(self, context: LaunchContext) -> None:
        """Unregister it."""
        context.unregister_event_handler(self.__event_handler)


class UnsetEnvironmentVariable(Action):
    """Removes a variable, if it is set."""

    def __init__(self, name: SomeSubstitutionsType, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.__name = normalize_to_list_of_substitutions(name)

    def execute(self, context: LaunchContext) -> None:
        """Remove it."""
        os.environ.pop(perform_substitutions(context, self.__name), None)


class UnsetLaunchConfiguration(Action):
    """Forgets a configuration, if there is one."""

    def __init__(self, name: SomeSubstitutionsType, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.__name = normalize_to_list_of_substitutions(name)

    def execute(self, context: LaunchContext) -> None:
        """Forget it."""
        context.launch_configurations.pop(perform_substitutions(context, self.__name), None)


show_public_names(__name__)
