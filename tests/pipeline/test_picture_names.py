"""Names for files that are tried: none like another."""

from pathlib import Path

import pytest

from wsgen.pipeline.validate import unique_names


@pytest.mark.parametrize(
    ("files", "names"),
    [
        (["r.urdf"], ["r"]),
        (["a/r.urdf", "b/s.urdf"], ["r", "s"]),
        (["a/model.urdf", "b/model.urdf"], ["a-model", "b-model"]),
        (["a/m/model.urdf", "d/m/model.urdf"], ["a-m-model", "d-m-model"]),
        (["r.urdf", "r.sdf"], ["r", "r-sdf"]),
        (["r.urdf", "r.urdf", "r.urdf"], ["r", "r-urdf", "r-urdf-2"]),
    ],
)
def test_as_many_folders_as_it_takes(files: list[str], names: list[str]) -> None:
    assert unique_names([Path("/x", file) for file in files], []) == names


def test_a_package_has_its_name_first() -> None:
    assert unique_names([Path("/x/foo.urdf")], ["foo"]) == ["foo-urdf"]
