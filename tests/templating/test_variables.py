import pytest

from wsgen.errors import RequestError
from wsgen.model.package import Answer
from wsgen.templating.spec import Variable, resolve_answers, show

VARIABLES = {
    variable.name: variable
    for variable in (
        Variable("mass", "Mass", "number", 1.0, unit="kg", minimum=0.001, maximum=100000.0),
        Variable("joints", "Joints", "integer", 6, minimum=1, maximum=12),
        Variable("frame", "Frame", "string", "base link"),
        Variable("lidar", "Lidar", "boolean", default=True),
        Variable("wheels", "Wheels", "choice", "two", choices=("two", "four")),
    )
}


def test_defaults() -> None:
    assert resolve_answers(VARIABLES, [], "t") == {
        "mass": 1.0,
        "joints": 6,
        "frame": "base link",
        "lidar": True,
        "wheels": "two",
    }


@pytest.mark.parametrize(
    ("setting", "value"),
    [
        ("mass=2", 2.0),
        ("mass=1e-1", 0.1),
        ("joints=12", 12),
        ("frame=a/b_c-d.e+f", "a/b_c-d.e+f"),
        ("frame=", ""),
        ("frame=x=1", None),
        ("lidar=false", False),
        ("lidar=True", True),
        ("lidar=0", False),
        ("wheels=four", "four"),
    ],
)
def test_setting(setting: str, value: Answer | None) -> None:
    name = setting.partition("=")[0]
    if value is None:
        with pytest.raises(RequestError):
            resolve_answers(VARIABLES, [setting], "t")
    else:
        answer = resolve_answers(VARIABLES, [setting], "t")[name]
        assert (answer, type(answer)) == (value, type(value))


def test_the_last_setting_counts() -> None:
    assert resolve_answers(VARIABLES, ["mass=2", "mass=3"], "t")["mass"] == 3.0


@pytest.mark.parametrize(
    ("setting", "words"),
    [
        ("mass", "no '='"),
        ("", "no '='"),
        ("=1", "no variable ''"),
        ("Mass=1", "no variable 'Mass'"),
        ("mass=", "must be a number"),
        ("mass=two", "must be a number"),
        ("mass=1,5", "must be a number"),
        ("mass=nan", "must be a number"),
        ("mass=inf", "a number from 0.001 to 100000 kg"),
        ("mass=0", "a number from 0.001 to 100000 kg"),
        ("mass=1 kg", "must be a number"),
        ("joints=13", "an integer from 1 to 12"),
        ("joints=6.0", "an integer"),
        (f"joints={'9' * 5000}", "an integer"),
        ("lidar=yes", "must be true or false"),
        ("wheels=three", "must be one of two, four"),
        *(
            (f"frame={text}", "must be a text of up to")
            for text in ("'", '"', "<", "$(", "{{", "&")
        ),
        *(
            (f"frame={text}", "must be a text")
            for text in (" a", "a  b", "a\n", "ä", "x" * 101, "\\")
        ),
    ],
)
def test_setting_that_makes_no_sense(setting: str, words: str) -> None:
    with pytest.raises(RequestError) as caught:
        resolve_answers(VARIABLES, [setting], "t")
    assert words in caught.value.message
    assert f"--set {setting}" in caught.value.message
    assert "--set" in caught.value.hint


def test_a_template_without_variables() -> None:
    with pytest.raises(RequestError) as caught:
        resolve_answers({}, ["mass=1"], "plain")
    assert "template 'plain' has no variable 'mass'" in caught.value.message
    assert "variables: none" in caught.value.hint


@pytest.mark.parametrize(
    ("value", "text"), [(0.5, "0.5"), (1.0, "1"), (3, "3"), (True, "true"), ("a b", "a b")]
)
def test_values_are_shown_as_they_are_typed(value: Answer, text: str) -> None:
    assert show(value) == text


@pytest.mark.parametrize(
    ("setting", "hint"),
    [
        ("mas=1", "Did you mean `mass`? "),
        ("mass=1,5", "Replace the comma by a point. "),
        ("joints=1,5", "Replace the comma by a point. "),
    ],
)
def test_what_was_meant(setting: str, hint: str) -> None:
    with pytest.raises(RequestError) as caught:
        resolve_answers(VARIABLES, [setting], "t")
    assert (caught.value.hint or "").startswith(hint)
