"""What `wsgen validate` says of packages whose last build failed, and what it no longer says."""

from pathlib import Path

from wsgen.building.last_build import FailedBuild
from wsgen.diagnostics import Diagnostic, Severity
from wsgen.launching.explain_missing import FILE_NOT_INSTALLED
from wsgen.model.outcome import NotValidated, PackageOutcome
from wsgen.model.plan import LaunchPlan, Lookup
from wsgen.packages.workspace.layout import PackageFolder
from wsgen.packages.workspace.overlay import Overlay
from wsgen.pipeline.failed_builds import Validated, with_failed_builds

ROOT = Path("/ws/src")
PACKAGES = tuple(
    PackageFolder(path=ROOT / name, name=name, build_type="ament_cmake")
    for name in ("robot", "robot_parts", "driver")
)
OVERLAY = Overlay(install=Path("/ws/install"), environment={}, prefixes=(), written=PACKAGES)


def outcome(*diagnostics: Diagnostic, looks_up: str | None = None) -> PackageOutcome:
    file = ROOT / "robot" / "launch" / "sim.launch.py"
    lookups = (Lookup(package=looks_up, file=file, line=1),) if looks_up else ()
    plan = LaunchPlan(package="robot", launch_file=file, lookups=lookups)
    return PackageOutcome(
        package="robot", share=None, launch_file=file, plan=plan, diagnostics=diagnostics
    )


def found(code: str, message: str, file: Path, severity: Severity = Severity.ERROR) -> Diagnostic:
    return Diagnostic(name="n", code=code, severity=severity, message=message, file=file)


def after(
    failed: str,
    *outcomes: PackageOutcome,
    not_validated: tuple[NotValidated, ...] = (),
    named: tuple[str, ...] = (),
) -> Validated:
    builds = {
        one.name: FailedBuild(one, Path("/ws/build", one.name), None, was_interrupted=False)
        for one in PACKAGES
        if one.name == failed
    }
    return with_failed_builds(outcomes, not_validated, builds, OVERLAY, named)


def codes(outcome: PackageOutcome) -> list[str]:
    return [one.code for one in outcome.diagnostics]


def test_the_package_itself_and_what_it_looks_up() -> None:
    assert codes(after("robot", outcome()).packages[0]) == ["BLD069"]
    assert codes(after("robot_parts", outcome(looks_up="robot_parts")).packages[0]) == ["BLD069"]
    assert codes(after("robot_parts", outcome()).packages[0]) == []


def test_nothing_that_follows_is_reported() -> None:
    launch_file = ROOT / "robot" / "launch" / "sim.launch.py"
    share = "/ws/install/robot/share/robot/model"
    kept = found("SPN059", "It tips over.", launch_file)
    echoes = (
        found("PKG052", "Changed since the last build.", ROOT / "robot" / "CMakeLists.txt"),
        found("BLD021", "robot: No file.", ROOT / "robot"),
        found(FILE_NOT_INSTALLED.code, f"The file {share} does not exist.", launch_file),
    )
    (of_robot,) = after("robot", outcome(*echoes, kept)).packages
    assert codes(of_robot) == ["BLD069", "SPN059"]
    (of_robot,) = after("driver", outcome(*echoes, kept, looks_up="driver")).packages
    assert codes(of_robot) == ["BLD069", "PKG052", "BLD021", FILE_NOT_INSTALLED.code, "SPN059"]


def test_a_package_of_which_nothing_is_validated() -> None:
    left = NotValidated(package="driver", reason="spawns no robot")
    validated = after("driver", outcome(), not_validated=(left,))
    assert codes(validated.packages[0]) == []
    (listed,) = validated.not_validated
    assert listed.reason == "spawns no robot; its last build failed"


def test_a_package_that_is_named_or_alone() -> None:
    left = NotValidated(package="driver", reason="spawns no robot")
    for validated in (
        after("driver", not_validated=(left,)),
        after("driver", outcome(), not_validated=(left,), named=("driver",)),
    ):
        assert not validated.not_validated
        assert validated.packages[-1].package == "driver"
        assert codes(validated.packages[-1]) == ["BLD069"]
