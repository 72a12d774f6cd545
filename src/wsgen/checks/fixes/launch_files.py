"""Fixes in launch files: in Python by its syntax tree, in XML by its tags."""

from __future__ import annotations

import ast
import itertools
import re
import warnings
from typing import TYPE_CHECKING, TypeVar

from wsgen.checks.fixes.source import Edit, is_surely, read_tags
from wsgen.text.pythontree import is_text, name_of
from wsgen.text.suggestions import suggested

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from wsgen.checks.fixes.source import SourceText, Tag
    from wsgen.diagnostics import Diagnostic

    Located = ast.expr | ast.stmt | ast.keyword

Node = TypeVar("Node", bound=ast.AST)

DESCRIPTION = "robot_description"
AS_TEXT = "ParameterValue"
AS_TEXT_IMPORT = "from launch_ros.parameter_descriptions import ParameterValue"
# What Node took before Galactic -> what it takes.
RENAMED = {"node_executable": "executable", "node_name": "name", "node_namespace": "namespace"}
STATEMENT = re.compile(r"Add `((?:from [\w.]+ )?import \w+)` at the top")
OF_GAZEBO_SIM = re.compile(r"\bros_(?:gz|ign)")
CLOCK = "/clock"
XACRO_WORDS = frozenset(("xacro", "ros2 run xacro xacro"))


class Tree:
    """A launch file in Python, with the places of its syntax."""

    def __init__(self, source: SourceText, module: ast.Module) -> None:
        self.source = source
        self.module = module
        self.nodes = list(ast.walk(module))

    def all(self, kind: type[Node]) -> list[Node]:
        """Every node of a kind."""
        return [node for node in self.nodes if isinstance(node, kind)]

    def start(self, node: Located) -> int:
        """The place of the first character of a node."""
        return self._place(node.lineno, node.col_offset)

    def end(self, node: Located) -> int:
        """The place behind the last character of a node."""
        return self._place(node.end_lineno or node.lineno, node.end_col_offset or 0)

    def _place(self, line: int, column: int) -> int:
        """The tree counts columns in bytes of UTF-8."""
        start = self.source.start_of(line)
        text = self.source.text[start : self.source.start_of(line + 1)]
        return start + len(text.encode()[:column].decode(errors="ignore"))


def tree_of(source: SourceText) -> Tree | None:
    """The tree of a launch file in Python; None where it cannot be parsed or has odd line ends."""
    if source.file.suffix != ".py" or re.search(r"\r(?!\n)|\f", source.text):
        return None
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # about escapes in strings of the user
            return Tree(source, ast.parse(source.text))
    except (SyntaxError, ValueError, RecursionError):
        return None


def import_edit(tree: Tree, statement: str) -> list[Edit]:
    """Add an import behind those that there are; nothing if the name is imported already."""
    name = statement.rpartition(" ")[2]
    tops = [one for one in tree.module.body if isinstance(one, (ast.Import, ast.ImportFrom))]
    names = {alias.asname or alias.name for one in tops for alias in one.names}
    if name in names or "*" in names:
        return []
    source, newline = tree.source, tree.source.newline
    if tops:
        module = statement.split()[1].partition(".")[0]
        same = [one for one in tops if _module(one).partition(".")[0] == module]
        last = max(same or tops, key=lambda one: one.lineno)
        place = tree.end(last)
        return [Edit(start=place, end=place, text=f"{newline}{statement}")]
    body = [one for one in tree.module.body if not is_text(one)]
    place = source.start_of(body[0].lineno) if body else len(source.text)
    return [Edit(start=place, end=place, text=f"{statement}{newline}")]


def _module(node: ast.Import | ast.ImportFrom) -> str:
    return (node.module or "") if isinstance(node, ast.ImportFrom) else node.names[0].name


def keep_description_as_text(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Say that the robot description is text, which launch_ros does not parse."""
    if source.file.suffix in {".xml", ".launch"}:
        return _typed_parameter(diagnostic, source)
    tree = tree_of(source)
    if tree is None:
        return []
    values = [
        value
        for node in tree.all(ast.Dict)
        for key, value in zip(node.keys, node.values, strict=True)
        if isinstance(key, ast.Constant) and key.value == DESCRIPTION
        if not (isinstance(value, ast.Call) and name_of(value) == AS_TEXT)
    ]
    if len(values) != 1 or isinstance(values[0], ast.Constant):
        return []
    start, end = tree.start(values[0]), tree.end(values[0])
    if isinstance(values[0], (ast.GeneratorExp, ast.Tuple, ast.Starred, ast.NamedExpr)):
        return []
    return [
        Edit(start=start, end=start, text=f"{AS_TEXT}("),
        Edit(start=end, end=end, text=", value_type=str)"),
        *import_edit(tree, AS_TEXT_IMPORT),
    ]


def _typed_parameter(diagnostic: Diagnostic, source: SourceText) -> list[Edit]:
    tags = [
        tag
        for tag in read_tags(source.text)
        if tag.name == "param" and (named := tag.attributes.get("name")) is not None
        if named.text == DESCRIPTION and "type" not in tag.attributes
    ]
    near = [tag for tag in tags if _around(source, tag, diagnostic.line)]
    tags = near if near and len(tags) > 1 else tags
    if len(tags) != 1:
        return []
    place = tags[0].attributes["name"].value.end + len('"')
    return [Edit(start=place, end=place, text=' type="str"')]


def _around(source: SourceText, tag: Tag, line: int | None) -> bool:
    """Whether the node of a parameter begins on a line."""
    owner = tag.path[-1] if tag.path else tag
    return source.line_at(owner.start.start) <= (line or 0) <= source.line_at(tag.start.end)


def rename_old_keywords(_: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Write the keywords that Node takes since Galactic, in all nodes of the file."""
    tree = tree_of(source)
    if tree is None:
        return []
    edits = []
    for call in tree.all(ast.Call):
        given = {keyword.arg for keyword in call.keywords}
        if given & {RENAMED[old] for old in given & RENAMED.keys() if old}:
            return []
        for keyword in call.keywords:
            if keyword.arg in RENAMED:
                start = tree.start(keyword)
                end = start + len(keyword.arg)
                edits.append(Edit(start=start, end=end, text=RENAMED[keyword.arg]))
    return edits


def fix_keyword(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Write the suggested keyword argument."""
    tree, meant, written = tree_of(source), suggested(diagnostic.hint), diagnostic.element
    if tree is None or meant is None or not written or not is_surely(written, meant):
        return []
    found = [
        keyword
        for call in tree.all(ast.Call)
        if meant not in {keyword.arg for keyword in call.keywords}
        for keyword in call.keywords
        if keyword.arg == written and keyword.lineno == diagnostic.line
    ]
    if len(found) != 1:
        return []
    start = tree.start(found[0])
    return [Edit(start=start, end=start + len(written), text=meant)]


def add_import(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Import what the launch file uses and does not import, or correct its misspelled name."""
    tree, meant, written = tree_of(source), suggested(diagnostic.hint), diagnostic.element
    if tree is None or not written:
        return []
    statement = STATEMENT.search(diagnostic.hint or "")
    edits = import_edit(tree, statement[1]) if statement else []
    if statement is not None and statement[1].endswith(f" {written}"):
        return edits
    if meant is None or not is_surely(written, meant):
        return []
    names = [node for node in tree.all(ast.Name) if node.id == written]
    if not names or any(isinstance(node.ctx, ast.Store) for node in names):
        return []
    places = [(tree.start(node), tree.end(node)) for node in names]
    return [*(Edit(start=start, end=end, text=meant) for start, end in places), *edits]


def fix_text(key: str = "") -> Callable[[Diagnostic, SourceText], Sequence[Edit]]:
    """The fix that writes the suggested word for the only text that has the misspelled one.

    With `key`, that is the value of this keyword argument or attribute.
    """

    def fix(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
        meant, written = suggested(diagnostic.hint), diagnostic.element
        if meant is None or not written or not is_surely(written, meant):
            return []
        tree = tree_of(source)
        if tree is None:
            return _fix_attribute(source, key, written, meant)
        texts: Iterable[ast.expr] = tree.all(ast.Constant)
        if key:
            texts = [one.value for one in tree.all(ast.keyword) if one.arg == key]
        found = [one for one in texts if isinstance(one, ast.Constant) and one.value == written]
        return _within(tree, found, written, meant)

    return fix


def _fix_attribute(source: SourceText, key: str, written: str, meant: str) -> list[Edit]:
    found = [
        attribute
        for tag in read_tags(source.text)
        for name, attribute in tag.attributes.items()
        if attribute.text == written and name == (key or "name")
    ]
    if source.file.suffix not in {".xml", ".launch"} or len(found) != 1:
        return []
    return [Edit(start=found[0].value.start, end=found[0].value.end, text=meant)]


def _within(tree: Tree, found: Sequence[ast.expr], written: str, meant: str) -> list[Edit]:
    """Replace a word in the only text that has it."""
    if len(found) != 1:
        return []
    start, end = tree.start(found[0]), tree.end(found[0])
    places = list(re.finditer(rf"(?<!\w){re.escape(written)}(?!\w)", tree.source.text[start:end]))
    if len(places) != 1:
        return []
    return [Edit(start=start + places[0].start(), end=start + places[0].end(), text=meant)]


def fix_xacro_argument(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Write the suggested name of an argument for xacro."""
    tree, meant, written = tree_of(source), suggested(diagnostic.hint), diagnostic.element
    if tree is None or meant is None or not written or not is_surely(written, meant):
        return []
    used = re.compile(rf"(?<!\w){re.escape(written)}:=")
    found = [
        node
        for node in tree.all(ast.Constant)
        if isinstance(node.value, str) and (used.search(node.value) or node.value == written)
    ]
    return _within(tree, found, written, meant)


def add_blank_after_xacro(_: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Put a blank between `xacro` and the path: Command joins its words without one."""
    tree = tree_of(source)
    if tree is None:
        return []
    edits = []
    for call in tree.all(ast.Call):
        first = call.args[0] if call.args else None
        if name_of(call) != "Command" or not isinstance(first, ast.List):
            continue
        words = first.elts
        if len(words) < len(("xacro", "path")) or _begins_with_blank(words[1]):
            continue
        place = tree.end(words[0])
        if isinstance(words[0], ast.Constant) and words[0].value in XACRO_WORDS:
            edits.append(Edit(start=place - 1, end=place - 1, text=" "))
        elif isinstance(words[0], ast.Call) and _finds_xacro(words[0]):
            edits.append(Edit(start=place, end=place, text=", ' '"))
    return edits


def _begins_with_blank(word: ast.expr) -> bool:
    return isinstance(word, ast.Constant) and str(word.value)[:1].isspace()


def _finds_xacro(call: ast.Call) -> bool:
    inside = (one for one in ast.walk(call) if isinstance(one, ast.Call))
    return any(name_of(one) == "FindExecutable" for one in inside)


_BETWEEN = re.compile(r"no blank between `([^`]+)` and")


def add_blank_after_option(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Put a blank between an option and the path behind it in a list of words that are joined."""
    tree, option = tree_of(source), _BETWEEN.search(diagnostic.message)
    if tree is None or option is None:
        return []
    found = [
        word
        for node in tree.all(ast.List)
        for word, following in zip(node.elts, node.elts[1:], strict=False)
        if isinstance(word, ast.Constant) and str(word.value).endswith(option[1])
        if not isinstance(following, ast.Constant)
    ]
    if len(found) != 1:
        return []
    place = tree.end(found[0]) - 1
    return [Edit(start=place, end=place, text=" ")]


def use_time_of_simulator(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Set `use_sim_time` of the node on the line."""
    tree = tree_of(source)
    node = _call_at(tree, diagnostic.line, "Node", "ComposableNode") if tree else None
    if tree is None or node is None or "use_sim_time" in ast.dump(node):
        return []
    if OF_GAZEBO_SIM.search(source.text) and CLOCK not in source.text:
        return []  # without a bridge for the clock, the node would wait for it
    given = [keyword.value for keyword in node.keywords if keyword.arg == "parameters"]
    if not given and node.keywords:
        place = tree.end(node.keywords[-1])
        return [Edit(start=place, end=place, text=", parameters=[{'use_sim_time': True}]")]
    return _with_parameter(tree, given[0]) if given and isinstance(given[0], ast.List) else []


def _with_parameter(tree: Tree, parameters: ast.List) -> list[Edit]:
    """Add it to the first dictionary of a list of parameters, else as a dictionary of its own."""
    text = "'use_sim_time': True"
    for one in parameters.elts:
        if isinstance(one, ast.Dict) and one.values and None not in one.keys:
            place = tree.end(one.values[-1])
            return [Edit(start=place, end=place, text=f",{_gap(tree, one)}{text}")]
    if not parameters.elts:
        place = tree.start(parameters) + 1
        return [Edit(start=place, end=place, text=f"{{{text}}}")]
    place = tree.end(parameters.elts[-1])
    return [Edit(start=place, end=place, text=f", {{{text}}}")]


def _gap(tree: Tree, written: ast.Dict) -> str:
    """What comes in front of one more entry: a line of its own where the others have theirs."""
    last, key = written.values[-1], written.keys[-1]
    is_on_lines = (written.end_lineno or 0) > (last.end_lineno or 0)
    if not is_on_lines or key is None:
        return " "
    return tree.source.newline + tree.source.indent_at(tree.start(key))


def _call_at(tree: Tree, line: int | None, *names: str) -> ast.Call | None:
    """The call of one of these names that a line is in; None where several are."""
    found = [
        call
        for call in tree.all(ast.Call)
        if name_of(call) in names and call.lineno <= (line or 0) <= (call.end_lineno or call.lineno)
    ]
    return found[0] if len(found) == 1 else None


_QUOTED_WORDS = re.compile(r"'(-s|lib[\w.]+\.so)'")


def add_factory_plugin(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Load the plugin that spawns in the command that starts Gazebo Classic."""
    tree = tree_of(source)
    call = _call_at(tree, diagnostic.line, "ExecuteProcess") if tree else None
    words = _QUOTED_WORDS.findall(diagnostic.hint or "")
    commands = [one.value for one in call.keywords if one.arg == "cmd"] if call else []
    if tree is None or not words or not commands or not isinstance(commands[0], ast.List):
        return []
    known = {one.value for one in commands[0].elts if isinstance(one, ast.Constant)}
    added = [f"'-s', '{library}'" for library in words if library != "-s" and library not in known]
    place = tree.end(commands[0].elts[-1])
    return [Edit(start=place, end=place, text=", " + ", ".join(added))] if added else []


def fix_world_name(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Give the spawner the name of the world that Gazebo loads."""
    tree, meant = tree_of(source), suggested(diagnostic.hint)
    if tree is None or meant is None or not diagnostic.element:
        return []
    found = [
        value
        for node in tree.all(ast.List)
        for option, value in zip(node.elts, node.elts[1:], strict=False)
        if isinstance(option, ast.Constant) and option.value in {"-world", "--world"}
        if isinstance(value, ast.Constant) and value.value == diagnostic.element
    ]
    return _within(tree, found, diagnostic.element, meant)


_BETWEEN_TYPES = re.compile(r"Write `([@\[\]])` between the types")


def fix_bridge_direction(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Turn the direction of a bridge that is given as TOPIC@ROS_TYPE[GZ_TYPE."""
    wanted = _BETWEEN_TYPES.search(diagnostic.hint or "")
    if wanted is None or not diagnostic.element:
        return []
    topic = re.escape(diagnostic.element)
    places = list(re.finditer(rf"(?<=['\"\s]){topic}@[\w/]+([@\[\]])(?=[\w.]+)", source.text))
    if len(places) != 1 or places[0][1] == wanted[1]:
        return []
    return [Edit(start=places[0].start(1), end=places[0].end(1), text=wanted[1])]


_WRITE_SUBSTITUTION = re.compile(r"Write \$\(([\w-]+) ")


def fix_ros_1_markup(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Write the substitutions and attributes of ROS 2 in a launch file in XML."""
    if source.file.suffix not in {".xml", ".launch"}:
        return []
    meant = _WRITE_SUBSTITUTION.search(diagnostic.hint or "")
    tags = read_tags(source.text)
    if diagnostic.element == "exec":
        return [
            Edit(start=written.name.start, end=written.name.end, text="exec")
            for tag in tags
            if tag.name == "node" and "exec" not in tag.attributes
            if (written := tag.attributes.get("type")) is not None
        ]
    if meant is None or not diagnostic.element:
        return []
    used = re.compile(rf"\$\(({re.escape(diagnostic.element)})(?=\s)")
    return [
        Edit(
            start=attribute.value.start + found.start(1),
            end=attribute.value.start + found.end(1),
            text=meant[1],
        )
        for tag in tags
        for attribute in tag.attributes.values()
        for found in used.finditer(attribute.text)
    ]


_RAISED = re.compile(r"add '(-z)', '([\d.]+)' to the arguments of ([\w.]+)")
_CHANGED = re.compile(r"change (-z) to '([\d.]+)' in the arguments of ([\w.]+)")


def raise_spawned(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Give the spawner the height at which the robot stands on the ground."""
    hint = diagnostic.hint or ""
    tree, added, changed = tree_of(source), _RAISED.search(hint), _CHANGED.search(hint)
    node = _call_at(tree, diagnostic.line, "Node") if tree else None
    given = [one.value for one in node.keywords if one.arg == "arguments"] if node else []
    if tree is None or not given or not isinstance(given[0], ast.List):
        return []
    words = given[0].elts
    if changed is not None:
        return _replace_after("-z", words, changed[2], tree)
    if (
        added is None
        or not words
        or any(isinstance(one, ast.Constant) and one.value == "-z" for one in words)
    ):
        return []
    place = tree.end(words[-1])
    return [Edit(start=place, end=place, text=f", '{added[1]}', '{added[2]}'")]


def _replace_after(option: str, words: Sequence[ast.expr], text: str, tree: Tree) -> Sequence[Edit]:
    """Write another text for the one literal that follows an option."""
    values = [
        after
        for one, after in itertools.pairwise(words)
        if isinstance(one, ast.Constant) and one.value == option
    ]
    if len(values) != 1 or not isinstance(values[0], ast.Constant):
        return []
    start, end = tree.start(values[0]), tree.end(values[0])
    quote = tree.source.text[start]
    if quote not in "'\"" or tree.source.text[start:end].count(quote) != QUOTES:
        return []
    return [Edit(start=start + 1, end=end - 1, text=text)]


QUOTES = 2  # of a literal
_BRIDGED = re.compile(r"'(/clock@[^']+)'")


def add_clock(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Bridge the clock of Gazebo with the only bridge that the launch file starts."""
    tree, added = tree_of(source), _BRIDGED.search(diagnostic.hint or "")
    if tree is None or added is None or CLOCK in source.text:
        return []
    given = [
        keyword.value
        for call in tree.all(ast.Call)
        if name_of(call) == "Node" and "'parameter_bridge'" in ast.dump(call)
        for keyword in call.keywords
        if keyword.arg == "arguments"
    ]
    if len(given) != 1 or not isinstance(given[0], ast.List) or not given[0].elts:
        return []
    first = given[0].elts[0]
    place = tree.start(first)
    is_on_lines = first.lineno > given[0].lineno
    gap = source.newline + source.indent_at(place) if is_on_lines else " "
    return [Edit(start=place, end=place, text=f"'{added[1]}',{gap}")]
