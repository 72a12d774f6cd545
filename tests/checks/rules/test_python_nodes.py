"""What ends a Python node with an error is reported, and what may be right is not."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from wsgen.checks.rules.python_nodes import check_node, idle_program, unspun_node
from wsgen.packages.workspace.python_nodes import read_node_file

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic

NODE = """\
import math

import rclpy
from geometry_msgs.msg import TwistStamped
from nav_msgs.msg import Odometry
from rclpy.node import Node
from sensor_msgs.msg import LaserScan
from std_srvs.srv import SetBool


class Patrol(Node):

    def __init__(self):
        super().__init__('patrol')
        self.nearest = math.inf
        self.drive = self.create_publisher(TwistStamped, '/cmd_vel', 10)
        self.create_subscription(LaserScan, '/scan', self.on_scan, 10)
        self.create_subscription(Odometry, '/odom', self.on_odom, 10)
        self.create_service(SetBool, 'pause', self.on_pause)
        self.timer = self.create_timer(0.1, self.tick)

    def on_scan(self, scan):
        self.nearest = min(scan.ranges)

    def on_odom(self, odom):
        self.get_logger().info(str(odom.pose.pose.position.x))

    def on_pause(self, request, response):
        response.success = request.data
        return response

    def tick(self):
        command = TwistStamped()
        command.header.stamp = self.get_clock().now().to_msg()
        command.twist.linear.x = 0.3 if self.nearest > 1 else 0.0
        self.drive.publish(command)


def main():
    rclpy.init()
    rclpy.spin(Patrol())


if __name__ == '__main__':
    main()
"""
WORKSPACE = {"bot": frozenset(), "bot_interfaces": frozenset({"msg/Wheels", "srv/Stop"})}


def check(folder: Path, text: str) -> list[Diagnostic]:
    file = folder / "patrol.py"
    file.write_text(text)
    node = read_node_file(file)
    return (
        []
        if node is None
        else [*check_node(node, WORKSPACE), *idle_program(node), *unspun_node(node)]
    )


def swap(old: str, new: str) -> str:
    assert old in NODE
    return NODE.replace(old, new)


def test_a_sound_node(tmp_path: Path) -> None:
    assert check(tmp_path, NODE) == []


@pytest.mark.parametrize(
    ("old", "new", "code", "line", "hint"),
    [
        ("from geometry_msgs.msg", "from geometry_msg.msg", "PKG105", 4, "`geometry_msgs`"),
        ("import rclpy\n", "import rclpi\n", "PKG105", 3, "`rclpy`"),
        ("import SetBool", "import SetBol", "PKG106", 8, "`SetBool`"),
        ("geometry_msgs.msg import T", "geometry_msgs import T", "PKG106", 4, "geometry_msgs.msg"),
        ("geometry_msgs.msg import T", "geometry_msgs.msgs import T", "PKG106", 4, "s.msg import"),
        ("from nav_msgs.msg", "from geometry_msgs.msg", "PKG106", 5, "nav_msgs.msg.Odometry"),
        (
            "std_srvs.srv import SetBool",
            "bot_interfaces.msg import Stop as SetBool",
            "PKG106",
            8,
            "s.srv.Stop",
        ),
        ("def tick(", "def tik(", "PKG107", 20, "`tik`? Line 32"),
        ("create_subscription(LaserS", "create_subscriber(LaserS", "PKG107", 17, "subscription`"),
        ("if self.nearest", "if self.closest", "PKG107", 35, "self.closest"),
        ("twist.linear", "twist.liner", "PKG108", 35, "`linear`"),
        ("scan.ranges", "scan.range", "PKG108", 23, "`ranges`"),
        ("odom.pose.pose.position", "odom.pose.position", "PKG108", 26, "odom.pose.pose.position"),
        ("response.success", "response.sucess", "PKG108", 29, "`success`"),
        ("request.data", "request.value", "PKG108", 29, "Its fields: data."),
        ("import math\n", "\n", "BLD073", 15, "import math"),
        ("from sensor_msgs.msg import LaserScan\n", "\n", "BLD073", 17, "sensor_msgs.msg import"),
        ("from rclpy.node import Node\n", "\n", "BLD073", 11, "from rclpy.node import Node"),
        ("def main", "def man", "BLD073", 45, "`man`"),
        ("rclpy.spin(Patrol())", "rclpy.spin(Patrol(), true)", "BLD073", 41, "`True`"),
        ("\n\nif __name__ == '__main__':\n    main()\n", "\n", "BLD074", 39, "main()"),
        ("rclpy.spin(Patrol())", "Patrol()", "BLD074", 40, "rclpy.spin(node)"),
        ("linear.x = 0.3 if self.nearest > 1 else 0.0", "linear.x = -1", "PKG110", 35, "x = -1.0"),
        ("def tick(self)", "def tick()", "BLD075", 32, "def tick(self)"),
        ("self.tick)", "self.tick())", "BLD075", 20, "self.tick"),
        ("TwistStamped, '/cmd_vel', 10", "'/cmd_vel', TwistStamped, 10", "BLD075", 16, "TYPE"),
        ("'/cmd_vel', 10)", "'/cmd_vel')", "BLD075", 16, "TOPIC, 10)"),
        ("__init__('patrol')", "__init__()", "BLD075", 14, "'patrol'"),
        ("        super().__init__('patrol')\n", "\n", "BLD075", 13, "super().__init__"),
    ],
)
def test_a_mistake(  # noqa: PLR0917  the facts of a case
    tmp_path: Path, old: str, new: str, code: str, line: int, hint: str
) -> None:
    found = check(tmp_path, swap(old, new))
    assert [(one.code, one.line) for one in found] == [(code, line)]
    assert all(hint in (one.hint or "") for one in found)


USED = "self.nearest > 1"


@pytest.mark.parametrize(
    "edits",
    [
        [("import math\n", "from math import *\n"), ("math.inf", "inf")],
        [("self.nearest = math.inf", "setattr(self, 'near', 9)"), (USED, "self.near > 1")],
        [("self.nearest = math.inf", "exec('far = 9')"), (USED, "far > 1")],
        [
            ("import math\n", "import math\nfrom bot import Mixin\n"),
            ("(Node)", "(Node, Mixin)"),
            (USED, "self.of_mixin"),
        ],
        [("spin(Patrol())", "spin(node := Patrol())\n    node.extra = 1"), (USED, "self.extra")],
        [("rclpy.spin(Patrol())", "rclpy.spin()"), (USED, "self.of_a_class_elsewhere")],
        [(USED, "hasattr(self, 'near') and self.near > 1")],
        [
            ("self.tick)", "self.chosen())"),
            ("def tick", "def chosen(self):\n        return self.tick\n\n    def tick"),
        ],
        [
            ("TwistStamped, '/cmd_vel', 10", "*ARGUMENTS"),
            ("class Pat", "ARGUMENTS = 3\n\nclass Pat"),
        ],
        [("'/cmd_vel', 10)", "'/cmd_vel', qos_profile=10)")],
        [("def on_scan(self, scan):", "def on_scan(self, scan: 'Unknown'):")],
        [("scan.ranges)", "scan.get_fields_and_field_types())")],
        [
            ("self.nearest = min(scan.ranges)", "scan = USED(scan)\n        scan.anything"),
            ("import math\n", "import math\nfrom bot import USED\n"),
        ],
        [
            (
                "import math\n",
                "import math\ntry:\n    import geometry_msg\nexcept ImportError:\n    pass\n",
            )
        ],
        [("import math\n", "import math\nimport rclpy_message_converter\n")],
        [("std_srvs.srv import SetBool", "bot_interfaces.srv import Stop as SetBool")],
        [("class Patrol(Node)", "class Patrol(rclpy.node.Node)")],
        [
            ("    def tick(self):", "    def tock(self):"),
            ("def main", "class Runner(Patrol):\n    def tick(self):\n        pass\n\n\ndef main"),
            ("spin(Patrol())", "spin(Runner() or Patrol())"),
        ],
    ],
)
def test_what_may_be_right(tmp_path: Path, edits: list[tuple[str, str]]) -> None:
    text = NODE
    for old, new in edits:
        assert old in text
        text = text.replace(old, new)
    assert check(tmp_path, text) == []


@pytest.mark.parametrize(
    "ends",
    [
        "while rclpy.ok():\n        rclpy.spin_once(Patrol())",
        "executor = rclpy.executors.SingleThreadedExecutor()\n    executor.add_node(Patrol())",
        "from bot.tools import go\n    go(Patrol())",
        "Patrol().wait_for_pause()",
    ],
)
def test_a_node_that_may_be_spun(tmp_path: Path, ends: str) -> None:
    folder = tmp_path / "bot"
    folder.mkdir()
    found = check(folder, swap("rclpy.spin(Patrol())", ends))
    assert "BLD074" not in [one.code for one in found]
