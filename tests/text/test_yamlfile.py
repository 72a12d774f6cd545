"""YAML is read with the lines of its values, whatever is in it."""

from pathlib import Path

import pytest
import yaml

from wsgen.text.yamlfile import (
    MOST_VALUES,
    NotYaml,
    Value,
    load,
    load_parameters,
    merge_repeated,
    parse,
)

TEXT = """\
controller_manager:
  ros__parameters:
    update_rate: 100
    arm:
      type: a/B
      joints: [one, two]
-
"""


def _parse(text: str, *, are_parameters: bool = False) -> Value:
    found = parse(text, are_parameters=are_parameters)
    assert isinstance(found, Value)
    return found


def test_values_have_lines() -> None:
    document = _parse(TEXT.rpartition("-")[0])
    rate = document.get("controller_manager", "ros__parameters", "update_rate")
    assert rate == Value(100, 3)
    joints = document.get("controller_manager", "ros__parameters", "arm", "joints")
    assert joints is not None
    assert [one.text for one in joints.elements()] == ["one", "two"]
    assert joints.line == 6
    assert document.get("controller_manager", "no", "such") is None
    assert document.text is None
    assert list(joints.items()) == []
    assert document.elements() == ()


def test_what_is_not_yaml_has_a_line() -> None:
    found = parse(TEXT)
    assert isinstance(found, NotYaml)
    assert found.line == 7
    assert isinstance(parse("\x00"), NotYaml)
    assert isinstance(parse("day: 2001-99-99"), NotYaml)


@pytest.mark.slow
def test_odd_documents_are_read() -> None:
    assert parse("") is None
    assert _parse("a: &x {b: 1}\nc:\n  <<: *x\n  d: 2").get("c", "b") == Value(1, 1)
    assert _parse("day: 2001-01-02").get("day") == Value("2001-01-02", 1)
    assert _parse("? [a]\n: 1").get("") == Value(1, 2)
    assert isinstance(parse("a: &x [*x]"), (Value, NotYaml, type(None)))
    bomb = "a0: &a0 [x, x]\n" + "".join(
        f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 10)}]\n" for n in range(1, 9)
    )
    assert parse(bomb) is None


def test_mappings_of_one_key_are_merged_in_parameters() -> None:
    text = "/**:\n  a: {x: 1}\n/**:\n  b: {x: 2}\n  a:\n    y: 3\n"
    document = _parse(text, are_parameters=True)
    assert document.get("/**", "a", "x") == Value(1, 2)
    assert document.get("/**", "a", "y") == Value(3, 6)
    assert document.get("/**", "b", "x") == Value(2, 4)
    with_anchor = _parse("a: &one {x: 1}\nb: *one\na: {y: 2}\n", are_parameters=True)
    assert with_anchor.get("b", "y") is None
    assert _parse("a: {x: 1}\na: 2\n", are_parameters=True).get("a") == Value(2, 2)
    thrice = _parse("a: &one {x: 1}\na: {y: 2}\na: {z: 3}\nb: *one\n", are_parameters=True)
    assert [thrice.get("a", key) for key in "xyz"] == [Value(1, 1), Value(2, 2), Value(3, 3)]
    assert [thrice.get("b", key) for key in "yz"] == [None, None]


def test_the_last_of_one_key_counts_elsewhere(tmp_path: Path) -> None:
    file = tmp_path / "a.yaml"
    file.write_text("a: {x: 1}\na:\n  y: 2\n")
    assert load(file) == Value({"a": Value({"y": Value(2, 3)}, 3)}, 1)
    merged = load_parameters(file)
    assert isinstance(merged, Value)
    assert merged.get("a", "x") == Value(1, 1)
    assert load_parameters(tmp_path / "none.yaml") is None


@pytest.mark.slow
def test_aliases_of_one_key_are_not_merged_without_end() -> None:
    levels = [f"a{i}: &a{i} {{{', '.join([f'k: *a{i - 1}'] * 50)}}}" for i in range(1, 6)]
    text = "\n".join(["a0: &a0 {k: 1}", *levels])  # 50**5 values
    assert parse(text, are_parameters=True) is None
    todo: list[yaml.Node | None] = [yaml.SafeLoader(text).get_single_node()]
    merge_repeated(todo[0])
    pairs = {}
    while todo:
        node = todo.pop()
        if id(node) not in pairs and isinstance(node, yaml.MappingNode):
            pairs[id(node)] = len(node.value)
            todo += [value for _, value in node.value]
    assert sum(pairs.values()) < 2 * MOST_VALUES


def test_files_are_read(tmp_path: Path) -> None:
    file = tmp_path / "a.yaml"
    file.write_text("a: 1\n")
    assert load(file) == Value({"a": Value(1, 1)}, 1)
    assert load(tmp_path / "none.yaml") is None
    assert load(tmp_path) is None
    file.write_bytes(b"\xff")
    assert load(file) is None
