"""What ends a Python node with an error: names, members, messages and calls that do not exist."""

from __future__ import annotations

import ast
import builtins
import sys
from typing import TYPE_CHECKING

from wsgen.diagnostics import Rule, Severity
from wsgen.packages.imported_packages import certain_nodes, is_beside, misspelled_module, name_of
from wsgen.packages.workspace.python_nodes import KINDS, PARAMETERS, arguments_of
from wsgen.ros.environment.interfaces import common_packages, fields_of
from wsgen.text.pythontree import is_text
from wsgen.text.suggestions import advice, ask_for_nearest, did_you_mean, nearest, suggested
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Mapping

    from wsgen.diagnostics import Diagnostic
    from wsgen.packages.workspace.python_nodes import NodeClass, NodeFile


OF_MODULE = "a warning in a module that no program of the package uses"
MISSPELLED_IMPORT = Rule(
    code="PKG105",
    name="misspelled-import",
    severity=Severity.ERROR,
    severity_varies=OF_MODULE,
    summary="A node imports a ROS package by a misspelled name.",
    what="Looks for imports of installed Python files that neither Python nor the workspace "
    "provides.",
    why="The node exits with a `ModuleNotFoundError` when it is started.",
    example="from geometry_msg.msg import Twist",
    instead="from geometry_msgs.msg import Twist",
)
UNKNOWN_MESSAGE = Rule(
    code="PKG106",
    name="unknown-message",
    severity=Severity.ERROR,
    severity_varies=OF_MODULE,
    summary="A node imports a message, service or action that its package does not have.",
    what="Checks the interfaces of packages that all distributions have, and those of the "
    "workspace.",
    why="The node exits with an `ImportError` when it is started.",
    example="from geometry_msgs.msg import Odometry",
    instead="from nav_msgs.msg import Odometry",
)
UNKNOWN_MEMBER = Rule(
    code="PKG107",
    name="unknown-member",
    severity=Severity.ERROR,
    severity_varies=OF_MODULE,
    summary="A node uses a method or an attribute of `self` that does not exist.",
    what="Checks node classes whose base classes are all known, and which do not set attributes by "
    "computed names.",
    why="The node ends with an `AttributeError` when it comes to this line.",
    example="self.create_timer(0.1, self.tick)  # def tik(self)",
    instead="self.create_timer(0.1, self.tick)  # def tick(self)",
)
UNKNOWN_FIELD = Rule(
    code="PKG108",
    name="unknown-field",
    severity=Severity.ERROR,
    severity_varies=OF_MODULE,
    summary="A node uses a field that a message does not have.",
    what="Checks the messages that a function creates and that callbacks receive.",
    why="The node ends with an `AttributeError` when it comes to this line.",
    example="command = Twist()\ncommand.liner.x = 0.2",
    instead="command = Twist()\ncommand.linear.x = 0.2",
)
WHOLE_NUMBER = Rule(
    code="PKG110",
    name="integer-for-float",
    severity=Severity.ERROR,
    severity_varies=OF_MODULE,
    summary="A node assigns an integer to a field of a message that holds a float.",
    what="Checks the fields of vectors, points and quaternions of geometry_msgs.",
    why="Up to Iron, the node ends with an `AssertionError`: The 'x' field must be of type "
    "'float'. Later distributions check nothing and send another number.",
    example="command = Twist()\ncommand.linear.x = 1",
    instead="command = Twist()\ncommand.linear.x = 1.0",
)
UNDEFINED_NAME = Rule(
    code="BLD073",
    name="undefined-name-in-node",
    severity=Severity.ERROR,
    severity_varies=OF_MODULE,
    summary="A node uses a name that its file neither defines nor imports.",
    why="The node exits with a `NameError` when it reaches this line.",
    example="self.create_subscription(LaserScan, 'scan', self.on_scan, 10)  # not imported",
    instead="from sensor_msgs.msg import LaserScan",
)
IDLE_PROGRAM = Rule(
    code="BLD074",
    name="idle-program",
    severity=Severity.WARNING,
    summary="A Python program does not call its `main()`, or does not spin its node.",
    what="Reads programs that are installed. A node counts as not spun where its file has "
    "callbacks, but neither a loop nor a call that may wait or spin.",
    why="The program exits at once without an error, and does nothing.",
    example="#!/usr/bin/env python3\ndef main():\n    rclpy.init()",
    instead="#!/usr/bin/env python3\ndef main():\n    rclpy.init()\n\n\n"
    "if __name__ == '__main__':\n    main()",
)
INVALID_NODE_CALL = Rule(
    code="BLD075",
    name="invalid-node-call",
    severity=Severity.ERROR,
    severity_varies=OF_MODULE,
    summary="A node calls a method of `rclpy` with wrong arguments.",
    what="Checks the arguments of `create_publisher()`, `create_subscription()`, "
    "`create_service()`, `create_client()` and `create_timer()`, and reports callbacks that are "
    "called instead of passed, `super().__init__()` without the node name, and methods without "
    "`self`.",
    why="The node exits with a `TypeError` or an `AttributeError`.",
    example="self.timer = self.create_timer(0.1, self.tick())",
    instead="self.timer = self.create_timer(0.1, self.tick)",
)


def check_node(node: NodeFile, workspace: Mapping[str, Collection[str]]) -> Iterator[Diagnostic]:
    """Check a Python file that is installed.

    Args:
        node: The file.
        workspace: Names of the packages of the workspace, with their interfaces: "msg/Wheels".
    """
    imports = (*misspelled_imports(node, workspace), *unknown_interfaces(node, workspace))
    yield from imports
    meant = {(suggested(one.hint) or "").rpartition(".")[2] for one in imports}
    yield from undefined_names(node, meant)
    for one in node.node_classes:
        yield from unknown_members(node, one)
        yield from invalid_calls(node, one)
    yield from unknown_fields(node)


def misspelled_imports(node: NodeFile, workspace: Collection[str]) -> Iterator[Diagnostic]:
    """Report modules that are surely meant to be those of a ROS package."""
    for one in certain_nodes(node.tree, []):
        if isinstance(one, ast.Import):
            modules = [alias.name for alias in one.names]
        elif isinstance(one, ast.ImportFrom) and one.module and not one.level:
            modules = [one.module]
        else:
            continue
        for module in modules:
            top = module.partition(".")[0]
            if is_beside(top, node.file):
                continue
            meant = misspelled_module(top, workspace)
            if meant is not None:
                yield MISSPELLED_IMPORT.at(
                    node.file,
                    one.lineno,
                    top,
                    message=f"{node.file.name} imports the Python module `{top}`, which no package "
                    "has.",
                    hint=did_you_mean(meant),
                )


def unknown_interfaces(
    node: NodeFile, workspace: Mapping[str, Collection[str]]
) -> Iterator[Diagnostic]:
    """Report messages, services and actions that their package does not have."""
    for one in certain_nodes(node.tree, []):
        if not isinstance(one, ast.ImportFrom) or not one.module or one.level:
            continue
        package, _, kind = one.module.partition(".")
        known = workspace.get(package) or fields_of(package)
        if known is None or not known or is_beside(package, node.file):
            continue
        for alias in one.names:
            name = alias.name
            if kind not in KINDS:
                right = [each for each in KINDS if f"{each}/{name}" in known]
                if right:
                    yield UNKNOWN_MESSAGE.at(
                        node.file,
                        one.lineno,
                        name,
                        message=f"{one.module} has no `{name}`: it is in {package}.{right[0]}.",
                        hint=f"Write: from {package}.{right[0]} import {name}",
                    )
            elif f"{kind}/{name}" not in known and name != "*":
                meant = _meant_interface(package, kind, name, known)
                if meant is not None:
                    yield UNKNOWN_MESSAGE.at(
                        node.file,
                        one.lineno,
                        name,
                        message=f"{package} has no {kind}/{name}.",
                        hint=did_you_mean(meant),
                    )


def _meant_interface(package: str, kind: str, name: str, known: Collection[str]) -> str | None:
    own = [each.partition("/")[2] for each in known if each.startswith(f"{kind}/")]
    for other in common_packages():
        if other != package and f"{kind}/{name}" in (fields_of(other) or ()):
            return f"{other}.{kind}.{name}"
    for each in KINDS:
        if f"{each}/{name}" in known:
            return f"{package}.{each}.{name}"
    return nearest(name, [each for each in own if "." not in each], cutoff=0.75)


# Of modules, and of Python 2, which files ask for after looking at the version.
_KNOWN = frozenset(dir(builtins)) | {
    *("__file__", "__name__", "__doc__", "__package__", "__spec__", "__loader__", "__path__"),
    *("__annotations__", "__builtins__", "__class__", "WindowsError", "unicode", "raw_input"),
    *("basestring", "xrange", "long", "unichr", "reduce", "execfile", "file", "cmp", "reload"),
}


def undefined_names(node: NodeFile, imported: Collection[str] = ()) -> Iterator[Diagnostic]:
    """Report names that nothing in the file defines, at their first use.

    `imported` are names that a misspelled import would define.
    """
    known = _defined_names(node)
    if known is None:
        return
    not_evaluated = {
        id(name)
        for one in node.nodes
        for annotation in (getattr(one, "annotation", None), getattr(one, "returns", None))
        if annotation is not None
        for name in ast.walk(annotation)
    }
    used: dict[str, int] = {}
    for one in node.nodes:
        if isinstance(one, ast.Name) and one.id not in known and id(one) not in not_evaluated:
            used[one.id] = min(one.lineno, used.get(one.id, one.lineno))
    for name, line in used.items():
        if name not in imported:
            yield UNDEFINED_NAME.at(
                node.file,
                line,
                name,
                message=f"The name `{name}` is not defined: {node.file.name} neither defines nor "
                "imports it.",
                hint=_how_to_define(name, known),
            )


def _defined_names(node: NodeFile) -> set[str] | None:
    """All names that a file defines anywhere; None where it may define others, too."""
    known = set(_KNOWN)
    for one in node.nodes:
        if isinstance(one, ast.Name):
            if not isinstance(one.ctx, ast.Load):
                known.add(one.id)
        elif isinstance(one, (ast.Import, ast.ImportFrom)):
            known.update(alias.asname or alias.name.partition(".")[0] for alias in one.names)
        elif isinstance(one, ast.arg):
            known.add(one.arg)
        elif isinstance(one, (ast.Global, ast.Nonlocal)):
            known.update(one.names)
        elif not isinstance(one, ast.alias):  # functions, classes, exceptions, patterns
            known.update(filter(None, (getattr(one, key, None) for key in ("name", "rest"))))
        if _hides_names(one):
            return None
    return None if "*" in known else known


def _hides_names(node: ast.AST) -> bool:
    """Whether names may be defined where nobody sees it, or their absence is expected."""
    if isinstance(node, ast.ExceptHandler):
        return node.type is None or "NameError" in ast.unparse(node.type)
    return isinstance(node, ast.Call) and name_of(node.func) in {"exec", "globals", "locals"}


_OF_MODULES = {
    "Node": "rclpy.node",
    "LifecycleNode": "rclpy.lifecycle",
    "MultiThreadedExecutor": "rclpy.executors",
    "SingleThreadedExecutor": "rclpy.executors",
    "ReentrantCallbackGroup": "rclpy.callback_groups",
    "MutuallyExclusiveCallbackGroup": "rclpy.callback_groups",
    "ActionClient": "rclpy.action",
    "ActionServer": "rclpy.action",
    "Parameter": "rclpy.parameter",
    "Duration": "rclpy.duration",
    "Time": "rclpy.time",
    "QoSProfile": "rclpy.qos",
    "ReliabilityPolicy": "rclpy.qos",
    "DurabilityPolicy": "rclpy.qos",
    "HistoryPolicy": "rclpy.qos",
    "qos_profile_sensor_data": "rclpy.qos",
}
_MODULES = {"np": "numpy as np", "plt": "matplotlib.pyplot as plt", "cv2": "cv2"}


def _how_to_define(name: str, known: Collection[str]) -> str:
    if name in _OF_MODULES:
        return f"Add: from {_OF_MODULES[name]} import {name}"
    if name in _MODULES or name in sys.stdlib_module_names or name == "rclpy":
        return f"Add: import {_MODULES.get(name, name)}"
    packages = [
        package for package in common_packages() if f"msg/{name}" in (fields_of(package) or ())
    ]
    if packages:
        return f"Add: from {packages[0]}.msg import {name}"
    # Of Python's own names only `True` for `true`.
    own = [one for one in known if one not in _KNOWN or one.casefold() == name.casefold()]
    return advice(name, own, f"Define `{name}`, or import it.", cutoff=0.7)


# Members of rclpy's Node. Source: ros2/rclpy, Humble to Rolling.
_OF_NODE = frozenset(
    """
    PARAM_REL_TOL add_on_set_parameters_callback add_post_set_parameters_callback
    add_pre_set_parameters_callback add_waitable clients context count_clients count_publishers
    count_services count_subscribers create_client create_guard_condition create_publisher
    create_rate create_service create_subscription create_timer declare_parameter
    declare_parameters default_callback_group describe_parameter describe_parameters
    destroy_client destroy_guard_condition destroy_node destroy_publisher destroy_rate
    destroy_service destroy_subscription destroy_timer executor
    get_client_names_and_types_by_node get_clock get_fully_qualified_name
    get_fully_qualified_node_names get_logger get_name get_namespace get_node_names
    get_node_names_and_namespaces get_node_names_and_namespaces_with_enclaves get_parameter
    get_parameter_or get_parameter_type get_parameter_types get_parameters
    get_parameters_by_prefix get_publisher_names_and_types_by_node get_publishers_info_by_topic
    get_service_names_and_types get_service_names_and_types_by_node
    get_servers_info_by_service get_clients_info_by_service
    get_subscriber_names_and_types_by_node get_subscriptions_info_by_topic
    get_topic_names_and_types guards handle has_parameter list_parameters publishers
    remove_on_set_parameters_callback remove_post_set_parameters_callback
    remove_pre_set_parameters_callback remove_waitable resolve_service_name resolve_topic_name
    services set_descriptor set_parameters set_parameters_atomically subscriptions timers
    undeclare_parameter wait_for_node waitables set_parameters_callback
    """.split()  # noqa: SIM905  so many
)
_OF_LIFECYCLE_NODE = frozenset(
    """
    add_managed_entity create_lifecycle_publisher destroy_lifecycle_publisher on_activate
    on_cleanup on_configure on_deactivate on_error on_shutdown trigger_activate trigger_cleanup
    trigger_configure trigger_deactivate trigger_shutdown
    """.split()  # noqa: SIM905  so many
)


def unknown_members(node: NodeFile, one: NodeClass) -> Iterator[Diagnostic]:
    """Report members of a class that it does not have, at their first use."""
    of_rclpy = _OF_NODE | _OF_LIFECYCLE_NODE if one.is_lifecycle else _OF_NODE
    tested = _tested_members(one.definition)
    seen: set[str] = set()
    for use in _own_attributes(one.definition):
        name = use.attr
        # Names that begin like this are of rclpy, too, and not the same in all versions.
        if name in seen or name in one.members or name in of_rclpy or name.startswith("_"):
            continue
        if name in tested:
            continue
        seen.add(name)
        near = nearest(name, {*one.members, *of_rclpy}, cutoff=0.7)
        yield UNKNOWN_MEMBER.at(
            node.file,
            use.lineno,
            f"{one.definition.name}.{name}",
            message=f"`{one.definition.name}` has no method or attribute `{name}`.",
            hint=_where(near, one)
            if near
            else f"Define it: def {name}(self, ...), or set self.{name} in __init__().",
        )


def _where(near: str, one: NodeClass) -> str:
    method = one.methods.get(near)
    where = f" Line {method.lineno} defines it." if method is not None else ""
    return did_you_mean(near) + where


def _own_attributes(definition: ast.ClassDef) -> list[ast.Attribute]:
    """The uses of attributes of self, by line; not those in classes that are inside."""
    found: list[ast.Attribute] = []
    left: list[ast.AST] = [*definition.body]
    while left:
        node = left.pop()
        if isinstance(node, ast.ClassDef):
            continue
        if (
            isinstance(node, ast.Attribute)
            and isinstance(node.ctx, ast.Load)
            and isinstance(node.value, ast.Name)
            and node.value.id == "self"
        ):
            found.append(node)
        left += ast.iter_child_nodes(node)
    return sorted(found, key=lambda use: (use.lineno, use.col_offset))


def _tested_members(definition: ast.ClassDef) -> set[object]:
    """Names that the class asks for before it uses them, or whose absence it expects."""
    found: set[object] = set()
    for node in ast.walk(definition):
        if isinstance(node, ast.Call) and name_of(node.func) in {"hasattr", "getattr"}:
            found |= {one.value for one in node.args[1:2] if isinstance(one, ast.Constant)}
        elif isinstance(node, ast.Try):
            found |= {one.attr for one in ast.walk(node) if isinstance(one, ast.Attribute)}
    return found


def invalid_calls(node: NodeFile, one: NodeClass) -> Iterator[Diagnostic]:
    """Report calls of methods of Node that end in an error."""
    for call in ast.walk(one.definition):
        if not isinstance(call, ast.Call):
            continue
        name = name_of(call.func)
        if name in PARAMETERS and name not in one.methods and _is_of_self(call.func):
            yield from _arguments(node, one, call, name)
    yield from _unnamed(node, one)
    for method in one.definition.body:
        if isinstance(method, ast.FunctionDef) and not method.decorator_list:
            own = method.args
            if not (own.posonlyargs or own.args or own.vararg):
                yield INVALID_NODE_CALL.at(
                    node.file,
                    method.lineno,
                    f"{one.definition.name}.{method.name}",
                    message=f"The method `{method.name}()` has no parameter `self`: each call of "
                    "it ends with a TypeError.",
                    hint=f"Write: def {method.name}(self):",
                )


def _is_of_self(func: ast.expr) -> bool:
    return isinstance(func, ast.Attribute) and name_of(func.value) == "self"


def _arguments(node: NodeFile, one: NodeClass, call: ast.Call, name: str) -> Iterator[Diagnostic]:
    if any(isinstance(each, ast.Starred) for each in call.args) or any(
        each.arg is None for each in call.keywords
    ):
        return
    wanted = PARAMETERS[name]
    given = arguments_of(call)
    usage = f"Write self.{name}({', '.join(_SHOWN.get(each, each.upper()) for each in wanted)})."
    first, second = given.get(wanted[0]), given.get(wanted[1])
    if wanted[0].endswith("_type") and _is_text(first) and not _is_text(second):
        yield INVALID_NODE_CALL.at(
            node.file,
            call.lineno,
            name,
            message=f"Swap them: the first argument of {name}() is the type, the second one is the "
            "name.",
            hint=usage,
        )
        return
    lacking = [each for each in wanted if each not in given]
    if lacking:
        yield INVALID_NODE_CALL.at(
            node.file,
            call.lineno,
            name,
            message=f"{name}() lacks its argument `{lacking[0]}`.",
            hint=usage,
        )
    callback = given.get("callback")
    if isinstance(callback, ast.Call) and _is_of_self(callback.func):
        method = one.methods.get(name_of(callback.func))
        if method is not None and not _returns_value(method):
            text = ast.unparse(callback.func)
            yield INVALID_NODE_CALL.at(
                node.file,
                callback.lineno,
                name,
                message=f"{name}() gets the result of `{text}()`, which is None, instead of the "
                "method.",
                hint=f"Remove the parentheses: {text}",
            )


_SHOWN = {"qos_profile": "10", "callback": "self.CALLBACK", "timer_period_sec": "SECONDS"}


def _is_text(node: ast.expr | None) -> bool:
    return isinstance(node, (ast.JoinedStr)) or (
        isinstance(node, ast.Constant) and isinstance(node.value, str)
    )


def _returns_value(method: ast.FunctionDef) -> bool:
    return any(
        (isinstance(node, ast.Return) and node.value is not None)
        or isinstance(node, (ast.Yield, ast.YieldFrom))
        for node in ast.walk(method)
    )


def _unnamed(node: NodeFile, one: NodeClass) -> Iterator[Diagnostic]:
    """Report a node that gives rclpy no name, or does not call it at all."""
    made = one.methods.get("__init__")
    bases = {ast.unparse(base).rpartition(".")[2] for base in one.definition.bases}
    if made is None or made not in one.definition.body or not bases <= {"Node", "LifecycleNode"}:
        return
    calls = [
        call
        for call in ast.walk(made)
        if isinstance(call, ast.Call)
        and isinstance(call.func, ast.Attribute)
        and call.func.attr == "__init__"
    ]
    example = f"super().__init__('{one.definition.name.lower()}')"
    if not calls:
        yield INVALID_NODE_CALL.at(
            node.file,
            made.lineno,
            one.definition.name,
            message=f"`{one.definition.name}.__init__()` does not call `__init__()` of rclpy's "
            "Node.",
            hint=f"Add as its first line: {example}",
        )
    for call in calls:
        assert isinstance(call.func, ast.Attribute)  # noqa: S101  as chosen above
        is_super = isinstance(call.func.value, ast.Call)
        if len(call.args) < (1 if is_super else 2) and not call.keywords:
            yield INVALID_NODE_CALL.at(
                node.file,
                call.lineno,
                one.definition.name,
                message="The call of rclpy's Node lacks the argument `node_name`.",
                hint=f"Write: {example}",
            )


def idle_program(node: NodeFile) -> Iterator[Diagnostic]:
    """Report a program that defines main() and does nothing."""
    mains = [
        one for one in node.tree.body if isinstance(one, ast.FunctionDef) and one.name == "main"
    ]
    if mains and all(isinstance(one, _IDLE) or is_text(one) for one in node.tree.body):
        yield IDLE_PROGRAM.at(
            node.file,
            mains[0].lineno,
            "main",
            message=f"{node.file.name} defines main() but does not call it: the program exits at "
            "once and does nothing.",
            hint="Add at the end of the file: if __name__ == '__main__': main()",
        )


def unspun_node(node: NodeFile) -> Iterator[Diagnostic]:
    """Report a program that ends when it has made its node, before a callback is called."""
    calls = [one for one in node.nodes if isinstance(one, ast.Call)]
    called = {name_of(one.func): one for one in calls}
    starts = next((one for one in calls if ast.unparse(one.func) == "rclpy.init"), None)
    if (
        starts is None
        or not _HAVE_CALLBACKS.intersection(called)
        or any(isinstance(one, (ast.While, ast.Await)) for one in node.nodes)
        or any(_MAY_WAIT.search(name) for name in called)
        or any(_MAY_WAIT.search(word) for word in node.imported)
        or any(_is_of_package(one, node.file.parent.name) for one in node.nodes)
    ):
        return
    yield IDLE_PROGRAM.at(
        node.file,
        starts.lineno,
        "rclpy.init",
        message=f"{node.file.name} makes a node with callbacks, but does not spin it: the program "
        "exits before a callback is called.",
        hint="Add after the node is made: rclpy.spin(node)",
    )


def _is_of_package(one: ast.AST, package: str) -> bool:
    """Whether something of the same package is imported, which may spin."""
    if isinstance(one, ast.ImportFrom):
        return bool(one.level) or (one.module or "").partition(".")[0] == package
    return isinstance(one, ast.Import) and any(
        name.name.partition(".")[0] == package for name in one.names
    )


_HAVE_CALLBACKS = frozenset(("create_subscription", "create_timer", "create_service"))
_MAY_WAIT = lazy_pattern(
    r"(?i)spin|execut|thread|loop|wait|sleep|exec|input|join|run|start|serve|process|gui|show"
)
_IDLE = (
    *(ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef, ast.Import, ast.ImportFrom),
    *(ast.Assign, ast.AnnAssign),
)


def unknown_fields(node: NodeFile) -> Iterator[Diagnostic]:
    """Report fields that messages do not have."""
    callbacks = _types_of_callbacks(node)
    for function in node.nodes:
        if isinstance(function, (ast.FunctionDef, ast.AsyncFunctionDef)):
            types = _types_in(node, function, callbacks)
            if types:
                yield from _unknown_fields(node, function, types)
                yield from _whole_numbers(node, function, types)


def _types_of_callbacks(node: NodeFile) -> dict[str, tuple[str, ...]]:
    """The types of what methods are called with, after self; of those with one use alone."""
    found: dict[str, set[tuple[str, ...]]] = {}
    for call in node.nodes:
        if not isinstance(call, ast.Call):
            continue
        name = name_of(call.func)
        if name not in {"create_subscription", "create_service"}:
            continue
        given = arguments_of(call)
        callback = given.get("callback")
        type_ = node.interface(given.get("msg_type") or given.get("srv_type"))
        if isinstance(callback, ast.Attribute) and name_of(callback.value) == "self":
            parts = ("",) if name == "create_subscription" else (".Request", ".Response")
            types = tuple(f"{type_}{part}" for part in parts) if type_ else ()
            found.setdefault(callback.attr, set()).add(types)
    return {name: next(iter(types)) for name, types in found.items() if len(types) == 1}


def _types_in(
    node: NodeFile,
    function: ast.FunctionDef | ast.AsyncFunctionDef,
    callbacks: Mapping[str, tuple[str, ...]],
) -> dict[str, str]:
    """The types of the variables of a function that surely are messages."""
    arguments = [one.arg for one in function.args.args if one.arg != "self"]
    given = callbacks.get(function.name, ()) if len(function.args.args) > len(arguments) else ()
    found: dict[str, set[str | None]] = {
        name: {type_} for name, type_ in zip(arguments, given, strict=False)
    }
    for name in arguments[len(given) :]:
        found.setdefault(name, set()).add(None)
    made = {
        id(one.targets[0]): node.interface(one.value.func)
        for one in ast.walk(function)
        if isinstance(one, ast.Assign) and len(one.targets) == 1 and isinstance(one.value, ast.Call)
    }
    for one in ast.walk(function):
        if isinstance(one, ast.Name) and not isinstance(one.ctx, ast.Load):
            found.setdefault(one.id, set()).add(made.get(id(one)))
        elif isinstance(one, ast.arg) and one not in function.args.args:
            found.setdefault(one.arg, set()).add(None)
    return {
        name: type_
        for name, types in found.items()
        if len(types) == 1 and (type_ := next(iter(types))) is not None
    }


def _unknown_fields(
    node: NodeFile, function: ast.AST, types: Mapping[str, str]
) -> Iterator[Diagnostic]:
    for use in ast.walk(function):
        if not isinstance(use, ast.Attribute):
            continue
        type_ = _type_of(use.value, types)
        fields = _fields(type_) if type_ else None
        name = use.attr
        if fields is None or name in fields or name.startswith("_") or name.upper() == name:
            continue
        if name == "get_fields_and_field_types":
            continue
        short = _short(type_ or "")
        deeper = [field for field, inner in fields.items() if name in (_fields(inner) or ())]
        hint = (
            did_you_mean(f"{ast.unparse(use.value)}.{deeper[0]}.{name}")
            if len(deeper) == 1
            else f"{ask_for_nearest(name, fields)}Its fields: {', '.join(fields) or 'none'}."
        )
        yield UNKNOWN_FIELD.at(
            node.file,
            use.lineno,
            name,
            message=f"{short} has no field `{name}`.",
            hint=hint,
        )


# Their fields are all of type float64.
_OF_FLOATS = frozenset(f"geometry_msgs/{name}" for name in ("Point", "Quaternion", "Vector3"))


def _whole_numbers(
    node: NodeFile, function: ast.AST, types: Mapping[str, str]
) -> Iterator[Diagnostic]:
    for use in ast.walk(function):
        if not isinstance(use, ast.Assign) or not isinstance(use.targets[0], ast.Attribute):
            continue
        target, text = use.targets[0], ast.unparse(use.value)
        type_ = _type_of(target.value, types)
        if type_ and _short(type_) in _OF_FLOATS and text.removeprefix("-").isdigit():
            yield WHOLE_NUMBER.at(
                node.file,
                use.lineno,
                target.attr,
                message=f"`{ast.unparse(target)}` is a float, but is set to the integer {text}.",
                hint=f"Write `{ast.unparse(target)} = {text}.0`.",
            )


def _type_of(node: ast.expr, types: Mapping[str, str]) -> str | None:
    if isinstance(node, ast.Name):
        return types.get(node.id)
    if isinstance(node, ast.Attribute):
        outer = _type_of(node.value, types)
        fields = _fields(outer) if outer else None
        return (fields or {}).get(node.attr) or None
    return None


def _short(type_: str) -> str:
    return type_.replace("/msg/", "/")


def _fields(type_: str) -> Mapping[str, str] | None:
    """The fields of a type, such as "geometry_msgs/msg/Twist" or "geometry_msgs/Vector3"."""
    package, _, rest = type_.partition("/")
    if not rest:
        return None
    return (fields_of(package) or {}).get(rest if "/" in rest else f"msg/{rest}")
