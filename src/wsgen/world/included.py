"""What `<include>` stands for: a model in another file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import unquote

from wsgen.world.lookup import is_file, is_folder
from wsgen.world.source import load, with_version
from wsgen.xmltree import Malformed, children, parse

if TYPE_CHECKING:
    from collections.abc import Callable

    from wsgen.diagnostics import Diagnostic
    from wsgen.world.source import Source
    from wsgen.xmltree import Element

# Their Fuel addresses end in the same words, with capitals and a blank.
GROUND_PLANE = "ground_plane"
SUN = "sun"

MANIFEST_LIMIT = 2**20  # bytes of a model.config
WHERE = (
    "Put its folder beside this file, or into a folder of GAZEBO_MODEL_PATH (Gazebo Classic) or "
    "GZ_SIM_RESOURCE_PATH (Gazebo Sim)."
)


class Includes:
    """Finds models, and reads every file once."""

    def __init__(
        self, find_model: Callable[[str], Path | None], diagnostics: list[Diagnostic]
    ) -> None:
        self._find_model = find_model
        self._diagnostics = diagnostics
        self._folders: dict[str, Path | None] = {}
        self._sources: dict[Path, Source | None] = {}

    def find(
        self,
        source: Source,
        include: Element,
        uri: str,
        trail: tuple[Path, ...],
        *,
        is_part: bool,
    ) -> tuple[Source, Element] | None:
        """The model of an include and its file; None where it cannot be had, which is reported.

        `trail` are the files that lead here; `is_part` says that it belongs to another model, which
        is incomplete without it.
        """
        found = self._model_file(source, uri)
        if isinstance(found, Path) and found in trail:
            source.error(
                "WLD019",
                f"`{uri}` includes itself ({_circle(trail, found)}).",
                at=include,
                hint="Remove one of the includes of the circle.",
            )
            return None
        if isinstance(found, Path):
            inner = self._source(found)
            model = None if inner is None else next(children(inner.root, "model"), None)
            if inner is not None and model is not None:
                return inner, model
            if inner is not None and next(children(inner.root, "light", "actor"), None) is not None:
                return None  # nothing to touch
            found = f"there is no <model> in {found}" if inner else f"{found} cannot be read"
        # Nobody can have a model without address; others may be where wsgen does not look.
        report = source.error if is_part or not uri else source.warning
        report(
            "WLD004",
            f"The model {uri or '(no uri)'} is not part of the trial: {found}.",
            at=include,
            hint=WHERE,
        )
        return None

    def folder(self, name: str) -> Path | None:
        """The folder of the model (or package) of that name."""
        if name not in self._folders:
            self._folders[name] = self._find_model(f"model://{name}")
        return self._folders[name]

    def path(self, source: Source, uri: str) -> Path | None:
        """The file or folder of an address, whether it is there or not; None for one of a network.

        A path that is not absolute is seen from the folder of the file that it is written in.
        """
        scheme, separator, rest = uri.partition("://")
        if not separator:
            return source.file.parent.absolute() / uri
        if scheme == "file":
            return source.file.parent.absolute() / unquote(rest)
        if scheme not in {"model", "package"}:
            return None
        name, _, inside = rest.partition("/")
        folder = self.folder(name) if name else None
        return folder / inside if folder is not None and inside else folder

    def _source(self, file: Path) -> Source | None:
        if file not in self._sources:
            source = load(file, self._diagnostics)
            if source is not None and source.root.tag == "sdf":
                source = with_version(source)
            self._sources[file] = source
        return self._sources[file]

    def _model_file(self, source: Source, uri: str) -> Path | str:
        """The SDF file of an address, or why there is none."""
        path = self.path(source, uri) if uri else None
        if not uri:
            return "its include says no <uri>"
        if path is None:
            scheme = uri.partition("://")[0]
            return (
                "it is in the network, and wsgen loads nothing from there"
                if scheme in {"http", "https"}
                else "its folder was not found"
            )
        if is_folder(path):
            named = _file_of_model(path)
            if named is None:
                return f"{path} has no model.config that names a file, and no model.sdf"
            path = named
        return path.resolve() if is_file(path) else f"{path} is not there"


def is_sun(uri: str) -> bool:
    """Whether it is the address of Gazebo's sun."""
    return _plain_name(uri) == SUN


def is_ground_plane(uri: str) -> bool:
    """Whether it is the address of Gazebo's ground plane."""
    return _plain_name(uri) == GROUND_PLANE


def _plain_name(uri: str) -> str:
    return uri.rstrip("/").rpartition("/")[2].lower().replace(" ", "_").replace("%20", "_")


def _file_of_model(folder: Path) -> Path | None:
    """The newest SDF file that model.config names, else model.sdf."""
    manifest = folder / "model.config"
    named: list[tuple[tuple[int, ...], str]] = []
    if is_file(manifest) and manifest.stat().st_size <= MANIFEST_LIMIT:
        root = parse(manifest.read_bytes())
        if not isinstance(root, Malformed):
            named = [
                (_digits(sdf.get("version") or ""), (sdf.text or "").strip())
                for sdf in children(root, "sdf")
                if (sdf.text or "").strip()
            ]
    if named:
        return folder / max(named)[1]
    plain = folder / "model.sdf"
    return plain if is_file(plain) else None


def _digits(version: str) -> tuple[int, ...]:
    return tuple(int(part) for part in version.split(".") if part.isascii() and part.isdigit())


def _circle(trail: tuple[Path, ...], again: Path) -> str:
    names = [f"{file.parent.name}/{file.name}" for file in (*trail[trail.index(again) :], again)]
    return " → ".join(names)
