"""IMUs: gravity, motion, references and noise, in the frame of the sensor."""

from __future__ import annotations

import math

import numpy as np
import pytest

from live.nodes.sensor_texts import element
from wsgen.live.nodes.simulator.sensors.motion import InertialUnit, reference_of
from wsgen.model.transform import IDENTITY, Pose, rotation_of_rpy

G = 9.8
STILL = np.zeros(3)


def unit(text: str | None = None, reference: Pose = IDENTITY) -> InertialUnit:
    return InertialUnit(
        None if text is None else element(text),
        np.random.default_rng(0),
        gravity=(0.0, 0.0, -G),
        reference=np.array(rotation_of_rpy(reference.rpy)),
    )


def test_at_rest_it_feels_what_holds_it_up() -> None:
    measured = unit().measure(Pose(), STILL, STILL, 1.0)
    assert measured.acceleration == pytest.approx((0.0, 0.0, G))
    assert measured.turning == pytest.approx((0.0, 0.0, 0.0))
    assert measured.orientation == pytest.approx(np.eye(3))


def test_it_measures_in_its_own_frame() -> None:
    """Pitched by 90 degrees, its x looks down and its z ahead."""
    pose = Pose((0.0, 0.0, 0.0), (0.0, math.pi / 2, 0.0))
    measured = unit().measure(pose, STILL, np.array([1.0, 2.0, 3.0]), 0.0)
    assert measured.acceleration == pytest.approx((-G, 0.0, 0.0), abs=1e-12)
    assert measured.turning == pytest.approx((-3.0, 2.0, 1.0))


def test_it_feels_acceleration_and_nothing_in_free_fall() -> None:
    one = unit()
    one.measure(Pose(), STILL, STILL, 0.0)
    pushed = one.measure(Pose(), np.array([0.5, 0.0, 0.0]), STILL, 0.1)
    assert pushed.acceleration == pytest.approx((5.0, 0.0, G))
    falling = one.measure(Pose(), np.array([0.5, 0.0, -0.1 * G]), STILL, 0.2)
    assert falling.acceleration == pytest.approx((0.0, 0.0, 0.0))
    one.forget()
    assert one.measure(Pose(), STILL, STILL, 0.3).acceleration == pytest.approx((0.0, 0.0, G))


def test_orientation_is_against_the_reference() -> None:
    turned = Pose((0.0, 0.0, 0.0), (0.0, 0.0, 0.7))
    measured = unit(reference=turned).measure(turned, STILL, STILL, 0.0)
    assert measured.orientation == pytest.approx(np.eye(3))


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("<imu/>", None),
        ("<imu><orientation_reference_frame/></imu>", None),
        (
            (
                "<imu><orientation_reference_frame><localization>ENU</localization>"
                "</orientation_reference_frame></imu>"
            ),
            (0.0, 0.0, 0.0),
        ),
        (
            (
                "<imu><orientation_reference_frame><localization>NED</localization>"
                "</orientation_reference_frame></imu>"
            ),
            (math.pi, 0.0, math.pi / 2),
        ),
        (
            (
                "<imu><orientation_reference_frame><localization>CUSTOM</localization>"
                '<custom_rpy parent_frame="world">0 0 1</custom_rpy>'
                "</orientation_reference_frame></imu>"
            ),
            (0.0, 0.0, 1.0),
        ),
        (
            (
                "<imu><orientation_reference_frame><localization>CUSTOM</localization>"
                '<custom_rpy parent_frame="base">0 0 1</custom_rpy>'
                "</orientation_reference_frame></imu>"
            ),
            None,
        ),
    ],
)
def test_references_of_gazebo_sim(text: str, expected: tuple[float, ...] | None) -> None:
    found = reference_of(element(text))
    if expected is None:
        assert found is None
    else:
        assert found is not None
        roll, pitch, yaw = expected
        assert found == pytest.approx(np.array(rotation_of_rpy((roll, pitch, yaw))))


def test_each_axis_has_its_own_noise() -> None:
    text = (
        "<imu><angular_velocity><x><noise type='gaussian'><stddev>0.2</stddev></noise></x>"
        "</angular_velocity><linear_acceleration><z><noise type='gaussian'>"
        "<bias_mean>0.5</bias_mean></noise></z></linear_acceleration></imu>"
    )
    one = unit(text)
    many = [one.measure(Pose(), STILL, STILL, 0.01 * step) for step in range(2000)]
    turning = np.array([each.turning for each in many])
    assert turning[:, 0].std() == pytest.approx(0.2, rel=0.1)
    assert not turning[:, 1:].any()
    felt = np.array([each.acceleration for each in many])
    assert abs(felt[0, 2] - G) == pytest.approx(0.5)
    assert [noise.variance for noise in one.noises["angular_velocity"]] == pytest.approx(
        [0.04, 0.0, 0.0]
    )


def test_a_drift_wanders_as_far_as_it_may() -> None:
    text = (
        "<imu><angular_velocity><x><noise type='gaussian'><stddev>0</stddev>"
        "<dynamic_bias_stddev>0.1</dynamic_bias_stddev>"
        "<dynamic_bias_correlation_time>2</dynamic_bias_correlation_time></noise></x>"
        "</angular_velocity></imu>"
    )
    one = unit(text)
    drift = [one.measure(Pose(), STILL, STILL, 0.1 * step).turning[0] for step in range(5000)]
    assert np.std(drift) == pytest.approx(0.1 * math.sqrt(2.0 / 2), rel=0.2)
    assert abs(drift[1] - drift[0]) < 0.1
