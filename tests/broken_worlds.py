"""Worlds that are wrong, and what happens in the child process that reads one."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsgen.descriptions.sdf.lookup import model_finder
from wsgen.descriptions.sdf.models import read_sdf

if TYPE_CHECKING:
    from collections.abc import Callable


MASS = "<inertial><mass>2</mass></inertial>"
LINK = f'<link name="l">{MASS}</link>'
GROUND = "<include><uri>model://ground_plane</uri></include>"


def read(file: str) -> dict[str, Any]:
    """Read a file; the models of its includes are beside it."""
    found = read_sdf(Path(file), find_model=model_finder(Path(file), {}))
    return {
        "codes": sorted({one.code for one in found.diagnostics}),
        "count": len(found.diagnostics),
        "are_clear": all(one.message and one.hint and one.file for one in found.diagnostics),
        "models": len(found.models),
        "links": sum(len(one.robot.links) for one in found.models if one.robot),
    }


def world(content: str, version: str = "1.9") -> str:
    """A world with a ground."""
    return f'<sdf version="{version}"><world name="w">{GROUND}{content}</world></sdf>'


def model(content: str) -> str:
    """A model in a file of its own."""
    return f'<sdf version="1.9"><model name="m">{content}</model></sdf>'


def include(uri: str) -> str:
    """An include of a model."""
    return f"<include><uri>{uri}</uri></include>"


def _write(folder: Path, content: str | bytes) -> None:
    data = content.encode() if isinstance(content, str) else content
    (folder / "w.sdf").write_bytes(data)


def _circle(folder: Path) -> None:
    for name, other in ("ab", "ba"):
        (folder / name).mkdir()
        (folder / name / "model.sdf").write_text(model(LINK + include(f"model://{other}")))
    _write(folder, world(include("model://a")))


def _doubling(folder: Path) -> None:
    """Each model includes the next one twice: a billion of them if nobody counts."""
    for i in range(30):
        (folder / f"m{i}").mkdir()
        twice = "".join(
            include(f"model://m{i + 1}").replace("</uri>", f"</uri><name>{name}</name>")
            for name in "ab"
        )
        (folder / f"m{i}" / "model.sdf").write_text(model(LINK + twice))
    _write(folder, world(include("model://m0")))


def _special(*, included: bool) -> Callable[[Path], None]:
    def make(folder: Path) -> None:
        os.mkfifo(folder / ("pipe.sdf" if included else "w.sdf"))
        if included:
            _write(folder, world(include("pipe.sdf")))

    return make


def _folder(*, included: bool) -> Callable[[Path], None]:
    def make(folder: Path) -> None:
        (folder / ("empty" if included else "w.sdf")).mkdir()
        if included:
            _write(folder, world(include("model://empty")))

    return make


def _text(content: str | bytes | Callable[[], str]) -> Callable[[Path], None]:
    """A file of this content, which is made with the file if it is large."""
    return lambda folder: _write(folder, content() if callable(content) else content)


def _repeated(content: bytes, megabytes: int) -> Callable[[Path], None]:
    return lambda folder: _write(folder, content * (megabytes * 2**20 // len(content)))


def _entities() -> str:
    """A billion laughs."""
    declared = '<!ENTITY e0 "ha">' + "".join(
        f'<!ENTITY e{i} "{f"&e{i - 1};" * 10}">' for i in range(1, 10)
    )
    return f"<!DOCTYPE sdf [{declared}]>" + world(f'<model name="m">{LINK}<x>&e9;</x></model>')


def _shape(content: str) -> str:
    return f'<collision name="c"><geometry>{content}</geometry></collision>'


def _models(count: int) -> str:
    return "".join(f'<model name="m{i}">{LINK}</model>' for i in range(count))


def _links(count: int) -> str:
    return "".join(f'<link name="l{i}">{MASS}</link>' for i in range(count))


def _pose(numbers: str) -> str:
    return model(f'<link name="l">{MASS}<pose>{numbers}</pose></link>')


def _frames(count: int) -> str:
    return "".join(
        f'<frame name="f{i}"><pose relative_to="f{i + 1}">0 0 1 0 0 0</pose></frame>'
        for i in range(count)
    )


NEST = '<model name="m">'
NUMBERS = "<pose>{0} 0 0 0 0 0</pose>" + MASS + _shape("<sphere><radius>{0}</radius></sphere>")

# How to make the file `w.sdf` in a folder, what is found in it, and how many models remain.
CASES: dict[str, tuple[Callable[[Path], None], set[str], int]] = {
    "unknown model": (_text(world(include("model://nowhere"))), {"WLD004"}, 0),
    "model of Fuel": (_text(world(include("https://fuel.x/1.0/a/models/b"))), {"WLD004"}, 0),
    "include of nothing": (_text(world("<include/>")), {"WLD004"}, 0),
    "circle of includes": (_circle, {"WLD019"}, 1),
    "includes without end": (_doubling, {"WLD004", "WLD014"}, 1),
    "no ground": (_text('<sdf version="1.9"><world name="w"/></sdf>'), {"WLD006"}, 0),
    "no gravity": (_text(world("<gravity>0 0 0</gravity>")), {"WLD045"}, 0),
    "gravity upwards": (_text(world("<gravity>0 0 9.8</gravity>")), {"WLD045"}, 0),
    "SDF 1.13": (_text(world("", "1.13")), {"WLD012"}, 0),
    "SDF 2.0": (_text(world("", "2.0")), {"WLD012"}, 0),
    "10,000 models": (_text(lambda: world(_models(10_000))), set(), 10_000),
    "60,001 links": (_text(lambda: model(_links(60_001))), {"WLD014"}, 1),
    "0 bytes": (_text(""), {"ROB001"}, 0),
    "not XML": (_text("world: {name: w}"), {"ROB001"}, 0),
    "binary": (_text(bytes(range(256))), {"ROB057"}, 0),
    "a URDF": (_text('<robot name="r"><link name="l"/></robot>'), {"WLD003"}, 0),
    "folder": (_folder(included=False), {"ROB072"}, 0),
    "folder as model": (_folder(included=True), {"WLD004"}, 0),
    "FIFO": (_special(included=False), {"ROB072"}, 0),
    "FIFO as model": (_special(included=True), {"WLD004"}, 0),
    "itself as model": (_text(world(include("w.sdf"))), {"WLD019"}, 0),
    "device as model": (_text(world(include("/dev/zero"))), {"WLD004"}, 0),
    "models in models": (
        _text(f'<sdf version="1.9">{NEST * 1000}{"</model>" * 1000}</sdf>'),
        {"ROB001"},
        0,
    ),
    "frames on frames": (
        _text(lambda: world(f'<model name="m">{LINK}{_frames(20_000)}</model>')),
        {"WLD016"},
        1,
    ),
    "billion laughs": (_text(_entities()), {"WLD046"}, 0),
    "NaN": (_text(model(f'<link name="l">{NUMBERS.format("nan")}</link>')), {"ROB016"}, 1),
    "infinity": (_text(model(f'<link name="l">{NUMBERS.format("inf")}</link>')), {"ROB016"}, 1),
    "huge numbers": (
        _text(model(f'<link name="l">{NUMBERS.format("1e300")}</link>')),
        {"ROB016", "WLD034"},
        1,
    ),
    "endless number": (_text(lambda: _pose("9" * 5_000_000)), {"ROB016"}, 1),
    "endless pose": (_text(lambda: _pose(f"{'9' * 300} " * 30_000)), {"ROB016"}, 1),
    "two of one name": (_text(model(LINK + LINK)), {"WLD015"}, 1),
    "100 MB": (_repeated(b" ", 100), {"ROB002"}, 0),
    "30 MB of comments": (_repeated(b"<!--", 30), {"ROB001"}, 0),
    "UTF-16": (_text(world("").encode("utf-16")), {"ROB057"}, 0),
    "long names": (
        _text(world(include(f"model://{'x' * 100_000}"))),
        {"WLD004"},
        0,
    ),
}
