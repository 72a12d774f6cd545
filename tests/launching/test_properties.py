"""What holds for all launch files, with generated ones."""

from __future__ import annotations

import shlex
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any
from xml.sax.saxutils import quoteattr

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from install_space import HEAD, InstallSpace, essence

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from wsgen.model.plan import LaunchPlan


pytestmark = pytest.mark.slow

# Each example is one or two child processes.
FEW = settings(
    max_examples=15,
    deadline=None,
    derandomize=True,
    database=None,
    suppress_health_check=[HealthCheck.too_slow],
)
SECONDS = 4.0  # of CPU time, for a file of any content

# A description is a nested tuple: its kind, then what the kind takes. A text is a list of parts:
# a str, or the name of a launch configuration in a tuple, with its default.
Text = Any

NAMES = st.sampled_from(["a", "b", "c", "name", "ns"])
CHARACTERS = st.characters(
    min_codepoint=0x20, max_codepoint=0x2FFF, blacklist_categories=("Cs", "Cc", "Cn")
)
WORDS = st.text(st.sampled_from("ab01 \t\n'\"\\\\$()<>&{}:#%-é") | CHARACTERS, max_size=8)
PARTS = st.one_of(WORDS, st.tuples(NAMES, st.text("xyz", max_size=3)))
TEXTS = st.lists(PARTS, min_size=1, max_size=3)
PLAIN = st.text("abcxyz_", min_size=1, max_size=5)
VALUES = st.one_of(st.integers(-9, 9), st.booleans(), WORDS, st.floats(-9.0, 9.0).map(repr))
CONDITIONS = st.sampled_from(
    [None, None, ("if", "true"), ("if", " 1 "), ("unless", "FALSE"), ("unless", "0"), ("if", "0")]
)
LEAVES = st.one_of(
    st.tuples(st.just("executable"), st.lists(TEXTS, min_size=1, max_size=3), CONDITIONS),
    st.tuples(
        st.just("node"),
        st.none() | PLAIN,
        st.none() | PLAIN,
        st.dictionaries(PLAIN, VALUES, max_size=3),
        st.lists(st.tuples(PLAIN, PLAIN), max_size=2),
        st.lists(TEXTS, max_size=2),
    ),
    st.tuples(st.just("let"), NAMES, TEXTS),
    st.tuples(st.just("arg"), NAMES, TEXTS),
    st.tuples(st.just("unset"), NAMES),
    st.tuples(st.just("set_env"), st.just("WSGEN_A"), TEXTS),
    st.tuples(st.just("push_ros_namespace"), PLAIN),
    st.tuples(st.just("set_parameter"), PLAIN, st.integers(-9, 9)),
    st.tuples(st.just("log"), TEXTS),
)
TREES = st.recursive(
    LEAVES,
    lambda inside: st.one_of(
        st.tuples(st.just("group"), st.booleans(), st.lists(inside, max_size=4), CONDITIONS),
        st.tuples(
            st.just("timer"), st.integers(0, 3), st.lists(inside, min_size=1, max_size=3), st.none()
        ),
    ),
    max_leaves=8,
)


def text_in_python(text: Text) -> str:
    parts = [
        f"LaunchConfiguration({part[0]!r}, default={part[1]!r})"
        if isinstance(part, tuple)
        else repr(part)
        for part in text
    ]
    return f"[{', '.join(parts)}]"


def in_python(entity: tuple[Any, ...]) -> str:
    kind, *rest = entity
    if kind == "executable":
        words = ", ".join(text_in_python(word) for word in rest[0])
        return f"ExecuteProcess(cmd=[{words}]{condition_in_python(rest[1])})"
    if kind == "node":
        name, namespace, parameters, remappings, words = rest
        given = ", ".join(text_in_python(word) for word in words)
        return (
            f"Node(package='rviz2', executable='rviz2', name={name!r}, namespace={namespace!r}, "
            f"parameters=[{parameters!r}], remappings={remappings!r}, arguments=[{given}])"
        )
    if kind in {"group", "timer"}:
        first, inside, condition = rest
        actions = f"[{', '.join(in_python(one) for one in inside)}]"
        if kind == "group":
            return f"GroupAction({actions}, scoped={first}{condition_in_python(condition)})"
        return f"TimerAction(period={float(first)}, actions={actions})"
    calls = {
        "let": lambda: f"SetLaunchConfiguration({rest[0]!r}, {text_in_python(rest[1])})",
        "arg": lambda: (
            f"DeclareLaunchArgument({rest[0]!r}, default_value={text_in_python(rest[1])})"
        ),
        "unset": lambda: f"UnsetLaunchConfiguration({rest[0]!r})",
        "set_env": lambda: f"SetEnvironmentVariable({rest[0]!r}, {text_in_python(rest[1])})",
        "push_ros_namespace": lambda: f"PushRosNamespace({rest[0]!r})",
        "set_parameter": lambda: f"SetParameter({rest[0]!r}, {rest[1]!r})",
        "log": lambda: f"LogInfo(msg={text_in_python(rest[0])})",
    }
    return calls[kind]()


def condition_in_python(condition: tuple[str, str] | None) -> str:
    if condition is None:
        return ""
    kind = {"if": "IfCondition", "unless": "UnlessCondition"}[condition[0]]
    return f", condition={kind}({condition[1]!r})"


def escape(text: str) -> str:
    return text.replace("\\", "\\\\").replace("$", "\\$")


def text_in_xml(text: Text, *, is_word: bool = False) -> str:
    return "".join(
        f"$(var {part[0]} '{part[1]}')"
        if isinstance(part, tuple)
        else escape(shlex.quote(part) if is_word else part)
        for part in text
    )


def element(tag: str, attributes: Mapping[str, str | None], inside: str = "") -> str:
    # Line ends in attributes are blanks to XML unless they are written as numbers.
    numbers = {"\n": "&#10;", "\r": "&#13;", "\t": "&#9;"}
    words = [
        f"{name}={quoteattr(value, numbers)}"
        for name, value in attributes.items()
        if value is not None
    ]
    return f"<{' '.join([tag, *words])}>{inside}</{tag}>"


def in_xml(entity: tuple[Any, ...]) -> str:
    kind, *rest = entity
    if kind == "executable":
        line = " ".join(text_in_xml(word, is_word=True) for word in rest[0])
        return element(kind, {"cmd": line, **dict([rest[1]] if rest[1] else [])})
    if kind == "node":
        return node_in_xml(*rest)
    if kind == "group":
        scoped, inside, condition = rest
        attributes = {"scoped": str(scoped).lower(), **dict([condition] if condition else [])}
        return element(kind, attributes, "".join(in_xml(one) for one in inside))
    if kind == "timer":
        return element(kind, {"period": str(rest[0])}, "".join(in_xml(one) for one in rest[1]))
    names = {
        "let": ("name", "value"),
        "arg": ("name", "default"),
        "unset": ("name",),
        "set_env": ("name", "value"),
        "push_ros_namespace": ("namespace",),
        "set_parameter": ("name", "value"),
        "log": ("message",),
    }[kind]
    values = [text_in_xml(value) if isinstance(value, list) else str(value) for value in rest]
    return element(kind, dict(zip(names, values, strict=True)))


def node_in_xml(
    name: str | None,
    namespace: str | None,
    parameters: Mapping[str, Any],
    remappings: Sequence[tuple[str, str]],
    words: Sequence[Text],
) -> str:
    inside = [
        element(
            "param",
            {
                "name": key,
                "value": escape(value) if isinstance(value, str) else str(value).lower(),
                "type": "str" if isinstance(value, str) else None,
            },
        )
        for key, value in parameters.items()
    ]
    inside += [element("remap", {"from": one, "to": other}) for one, other in remappings]
    line = " ".join(text_in_xml(word, is_word=True) for word in words)
    attributes = {"pkg": "rviz2", "exec": "rviz2", "name": name, "namespace": namespace}
    return element("node", {**attributes, "args": line or None}, "".join(inside))


def evaluate(text: str | bytes, suffix: str, seconds: float = SECONDS) -> LaunchPlan:
    """The plan of a file of any content, which comes within the limit."""
    with TemporaryDirectory() as folder:
        file = Path(folder, f"test.launch{suffix}")
        file.write_bytes(text.encode("utf-8", "surrogatepass") if isinstance(text, str) else text)
        space = InstallSpace(Path(folder, "install"))
        space.add("my_robot")
        return space.evaluate(file, seconds=seconds)


@given(st.lists(TREES, min_size=2, max_size=6))
@FEW
def test_python_and_xml_that_say_the_same_give_the_same_plan(
    entities: list[tuple[Any, ...]],
) -> None:
    description = ", ".join(in_python(entity) for entity in entities)
    from_python = evaluate(
        HEAD + f"def generate_launch_description():\n    return LaunchDescription([{description}])",
        ".py",
    )
    from_xml = evaluate(f"<launch>{''.join(in_xml(one) for one in entities)}</launch>", ".xml")
    if from_python.diagnostics:  # a name that ROS does not allow
        assert [one.code for one in from_xml.diagnostics] == [
            one.code for one in from_python.diagnostics
        ]
    else:
        assert essence(from_xml) == essence(from_python)


VALID = {
    ".py": HEAD
    + """
def more(context, word):
    return [ExecuteProcess(cmd=[word, LaunchConfiguration("a").perform(context)])]

def generate_launch_description():
    node = Node(package="rviz2", executable="rviz2", name="n", parameters=[{"a": [1, 2]}])
    return LaunchDescription([
        DeclareLaunchArgument("a", default_value="1", choices=["1", "2"]),
        node,
        GroupAction([OpaqueFunction(function=more, args=["w"])]),
        TimerAction(period=1.0, actions=[LogInfo(msg=["x", EnvironmentVariable("HOME")])]),
        RegisterEventHandler(OnProcessExit(target_action=node, on_exit=[Shutdown()])),
    ])
""",
    ".xml": """<?xml version="1.0"?>
<launch>
  <arg name="a" default="1"><choice value="1"/></arg>
  <let name="b" value="$(var a) $(env HOME) $(eval '1 + $(var a)')"/>
  <group scoped="true" if="$(var a)"><node pkg="rviz2" exec="rviz2" args="-d '$(var b)'">
    <param name="x" value="1;2" value-sep=";"/><remap from="a" to="b"/></node></group>
  <for len="2" name="i"><executable cmd="echo $(index i)"/></for>
</launch>
""",
    ".yaml": """\
launch:
- arg: {name: a, default: '1'}
- group:
    scoped: false
    children:
    - node: {pkg: rviz2, exec: rviz2, param: [{name: x, value: [1, 2]}]}
- timer: {period: 1.5, children: [{executable: {cmd: echo $(var a)}}]}
""",
}


@st.composite
def mutated(draw: st.DrawFn) -> tuple[str, str]:
    """A launch file out of which a part was taken, put elsewhere, or replaced."""
    suffix = draw(st.sampled_from(sorted(VALID)))
    text = VALID[suffix]
    for _ in range(draw(st.integers(1, 3))):
        begin = draw(st.integers(0, len(text)))
        end = draw(st.integers(begin, min(len(text), begin + 30)))
        goal = draw(st.integers(0, len(text)))
        new = draw(st.sampled_from(["", text[begin:end] * 2, "$(var a)", "'", "<", "&", ":", "\0"]))
        text = text[:begin] + text[end:]
        text = text[:goal] + new + text[goal:]
    return suffix, text


@given(mutated())
@FEW
def test_no_damage_to_a_file_takes_wsgen_down(example: tuple[str, str]) -> None:
    suffix, text = example
    check_findings(evaluate(text, suffix))


@given(st.binary(max_size=200) | st.text(max_size=100), st.sampled_from(sorted(VALID)))
@FEW
def test_no_content_takes_wsgen_down(content: str | bytes, suffix: str) -> None:
    check_findings(evaluate(content, suffix))


def check_findings(plan: LaunchPlan) -> None:
    for finding in plan.diagnostics:
        assert finding.code.startswith("LCH")
        assert finding.file is not None
        assert finding.hint
        assert "Traceback" not in finding.message


def code_of(plan: LaunchPlan) -> str:
    (finding,) = plan.diagnostics
    check_findings(plan)
    return finding.code


NESTED_YAML = "launch: " + "[{group: " * 100_000 + "[]" + "}]" * 100_000


@pytest.mark.parametrize(
    ("suffix", "text", "code"),
    [
        (".py", "while True:\n    pass\n", "LCH012"),
        (".py", "x = 'a'\nwhile True:\n    x += x\n", "LCH004"),
        (".py", "import os\nif os.fork():\n    while True: pass\n", "LCH025"),
        (".py", "def f():\n    f()\nf()\n", "LCH004"),
        (".py", "import os, signal\nos.kill(os.getpid(), signal.SIGKILL)\n", "LCH013"),
        (".py", "x = " + "(" * 10_000 + ")" * 10_000, None),
        (".xml", "<launch>" + "<group>" * 50_000 + "</group>" * 50_000 + "</launch>", "LCH023"),
        (
            ".xml",
            "<launch><for len='1000000000' name='i'><log message='a'/></for></launch>",
            "LCH010",
        ),
        (".xml", "<launch><log message='$(eval &quot;2**2**40&quot;)'/></launch>", None),
        (".xml", "<launch><include file='$(dirname)/test.launch.xml'/></launch>", "LCH004"),
        (".yaml", NESTED_YAML, None),
        (".yaml", "&a [*a, *a]", None),
        (".yaml", "launch: &a\n- group: *a\n", None),
    ],
)
def test_no_endless_file_takes_wsgen_down(suffix: str, text: str, code: str | None) -> None:
    # The kernel may take seconds to hand out a gigabyte; a computation runs up to the limit.
    seconds = 60.0 if "x += x" in text else 1.0 if code == "LCH012" or "**" in text else SECONDS
    plan = evaluate(text, suffix, seconds=seconds)
    found = code_of(plan)
    assert code in {None, found}


def test_a_circle_of_three_formats(space: InstallSpace) -> None:
    text = HEAD + "def generate_launch_description():\n    return LaunchDescription(["
    share = space.add(
        "my_robot",
        {
            "a.launch.py": text
            + "IncludeLaunchDescription([ThisLaunchFileDir(), '/b.launch.xml'])])",
            "b.launch.xml": "<launch><include file='$(dirname)/c.launch.yaml'/></launch>",
            "c.launch.yaml": "launch:\n- include: {file: $(dirname)/a.launch.py}\n",
        },
    )
    assert code_of(space.evaluate(share / "a.launch.py")) == "LCH004"


@pytest.mark.parametrize("suffix", [".py", ".xml", ".yaml"])
def test_a_large_file(suffix: str) -> None:
    many = 3000
    text = {
        ".py": HEAD
        + "def generate_launch_description():\n    return LaunchDescription([\n"
        + "    ExecuteProcess(cmd=['a']),\n" * many
        + "    ])\n",
        ".xml": "<launch>" + "<executable cmd='a'/>\n" * many + "</launch>",
        ".yaml": "launch:\n" + "- executable: {cmd: a}\n" * many,
    }[suffix]
    plan = evaluate(text, suffix, seconds=20.0)
    assert not plan.diagnostics
    assert len(plan.processes) == many
