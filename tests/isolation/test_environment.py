"""The environment, copied and set."""

import os

import pytest

from wsgen.isolation.child import copy_environment, set_environment


def test_a_copy_is_of_the_environment_as_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("WSGEN_TRIED", "a")
    first = copy_environment()
    assert first == dict(os.environ)
    first["WSGEN_TRIED"] = "of the copy"
    assert copy_environment() == dict(os.environ)
    monkeypatch.setenv("WSGEN_TRIED", "ö")
    assert copy_environment() == dict(os.environ)
    monkeypatch.delenv("WSGEN_TRIED")
    assert copy_environment() == dict(os.environ)


def test_a_copy_has_the_order_of_the_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    copy_environment()
    monkeypatch.setenv("WSGEN_B", "1")
    monkeypatch.setenv("WSGEN_A", "1")
    assert [*copy_environment()] == [*os.environ]


def test_the_environment_is_set_to_what_is_given() -> None:
    before = dict(os.environ)
    try:
        set_environment({"WSGEN_TRIED": "a", "PATH": before["PATH"]})
        assert dict(os.environ) == {"PATH": before["PATH"], "WSGEN_TRIED": "a"}
    finally:
        set_environment(before)
    assert dict(os.environ) == before
