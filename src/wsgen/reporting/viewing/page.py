"""The page in the browser that shows robots: the one place that knows viser.

viser serves a page with a scene of nodes, each placed in its parent, and a panel of inputs. What is
set here is sent to every browser that has the page open.
"""

from __future__ import annotations

import contextlib
import io
import itertools
import logging
import math
import os
import random
import re
import threading
import warnings
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
import viser
import websockets.asyncio.server

from wsgen.model.transform import quaternion_of_rpy
from wsgen.reporting.viewing.drawing import all_positions, glb, place_in_parent, unit_axis
from wsgen.text.printable import clean

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

    from wsgen.model.transform import Pose, Vector
    from wsgen.reporting.viewing.drawing import DrawnLink, DrawnRobot, Quaternion, Slider


Rgb = tuple[int, int, int]

# Layers of the scene: its key -> what the panel calls it, and whether it is shown at first.
LAYERS = {
    "visual": ("Visuals", True),
    "collision": ("Collisions", False),
    "inertia": ("Inertias", False),
    "center": ("Centers of mass", False),
    "frame": ("Frames", False),
    "name": ("Names of links", False),
    "axis": ("Joint axes", False),
}
SEEN_THROUGH = frozenset({"inertia", "center", "frame", "axis"})  # layers that lie within visuals
INERTIA_COLOR: Rgb = (214, 90, 200)
CENTER_COLOR: Rgb = (250, 200, 30)
AXIS_COLOR: Rgb = (0, 150, 170)
INERTIA_OPACITY = 0.55
DIGITS = 6  # after the point, of what a slider shows
LEAST_SIZE = 0.05  # m, of what is framed
FIELD_OF_VIEW = math.radians(45)
CELLS = (0.01, 0.05, 0.1, 0.5, 1.0, 5.0, 10.0)  # m, edges of a square of the grid
CELLS_ALONG = 12  # squares, about, along the robots
GRID_COLOR: Rgb = (205, 209, 214)
SECTION_COLOR: Rgb = (165, 171, 179)
BRAND: Rgb = (34, 112, 190)
TOWARDS_SUN = (3.0, -1.5, 5.0)
BACKGROUND = ((214, 222, 232), (248, 249, 250))  # above, below


class Quiet(viser.ViserServer):
    """The server, without its words on standard output and its link to a public relay."""

    def __init__(self, host: str, port: int, label: str) -> None:
        _say_nothing_of_clients()
        # It prints a panel, whatever its options are.
        with contextlib.redirect_stdout(io.StringIO()), _pages_of_this_machine_alone(host):
            super().__init__(host=host, port=port, label=clean(label), verbose=False)

    def request_share_url(self, verbose: bool = True) -> str | None:  # noqa: ARG002, FBT001, FBT002
        """Refuse to open a tunnel, which any page that is open may ask for."""
        return None

    def stop(self) -> None:
        """Stop, and wait for it."""
        with contextlib.redirect_stdout(io.StringIO()):
            super().stop()


TRACEBACK = "WSGEN_TRACEBACK"  # a variable; set, what clients bring about is printed


def _say_nothing_of_clients() -> None:
    """Print nothing where a client sends what is no message of the page.

    websockets and asyncio log a traceback for each, and viser warns.
    """
    if os.environ.get(TRACEBACK):
        return
    for name in ("websockets.server", "asyncio"):
        logging.getLogger(name).disabled = True
    warnings.filterwarnings("ignore", message=r"\[viser\]")


LOOPBACK = re.compile(r"(localhost|127(\.\d+){3}|::1|\[::1\])")
ORIGINS = (None, re.compile(rf"https?://{LOOPBACK.pattern}(:\d+)?"))  # None: no browser


@contextlib.contextmanager
def _pages_of_this_machine_alone(host: str) -> Iterator[None]:
    """Let a server that is started meanwhile refuse other sites' pages in the user's browser.

    viser takes connections from any page, and a page of any site may connect to this machine.
    A server for other machines takes all.
    """
    serve = websockets.asyncio.server.serve
    if LOOPBACK.fullmatch(host):
        websockets.asyncio.server.serve = partial(serve, origins=ORIGINS)  # type: ignore[assignment,misc]
    try:
        yield
    finally:
        websockets.asyncio.server.serve = serve  # type: ignore[misc]


class Page:
    """A page with robots; a panel for what is shown of them, and for diagnostics."""

    # Where the camera is at first, from the robots: a direction, and how many of their sizes.
    towards_camera = (0.78, -0.52, 0.36)
    distance = 1.6
    world = ""  # the node that all is in

    def __init__(self, *, host: str, port: int, title: str, first_tab: str) -> None:
        self._server = Quiet(host, port, title)
        self._lock = threading.RLock()  # callbacks come from threads of the server
        scene, gui = self._server.scene, self._server.gui
        gui.configure_theme(
            control_width="large", show_logo=False, show_share_button=False, brand_color=BRAND
        )
        gui.main_panel.dock_right()
        scene.configure_environment_map("studio", environment_intensity=0.45)
        scene.configure_default_lights(enabled=False)
        scene.add_light_directional("/sun", intensity=1.7, cast_shadow=True, position=TOWARDS_SUN)
        shades = np.linspace(*BACKGROUND, 64).astype(np.uint8)
        scene.set_background_image(np.repeat(shades[:, None], 2, axis=1), format="png")
        self._robots: list[_RobotNodes] = []
        self._numbers = itertools.count()  # of robots, those that are gone among them
        # Those of the scene, when there is something to look at: at what, and from where.
        self._grid: Any = None
        self._view: tuple[Any, Any] | None = None
        self._summary = gui.add_markdown("")
        tabs = gui.add_tab_group()
        self._first_tab = tabs.add_tab(first_tab)
        self._layers_tab = tabs.add_tab("Layers")
        self._links_tab = tabs.add_tab("Links")
        self._diagnostics_tab = tabs.add_tab("Diagnostics")
        self._layers = dict(self._add_layers(LAYERS))
        with self._layers_tab:
            self._grid_box = gui.add_checkbox("Grid", initial_value=True)
            self._grid_box.on_update(lambda _: self._show_grid())
            self._camera_button = gui.add_button("Look at the robots")
            self._camera_button.on_click(lambda _: self._look_from_here())
        with self._links_tab:
            self._links = gui.add_html("")
        with self._diagnostics_tab:
            self._diagnostics = gui.add_html("")

    @property
    def port(self) -> int:
        """Where it listens."""
        return self._server.get_port()

    @property
    def is_open(self) -> bool:
        """Whether a browser shows it."""
        return bool(self._server.get_clients())

    def stop(self) -> None:
        """End the server; open pages show that."""
        self._server.stop()

    def show(self, robots: Sequence[DrawnRobot], *, links: str) -> None:
        """Show robots instead of those before; one that was among them stays as it is.

        `links` is HTML for the list of links in the panel.
        """
        with self._lock, self._server.atomic():
            known = {id(node.robot): node for node in self._robots}
            shown = {id(robot) for robot in robots}
            for node in self._robots:
                if id(node.robot) not in shown:
                    node.remove()
            self._robots = [known.get(id(robot)) or self._make(robot) for robot in robots]
            for key in LAYERS:
                self._show_layer(key)
            self._links.content = clean(links)
            self._frame(robots)

    def _make(self, robot: DrawnRobot) -> _RobotNodes:
        return _RobotNodes(self._server, f"{self.world}/robots/{next(self._numbers)}", robot)

    def report(self, *, summary: str, diagnostics: str) -> None:
        """Show what is reported: Markdown for the head of the panel, HTML for its list."""
        with self._lock:
            self._summary.content = clean(summary)
            self._diagnostics.content = clean(diagnostics)

    def _add_layers(self, keys: Iterable[str]) -> Iterator[tuple[str, Any]]:
        with self._layers_tab:
            for key in keys:
                label, is_shown = LAYERS[key]
                box = self._server.gui.add_checkbox(label, initial_value=is_shown)
                box.on_update(self._layer_changed(key))
                yield key, box

    def _layer_changed(self, key: str) -> Callable[[object], None]:
        def changed(_event: object) -> None:
            with self._lock, self._server.atomic():
                self._show_layer(key)

        return changed

    def _show_layer(self, key: str) -> None:
        is_faint = any(self._layers[one].value for one in SEEN_THROUGH)
        for node in self._robots:
            node.show_layer(key, is_shown=self._layers[key].value)
            if key in SEEN_THROUGH:
                node.make_faint(is_faint=is_faint)

    def _frame(self, robots: Sequence[DrawnRobot]) -> None:
        """Put the grid under the robots, and the camera of pages that are opened before them."""
        subjects = subjects_of(robots)
        if not subjects:
            return
        low = np.min([robot.low for robot in subjects], axis=0)
        high = np.max([robot.high for robot in subjects], axis=0)
        size = max(float(np.linalg.norm(high - low)), LEAST_SIZE)
        cell = min(CELLS, key=lambda edge: abs(math.log(size / CELLS_ALONG / edge)))
        self._grid = self._server.scene.add_grid(
            f"{self.world}/grid",
            infinite_grid=True,
            cell_size=cell,
            section_size=10 * cell,
            cell_color=GRID_COLOR,
            section_color=SECTION_COLOR,
            fade_distance=7.5 * self.distance * size,
            shadow_opacity=0.25,
            visible=self._grid_box.value,
        )
        middle = (low + high) / 2
        towards = np.array(self.towards_camera) / np.linalg.norm(self.towards_camera)
        reach = self.distance * size
        camera = self._server.initial_camera
        camera.fov = FIELD_OF_VIEW
        camera.near, camera.far = reach / 200, reach * 200
        camera.look_at = middle
        camera.position = middle + reach * towards
        self._view = (middle, middle + reach * towards)

    def _moved(self) -> Any:
        """How far the robots are in the scene from where they were shown first, m."""
        return np.zeros(3)

    def _look_from_here(self) -> None:
        if self._view is None:
            return
        moved = self._moved()
        look_at, position = (point + moved for point in self._view)
        for client in self._server.get_clients().values():
            with client.atomic():
                client.camera.position = position
                client.camera.look_at = look_at

    def _show_grid(self) -> None:
        if self._grid is not None:
            self._grid.visible = self._grid_box.value


def subjects_of(robots: Sequence[DrawnRobot]) -> list[DrawnRobot]:
    """Those that one looks at: the robots, or the models of a world without any."""
    return [robot for robot in robots if not robot.is_static_model] or list(robots)


class JointPage(Page):
    """A page with a slider for each joint."""

    def __init__(self, *, host: str, port: int, title: str) -> None:
        super().__init__(host=host, port=port, title=title, first_tab="Joints")
        self._sliders: dict[tuple[str, str], Any] = {}  # by entity and joint
        self._folders: list[Any] = []  # of the sliders
        gui = self._server.gui
        with self._first_tab:
            buttons = gui.add_button_group("Move all", ("Zero", "Center", "Random"))
            buttons.on_click(lambda event: self.move_all(event.target.value.lower()))
            self._no_joints = gui.add_markdown("No joint can be moved.", visible=False)

    def show(self, robots: Sequence[DrawnRobot], *, links: str) -> None:
        """Show robots instead of those before; joints of the same name keep their positions."""
        with self._lock, self._server.atomic():
            chosen = self.positions()
            super().show(robots, links=links)
            self._replace_sliders(robots, chosen)
            for node in self._robots:
                self._move(node)

    def positions(self) -> dict[tuple[str, str], float]:
        """Where the sliders are: rad or m, by entity and joint."""
        with self._lock:
            return {
                (node.robot.entity, slider.joint): slider.position(handle.value)
                for node in self._robots
                for slider in node.robot.sliders
                if (handle := self._sliders.get((node.robot.entity, slider.joint))) is not None
            }

    def move_all(self, how: str) -> None:
        """Put all joints to "zero" (as far as the limits let them), "center" or "random"."""
        with self._lock, self._server.atomic():
            for node in self._robots:
                for slider in node.robot.sliders:
                    handle = self._sliders[node.robot.entity, slider.joint]
                    position = {
                        "zero": slider.start,
                        "center": slider.middle,
                        "random": random.uniform(slider.lower, slider.upper),  # noqa: S311
                    }[how]
                    handle.value = _shown(slider, position)
                self._move(node)

    def _replace_sliders(
        self, robots: Sequence[DrawnRobot], chosen: dict[tuple[str, str], float]
    ) -> None:
        gui = self._server.gui
        for folder in self._folders:
            folder.remove()
        self._sliders, self._folders = {}, []
        movable = [robot for robot in robots if robot.sliders]
        self._no_joints.visible = not movable
        with self._first_tab:
            for robot in movable:
                folder = gui.add_folder(robot.entity if len(movable) > 1 else None)
                self._folders.append(folder)
                with folder:
                    for slider in robot.sliders:
                        position = chosen.get((robot.entity, slider.joint), slider.start)
                        self._add_slider(robot, slider, position)

    def _add_slider(self, robot: DrawnRobot, slider: Slider, position: float) -> None:
        lower, upper = slider.range_shown
        handle = self._server.gui.add_slider(
            f"{slider.joint}, {slider.unit}",
            min=lower,
            max=upper,
            step=slider.step,
            initial_value=_shown(slider, position),
            disabled=upper <= lower,
            hint=_hint(robot, slider),
        )
        self._sliders[robot.entity, slider.joint] = handle

        def moved(_event: object) -> None:
            with self._lock:
                for node in self._robots:
                    if node.robot.entity == robot.entity:
                        self._move(node)

        handle.on_update(moved)

    def _move(self, node: _RobotNodes) -> None:
        """Put the links where the sliders have the joints."""
        entity = node.robot.entity
        node.move(
            {
                slider.joint: slider.position(handle.value)
                for slider in node.robot.sliders
                if (handle := self._sliders.get((entity, slider.joint))) is not None
            }
        )


class _RobotNodes:
    """The nodes of a robot in the scene: a frame for each link, what is in it below that."""

    def __init__(self, server: viser.ViserServer, path: str, robot: DrawnRobot) -> None:
        self.robot = robot
        self._scene = server.scene
        self._root = path
        self._paths: list[str] = []
        self._frames: list[Any] = []
        self._nodes: dict[str, list[Any]] = {key: [] for key in LAYERS}
        self._visuals: list[tuple[Any, DrawnLink]] = []
        self._places: dict[int, tuple[Any, Quaternion]] = {}  # of links, as they have been sent
        self._is_faint = False
        self._began: Vector | None = None  # where the root was when it was put first
        self.moved: Vector = (0.0, 0.0, 0.0)  # how far it has moved since then, m
        self._length = 0.08 * max(robot.size, LEAST_SIZE)  # m, of an axis of a frame
        x, y, z, w = quaternion_of_rpy(robot.pose_in_world.rpy)
        self._base = self._scene.add_frame(
            self._root, show_axes=False, wxyz=(w, x, y, z), position=robot.pose_in_world.xyz
        )
        for link in robot.links:
            self._add(link)

    def remove(self) -> None:
        """Take it out of the scene, with all that is below."""
        self._base.remove()

    def show_layer(self, key: str, *, is_shown: bool) -> None:
        """Show a layer, or hide it."""
        if key == "frame":
            for frame in self._frames:
                frame.show_axes = is_shown
        if is_shown and not self._nodes[key]:
            self._nodes[key] = list(self._nodes_of(key))
        for node in self._nodes[key]:
            node.visible = is_shown

    def make_faint(self, *, is_faint: bool) -> None:
        """Let see through the visuals, or not."""
        if is_faint == self._is_faint:
            return
        self._is_faint = is_faint
        for handle, link in self._visuals:
            data = glb(link.visuals, is_faint=is_faint)
            if data is not None:
                handle.glb_data = data

    def move(self, chosen: dict[str, float]) -> None:
        """Put the links where these positions of joints have them; sends what has changed."""
        positions = all_positions(self.robot.robot, chosen)
        for number, link in enumerate(self.robot.links):
            if link.joint is None:
                continue
            place = place_in_parent(link.joint, positions.get(link.joint.name, 0.0))
            if self._places.get(number) != place:
                self._places[number] = place
                self._frames[number].position, self._frames[number].wxyz = place

    def put(self, poses: Mapping[str, Pose]) -> None:
        """Put links to poses in the world, of a robot whose links are all roots."""
        for number, link in enumerate(self.robot.links):
            pose = poses.get(link.name)
            if pose is None or not pose.is_finite:
                continue
            if number == 0:
                self._began = self._began or pose.xyz
                (x, y, z), (from_x, from_y, from_z) = pose.xyz, self._began
                self.moved = x - from_x, y - from_y, z - from_z
            x, y, z, w = quaternion_of_rpy(pose.rpy)
            place = (pose.xyz, (w, x, y, z))
            if self._places.get(number) != place:
                self._places[number] = place
                self._frames[number].position, self._frames[number].wxyz = place

    def _add(self, link: DrawnLink) -> None:
        above = self._root if link.parent is None else self._paths[link.parent]
        name = f"{link.name.replace('/', '_')}"
        path = f"{above}/{name}"
        if path in self._paths:
            path = f"{path} {len(self._paths)}"
        self._paths.append(path)
        self._frames.append(
            self._scene.add_frame(
                path,
                show_axes=False,
                axes_length=self._length,
                axes_radius=self._length / 18,
                origin_radius=self._length / 12,
            )
        )

    def _nodes_of(self, key: str) -> Iterator[Any]:
        """The nodes of a layer, for all links; made where it is first shown."""
        for path, link in zip(self._paths, self.robot.links, strict=True):
            node = self._node(key, f"{path}/<{key}>", link)
            if node is not None:
                yield node

    def _node(self, key: str, path: str, link: DrawnLink) -> Any:  # noqa: PLR0911
        if key == "visual":
            data = glb(link.visuals, is_faint=self._is_faint)
            handle = data and self._scene.add_glb(path, data)
            if handle:
                self._visuals.append((handle, link))
            return handle
        if key == "collision":
            data = glb(link.collisions)
            return data and self._scene.add_glb(path, data, cast_shadow=False)
        if key == "inertia" and link.inertia is not None:
            return self._scene.add_box(
                path,
                color=INERTIA_COLOR,
                dimensions=link.inertia.size,
                opacity=INERTIA_OPACITY,
                cast_shadow=False,
                position=link.inertia.center,
                wxyz=link.inertia.orientation,
            )
        if key == "center" and link.center is not None:
            return self._scene.add_icosphere(
                path,
                radius=self._length / 6,
                color=CENTER_COLOR,
                cast_shadow=False,
                position=link.center,
            )
        if key == "name":
            return self._scene.add_label(path, link.name, font_screen_scale=0.8)
        if key == "axis" and link.joint is not None and link.joint.is_movable:
            axis = unit_axis(link.joint)
            if axis is None:
                return None
            tip = np.array(axis) * 1.6 * self._length
            return self._scene.add_arrows(
                path,
                points=np.array([[-tip / 2, tip]]),
                colors=AXIS_COLOR,
                shaft_radius=self._length / 20,
                head_radius=self._length / 8,
                head_length=self._length / 3,
            )
        return None


def _shown(slider: Slider, position: float) -> float:
    """The value of a slider for a position: one that it has."""
    lower, upper = slider.range_shown
    steps = round((slider.shown(position) - lower) / slider.step)
    return float(min(max(round(lower + steps * slider.step, DIGITS), lower), upper))


def _hint(robot: DrawnRobot, slider: Slider) -> str:
    joint = next(one for one in robot.robot.joints if one.name == slider.joint)
    unit = "rad" if slider.is_angle else "m"
    limits = f"{slider.lower:.4g} to {slider.upper:.4g} {unit}"
    if slider.is_endless:
        limits = "without limits"
    follow = f"; moves {', '.join(slider.followers)}" if slider.followers else ""
    return f"{joint.type.value}, {limits}; {joint.parent} to {joint.child}{follow}"
