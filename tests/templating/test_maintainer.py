from pathlib import Path

import pytest

from wsgen.errors import RequestError
from wsgen.templating.spec import find_maintainer


@pytest.fixture(autouse=True)
def gitconfig(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The only configuration that git reads."""
    file = tmp_path / "gitconfig"
    file.touch()
    monkeypatch.setenv("GIT_CONFIG_GLOBAL", str(file))
    monkeypatch.setenv("GIT_CONFIG_SYSTEM", "/dev/null")
    monkeypatch.setenv("GIT_CEILING_DIRECTORIES", str(tmp_path))
    monkeypatch.setenv("LOGNAME", "ada")
    monkeypatch.chdir(tmp_path)
    return file


def test_git_knows(gitconfig: Path) -> None:
    gitconfig.write_text('[user]\n name = Ada "the" Lovelace # x\n email = ada@example.com\n')
    maintainer = find_maintainer(None, None)
    assert (maintainer.name, maintainer.email) == ("Ada the Lovelace", "ada@example.com")


def test_what_is_given_wins(gitconfig: Path) -> None:
    gitconfig.write_text("[user]\n name = Ada\n email = ada@example.com\n")
    maintainer = find_maintainer("Grace", None)
    assert (maintainer.name, maintainer.email) == ("Grace", "ada@example.com")
    maintainer = find_maintainer(None, "grace@example.com")
    assert (maintainer.name, maintainer.email) == ("Ada", "grace@example.com")


def test_the_last_value_counts(gitconfig: Path) -> None:
    gitconfig.write_text("[user]\n name = First\n name = Last\n")
    assert find_maintainer(None, "a@b.cd").name == "Last"


def test_what_package_xml_cannot_hold_is_passed_over(gitconfig: Path) -> None:
    gitconfig.write_text('[user]\n name = "A \\"B\\" C"\n email = ada@localhost\n')
    maintainer = find_maintainer(None, None)
    assert (maintainer.name, maintainer.email) == ("ada", "ada@todo.todo")


def test_nobody_knows() -> None:
    maintainer = find_maintainer(None, None)
    assert (maintainer.name, maintainer.email) == ("ada", "ada@todo.todo")


def test_broken_configuration_is_none(gitconfig: Path) -> None:
    gitconfig.write_text("[user\n")
    assert find_maintainer(None, None).email == "ada@todo.todo"


def test_no_git(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    assert find_maintainer(None, None).email == "ada@todo.todo"


@pytest.mark.parametrize(
    ("login", "email"), [("Jörg M", "JrgM@todo.todo"), ("机", "user@todo.todo")]
)
def test_login_that_is_no_address(monkeypatch: pytest.MonkeyPatch, login: str, email: str) -> None:
    monkeypatch.setenv("LOGNAME", login)
    assert find_maintainer(None, None).email == email


def test_what_is_given_is_checked() -> None:
    with pytest.raises(RequestError, match="'nobody' is not a valid e-mail"):
        find_maintainer(None, "nobody")
    with pytest.raises(RequestError, match="CMake"):
        find_maintainer("${x}", None)
