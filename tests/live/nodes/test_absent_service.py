"""What is said of a service that cannot be called."""

from __future__ import annotations

from wsgen.live.nodes.unanswered import absent_service

EMPTY, TRIGGER = "std_srvs/srv/Empty", "std_srvs/srv/Trigger"
OFFERED = {
    "/stop": [TRIGGER],
    "/reset_world": [EMPTY],
    "/pilot/get_parameters": ["rcl_interfaces/srv/GetParameters"],
}


def test_services_of_the_type_are_named() -> None:
    message, hint = absent_service("/stopp", TRIGGER, OFFERED)
    assert message == "No node offers the service /stopp."
    assert hint == "Did you mean `/stop`? Services of this type: /stop."


def test_a_service_of_another_type_may_be_meant() -> None:
    _, hint = absent_service("reset_word", TRIGGER, OFFERED)
    assert hint == "Did you mean `/reset_world`? Services of this type: /stop."
    _, hint = absent_service("/go", "my_robot/srv/Go", OFFERED)
    assert hint == "No service has the type my_robot/srv/Go. Services: /reset_world, /stop."


def test_a_service_has_another_type() -> None:
    assert absent_service("stop", EMPTY, OFFERED) == (
        f"The service /stop has the type {TRIGGER}, and not {EMPTY}.",
        f'Call it with "{TRIGGER}".',
    )


def test_services_for_parameters_are_no_services_of_the_robot() -> None:
    only = {"/pilot/get_parameters": OFFERED["/pilot/get_parameters"]}
    _, hint = absent_service("/stop", EMPTY, only)
    assert hint.startswith("No node offers services")
