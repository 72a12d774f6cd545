"""The names that ROS 2 knows."""

from wsgen.ros.names import is_released, released_packages, rosdep_keys


def test_packages_have_the_distributions_that_they_are_released_for() -> None:
    released = released_packages()
    assert released["gazebo_ros"] == ("foxy", "humble", "iron")
    assert "jazzy" in released["ros_gz_sim"]
    assert "foxy" not in released["ros_gz_sim"]
    assert "rosdep" not in {distro for distros in released.values() for distro in distros}
    assert len(released) > 2800


def test_keys_of_rosdep_are_no_packages() -> None:
    assert {"eigen", "libopencv-dev", "python3-numpy"} <= rosdep_keys()
    assert "rclcpp" not in rosdep_keys()


def test_one_name() -> None:
    for name in ("std_msgs", "ament_cmake", "zstd_vendor"):
        assert is_released(name) == (name in released_packages())
    assert is_released("std_msgs")
    for name in ("my_robot", "libboost-dev", "jazzy", "Names"):
        assert not is_released(name)
