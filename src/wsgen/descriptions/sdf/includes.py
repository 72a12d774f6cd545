"""`<include>`: find the model in another file."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import unquote

from wsgen.descriptions.sdf.lookup import (
    address_of,
    file_of_model,
    gazebo_models,
    instead_of_file,
    is_file,
    is_folder,
    is_there,
    models_around,
)
from wsgen.descriptions.sdf.source import load, parse_text, with_version
from wsgen.diagnostics import Rule, Severity
from wsgen.text.files import after_scheme, irregular_kind
from wsgen.text.suggestions import did_you_mean, nearest, some_of
from wsgen.text.xmltree import children

if TYPE_CHECKING:
    from collections.abc import Callable

    from wsgen.descriptions.sdf.frames import Node
    from wsgen.descriptions.sdf.source import Source
    from wsgen.diagnostics import Diagnostic
    from wsgen.model.robot import Robot
    from wsgen.text.xmltree import Element

    ReadRobot = Callable[[Path], tuple[Robot | None, tuple[Diagnostic, ...]]]


# Reasons of what is missing.
ELSEWHERE = "maybe in a folder of models"
DOWNLOADED = "Gazebo downloads it"
MODEL_LEFT_OUT = Rule(
    code="WLD004",
    name="model-left-out",
    severity=Severity.WARNING,
    severity_varies="an error where the model is part of a movable model, where an `<include>` has "
    "no `<uri>`, and where the world then has no ground; information from `wsgen check` about "
    "models that Gazebo downloads, and about actors, joints and populations",
    summary="A model of the world is not part of the simulation.",
    what="Looks for included models beside the file, in the folders of `GAZEBO_MODEL_PATH` and "
    "`GZ_SIM_RESOURCE_PATH` and in the cache of Gazebo Fuel; the network is not used. Joints, "
    "actors and populations of a world are not simulated.",
    why="Gazebo may not find the model either, and robots that stand on it fall. If "
    "Gazebo finds it, the simulation of wsgen differs from Gazebo's.",
    example="<include>\n  <uri>model://grund_plane</uri>\n</include>",
    instead="<include>\n  <uri>model://ground_plane</uri>\n</include>",
)

INCLUDE_CYCLE = Rule(
    code="WLD019",
    name="include-cycle",
    severity=Severity.ERROR,
    summary="A model includes itself.",
    why="The model has infinitely many parts: Gazebo crashes or refuses it.",
    example="""<!-- models/arm/model.sdf -->
<model name="arm">
  <include>
    <uri>model://arm</uri>
  </include>
</model>""",
    instead="""<!-- models/arm/model.sdf -->
<model name="arm">
  <include>
    <uri>model://hand</uri>
  </include>
</model>""",
)

DATABASE_MODELS = Rule(
    code="WLD062",
    name="models-of-gazebo",
    severity=Severity.INFO,
    severity_varies="a warning for Gazebo Sim, which does not download them",
    summary="Models of Gazebo's model database are not on this machine.",
    what="Looks for `model://NAME` of models and meshes that Gazebo Classic downloads "
    "automatically.",
    why="`wsgen` does not download models: its simulation lacks them.",
    example="<include>\n  <uri>model://cafe_table</uri>\n</include>",
    instead="Copy the folder of the model beside the world, or to a folder of GAZEBO_MODEL_PATH or "
    "GZ_SIM_RESOURCE_PATH.",
)

FUEL_MODEL = Rule(
    code="WLD066",
    name="model-from-network",
    severity=Severity.INFO,
    severity_varies="a warning about a collision of a robot",
    summary="A world downloads models from the network.",
    why="The first start of the world downloads them, and fails on a machine without network, such "
    "as a CI runner.",
    example="<include>\n"
    "  <uri>https://fuel.gazebosim.org/1.0/OpenRobotics/models/Table</uri>\n"
    "</include>",
    instead="<!-- the folder `table` is in GZ_SIM_RESOURCE_PATH -->\n"
    "<include>\n  <uri>model://table</uri>\n</include>",
)

# Their Fuel addresses end in the same words, with capitals and a blank.
SCHEMES = ("model://", "file://", "package://", "http://", "https://")
GROUND_PLANE = "ground_plane"
SUN = "sun"

# Gazebo's own ground plane, as the simulation uses it.
GROUND_PLANE_FRICTION = 100.0
GROUND_PLANE_SDF = f"""
<sdf version="1.4">
  <model name="ground_plane">
    <static>true</static>
    <link name="link">
      <collision name="collision">
        <geometry><plane><normal>0 0 1</normal><size>100 100</size></plane></geometry>
        <surface><friction><ode><mu>{GROUND_PLANE_FRICTION}</mu><mu2>50</mu2></ode></friction></surface>
      </collision>
      <visual name="visual">
        <geometry><plane><normal>0 0 1</normal><size>100 100</size></plane></geometry>
        <material><script><name>Gazebo/Grey</name></script></material>
      </visual>
    </link>
  </model>
</sdf>
"""

# So similar two words are, as difflib counts, that one is taken for the other.
ALIKE = 0.8
MOST_NAMED = 8
MOST_COMPARED = 20  # names; difflib is slow, and a file with more has another problem

WHERE = (
    "Copy its folder beside this file, or to a folder of GAZEBO_MODEL_PATH (Gazebo Classic) or "
    "GZ_SIM_RESOURCE_PATH (Gazebo Sim)."
)
OF_ONE_MACHINE = (
    "Other machines do not have this path. Copy the folder into a package, and write model://NAME; "
    "the folder that has NAME is to be in GAZEBO_MODEL_PATH (Gazebo Classic) or "
    "GZ_SIM_RESOURCE_PATH (Gazebo Sim)."
)


class Includes:
    """Finds models, and reads every file once.

    Args:
        find_model: Gives the folder of `model://NAME` or of a model of Fuel, None where there is
            none.
        diagnostics: The list to which diagnostics are added.
        read_robot: Reads a URDF file as Gazebo has it, which SDF may include as well.
        with_devices: Whether sensors and plugins are wanted, too.
    """

    def __init__(
        self,
        find_model: Callable[[str], Path | None],
        diagnostics: list[Diagnostic],
        read_robot: ReadRobot | None = None,
        *,
        with_devices: bool = False,
    ) -> None:
        self.with_devices = with_devices
        self._find_model = find_model
        self._diagnostics = diagnostics
        self._read_robot = read_robot
        self._folders: dict[str, Path | None] = {}
        self._files: dict[tuple[Path | None, str], Path | str] = {}  # or why none was found
        self._sources: dict[Path, Source | None] = {}
        self._robots: dict[Path, Robot | None] = {}
        self._ground: Source | None = None
        self._near_models: dict[str, str | None] = {}  # by the address that is not found
        self._misspelled_ground: int | None = None  # the place of the diagnostic about it
        self._of_gazebo: dict[str, tuple[Source, Element]] = {}  # where each is named first
        self._of_network: dict[str, tuple[Source, Element]] = {}  # likewise
        # Includes that gave nothing, and meshes of collisions that are missing: both are reported.
        self.left_out: set[Element] = set()
        self.solids_left_out = 0  # collisions and parts that only Gazebo finds

    def find(
        self,
        source: Source,
        include: Element,
        uri: str,
        trail: tuple[Path, ...],
        *,
        outer: Node | None,
    ) -> tuple[Source, Element] | None:
        """The model of an include and its file; None, with a diagnostic, if it cannot be read.

        `trail` are the files that lead here; `outer` is the model that it is part of. That is
        incomplete without it; a static one stands all the same.
        """
        found = self._find(source, include, uri, trail, outer=outer)
        if found is None:
            self.left_out.add(include)
        return found

    @property
    def files(self) -> frozenset[Path]:
        """The files of included models."""
        return frozenset((*self._sources, *self._robots))

    @property
    def has_left_to_gazebo(self) -> bool:
        """Whether what only Gazebo finds is not here; it may be what robots stand on."""
        return bool(self._of_gazebo or self._of_network)

    def leave_to_gazebo(
        self, source: Source, element: Element, uri: str, *, is_solid: bool
    ) -> bool:
        """Whether a model or mesh that is not found is one of Gazebo's database, or a download.

        `is_solid` says that the model that names it cannot stand without it.
        """
        scheme, _, rest = uri.partition("://")
        name = rest.partition("/")[0]
        address = address_of(uri) if element.tag == "mesh" else None
        if address is not None:
            self._of_network.setdefault(address.name, (source, element))
        elif scheme == "model" and name in gazebo_models() and not self._folder(f"model://{name}"):
            self._of_gazebo.setdefault(name, (source, element))
        else:
            return False
        self.solids_left_out += is_solid
        return True

    def report_left_to_gazebo(self, *, is_robot: bool = False) -> None:
        """Report all that only Gazebo finds, in one diagnostic for each place where it does.

        `is_robot` says that it is part of what is spawned, not of the world around it.
        """
        severity = Severity.WARNING if is_robot and self.solids_left_out else None
        for rule, models, what, hint in (
            (
                DATABASE_MODELS,
                self._of_gazebo,
                "Models of Gazebo's model database are not on this machine",
                (
                    "For Gazebo Sim, copy their folders to a folder of GZ_SIM_RESOURCE_PATH; "
                    "Gazebo Classic downloads them automatically."
                ),
            ),
            (
                FUEL_MODEL,
                self._of_network,
                "Meshes of models that Gazebo downloads are not on this machine",
                (
                    "Download the models once with `gz fuel download -u URI` (Gazebo Fortress: "
                    "`ign fuel`), or copy them to a folder of GZ_SIM_RESOURCE_PATH."
                ),
            ),
        ):
            if models:
                source, element = next(iter(models.values()))
                source.report(
                    rule,
                    f"{what}: {some_of(list(models), MOST_NAMED)}. The simulation lacks them.",
                    at=element,
                    hint=hint,
                    severity=severity,
                )

    def _find(
        self,
        source: Source,
        include: Element,
        uri: str,
        trail: tuple[Path, ...],
        *,
        outer: Node | None,
    ) -> tuple[Source, Element] | None:
        if not uri:
            source.report_missing(
                MODEL_LEFT_OUT,
                "The include has no <uri>.",
                at=include,
                child="uri",
                hint=how_to_find(uri),
                severity=Severity.ERROR,
            )
            return None
        if is_ground_plane(uri):
            return self._ground_plane()
        found = self._files.get((source.file, uri))
        if found is None:
            found = self._files[source.file, uri] = self._model_file(source, uri)
        if isinstance(found, Path) and found in trail:
            source.report(
                INCLUDE_CYCLE,
                f"`{uri}` includes itself ({_circle(trail, found)}).",
                at=include,
                hint="Remove one of the includes of this cycle.",
            )
            return None
        if isinstance(found, Path):
            inner = self._source(found)
            element = None if inner is None else self._model_in(inner, is_part=outer is not None)
            if inner is not None and element is not None:
                return inner, element
            if inner is not None and next(children(inner.root, "light", "actor"), None) is not None:
                return None  # without a collision
            found = _why_no_model(found, inner)
        if not self.leave_to_gazebo(source, include, uri, is_solid=outer is not None):
            is_needed = outer is not None and not outer.is_static
            self._report_left_out(source, include, uri, found, is_needed=is_needed)
        return None

    def _report_left_out(
        self, source: Source, include: Element, uri: str, why: str, *, is_needed: bool
    ) -> None:
        near = self._near(source, uri)
        if near == GROUND_PLANE:
            self._misspelled_ground = len(self._diagnostics)
        source.report(
            MODEL_LEFT_OUT,
            f"The model `{uri}` is not part of the simulation: {why}.",
            at=include,
            hint=did_you_mean(f"model://{near}") if near else how_to_find(uri),
            # The models of a world may be where wsgen does not look.
            severity=Severity.ERROR if is_needed else Severity.WARNING,
            reason=DOWNLOADED
            if _is_on_network(uri)
            else ELSEWHERE
            if not near and _may_be_elsewhere(uri)
            else None,
        )

    def _near(self, source: Source, uri: str) -> str | None:
        if uri not in self._near_models and len(self._near_models) < MOST_COMPARED:
            self._near_models[uri] = _near_model(source, uri)
        return self._near_models.get(uri)

    def blame_misspelled_ground(self) -> bool:
        """Report that the misspelled address of a ground plane leaves the world without ground.

        False if no include has such an address.
        """
        place = self._misspelled_ground
        if place is None:
            return False
        found = self._diagnostics[place]
        self._diagnostics[place] = replace(
            found,
            severity=Severity.ERROR,
            message=f"{found.message} Without it the world has no ground; "
            "the simulation uses `model://ground_plane`.",
        )
        return True

    def robot(self, file: Path) -> Robot | None:
        """The robot of a URDF file that `find` returned, with diagnostics about it."""
        if file not in self._robots and self._read_robot is not None:
            self._robots[file], found = self._read_robot(file)
            self._diagnostics += found
        return self._robots.get(file)

    def path(self, source: Source, uri: str) -> Path | None:
        """The file or folder of an address, whether it exists or not; None if that is unknown.

        A relative path is relative to the folder of the file that it is written in, or to one of
        the folders of models.
        """
        scheme, separator, rest = uri.partition("://")
        if not separator or scheme == "file":
            written = after_scheme(unquote(rest)) if separator else uri
            if source.file is None:
                return Path(written) if Path(written).is_absolute() else None
            beside = source.file.parent.absolute() / written
            # Gazebo also looks for it in the folders of models, or of resources.
            elsewhere = (
                None if is_there(beside) else self._folder(uri if separator else f"model://{uri}")
            )
            return elsewhere or beside
        if scheme in {"http", "https"}:
            address = address_of(uri)
            folder = None if address is None else self._folder(uri)
            inside = "" if address is None else address.inside
        elif scheme in {"model", "package"}:
            name, _, inside = rest.partition("/")
            folder = self._folder(f"model://{name}") if name else None
        else:
            return None
        return folder / inside if folder is not None and inside else folder

    def _folder(self, uri: str) -> Path | None:
        """The folder of a model (or package)."""
        if uri not in self._folders:
            try:
                self._folders[uri] = self._find_model(uri)
            except (OSError, ValueError):  # a name that no folder can have
                self._folders[uri] = None
        return self._folders[uri]

    def _model_in(self, source: Source, *, is_part: bool) -> Element | None:
        """The model in a file: of SDF, or a robot of URDF if that can be read."""
        if source.root.tag == "robot":
            return source.root if self._read_robot is not None and not is_part else None
        return next(children(source.root, "model"), None)

    def _ground_plane(self) -> tuple[Source, Element] | None:
        if self._ground is None:
            self._ground = parse_text(GROUND_PLANE_SDF, None, self._diagnostics)
        return self._ground and (self._ground, self._ground.root[0])

    def _source(self, file: Path) -> Source | None:
        if file not in self._sources:
            source = load(file, self._diagnostics)
            if source is not None and source.root.tag == "sdf":
                source = with_version(source)
            self._sources[file] = source
        return self._sources[file]

    def _model_file(self, source: Source, uri: str) -> Path | str:
        """The SDF file of an address, or the reason why none was found."""
        path = self.path(source, uri)
        if path is None:
            scheme = uri.partition("://")[0]
            return (
                "Gazebo has not downloaded it to this machine yet"
                if scheme in {"http", "https"}
                else "its folder was not found"
            )
        if is_folder(path):
            named = file_of_model(path)
            if named is None:
                kind = irregular_kind(path / "model.config")
                if kind is not None:
                    return f"{path / 'model.config'} is {kind}"
                return f"{path} has no model.config that names a file, and no model.sdf"
            path = named
        return path.resolve() if is_file(path) else f"{path} is {instead_of_file(path)}"


def how_to_find(uri: str) -> str:
    """What to do about a model or mesh that was not found."""
    if not uri:
        return "Write <uri>model://NAME</uri> into it."
    if uri.removeprefix("file://").startswith("/"):
        return OF_ONE_MACHINE
    if "://" not in uri:
        return "Check its spelling and upper and lower case; the path is relative to this file."
    if _is_on_network(uri):
        return (
            f"Download it once with `gz fuel download -u '{uri}'` (Gazebo Fortress: `ign fuel`), "
            "or copy its folder to a folder of GZ_SIM_RESOURCE_PATH, and include model://NAME."
        )
    return WHERE


def elsewhere(uri: str, path: Path | None) -> str | None:
    """The reason where a file of a model is missing because the model is not found."""
    if _is_on_network(uri):
        return DOWNLOADED
    return ELSEWHERE if path is None and uri.startswith("model://") else None


def _is_on_network(uri: str) -> bool:
    return uri.startswith(("http://", "https://"))


def _may_be_elsewhere(uri: str) -> bool:
    """Whether Gazebo also looks for it in folders of models that wsgen may not know."""
    return uri.startswith("model://") or "/" not in uri


def _near_model(source: Source, uri: str) -> str | None:
    """The model that is meant by a `model://NAME` that was not found."""
    scheme, separator, name = uri.partition(":")
    name = name.strip("/")
    models = gazebo_models()
    is_address = uri.startswith("model://")
    if not separator or (is_address and name in models):
        return None
    if scheme != "model" and nearest(scheme, ("model",), cutoff=ALIKE) is None:
        return None
    names = {*models, *(models_around(source.file) if source.file else ())}
    return name if name in names and not is_address else nearest(name, names, cutoff=ALIKE)


def is_sun(uri: str) -> bool:
    """Whether it is the address of Gazebo's sun."""
    return _plain_name(uri) == SUN


def is_ground_plane(uri: str) -> bool:
    """Whether it is the address of Gazebo's ground plane."""
    return _plain_name(uri) == GROUND_PLANE


def _plain_name(uri: str) -> str:
    if ":" in uri and not uri.startswith(SCHEMES):
        return uri
    address = address_of(uri) if "models" in uri else None
    last = uri.rstrip("/").rpartition("/")[2] if address is None else address.name
    return last.lower().replace(" ", "_").replace("%20", "_")


def _why_no_model(file: Path, source: Source | None) -> str:
    if source is None:
        return f"{file} cannot be read"
    if source.root.tag == "robot":
        return f"{file} is a URDF, which only a top-level <include> of the world can use"
    return f"{file} has no <model>"


def _circle(trail: tuple[Path, ...], again: Path) -> str:
    names = [f"{file.parent.name}/{file.name}" for file in (*trail[trail.index(again) :], again)]
    return " → ".join(names)
