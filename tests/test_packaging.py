"""What is in the wheel and in the source distribution."""

import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[1]


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("wheel")
    subprocess.run(
        [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "-w", folder, ROOT],
        check=True,
        capture_output=True,
    )
    return next(folder.glob("wsgen-*.whl"))


def test_the_wheel_holds_every_module_and_template(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        shipped = {name for name in archive.namelist() if ".dist-info/" not in name}
    modules = {
        path.relative_to(ROOT / "src").as_posix()
        for path in (ROOT / "src" / "wsgen").rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    templates = {
        "wsgen/_templates/" + path.relative_to(ROOT / "templates").as_posix()
        for path in (ROOT / "templates").rglob("*")
        if path.is_file()
    }
    assert shipped == modules | templates


def test_no_template_is_a_python_file(wheel: Path) -> None:
    """pip would compile it, and pytest would collect it."""
    with zipfile.ZipFile(wheel) as archive:
        templates = [name for name in archive.namelist() if "/_templates/" in name]
    assert templates
    assert not [name for name in templates if name.endswith(".py")]
