"""What a failed behavior shows of what its nodes have printed."""

from wsgen.cli.output import MOST_PRINTED, most_informative


def test_errors_are_shown_before_what_is_last() -> None:
    lines = [f"[driver-5] step {number}" for number in range(15)]
    assert most_informative(lines) == lines[-MOST_PRINTED:]
    assert most_informative(lines[:3]) == lines[:3]
    lines[2] = "[driver-5] [ERROR] [1.0] [driver]: no scan"
    assert most_informative(lines) == [lines[2], *lines[-MOST_PRINTED + 1 :]]
    errors = [f"[driver-5] ValueError: {number}" for number in range(12)]
    assert most_informative([*errors, *lines]) == [*errors[-MOST_PRINTED + 1 :], lines[2]]
    assert most_informative([]) == []
