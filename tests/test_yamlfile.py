"""YAML is read with the lines of its values, whatever is in it."""

from pathlib import Path

from wsgen.yamlfile import NotYaml, Value, load, parse

TEXT = """\
controller_manager:
  ros__parameters:
    update_rate: 100
    arm:
      type: a/B
      joints: [one, two]
-
"""


def _parse(text: str) -> Value:
    found = parse(text)
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


def test_files_are_read(tmp_path: Path) -> None:
    file = tmp_path / "a.yaml"
    file.write_text("a: 1\n")
    assert load(file) == Value({"a": Value(1, 1)}, 1)
    assert load(tmp_path / "none.yaml") is None
    assert load(tmp_path) is None
    file.write_bytes(b"\xff")
    assert load(file) is None
