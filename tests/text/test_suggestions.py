"""The name that was meant is asked for in the same words everywhere."""

from wsgen.text import suggestions


def test_a_word_is_never_taken_for_itself() -> None:
    assert suggestions.nearest("height", ["height", "heights"]) == "heights"
    assert suggestions.nearest("height", ["height"]) is None


def test_a_name_in_another_case_is_the_nearest() -> None:
    assert suggestions.nearest("X", ["y", "x", "yaw"]) == "x"
    assert suggestions.nearest("twist", ["Twists", "Twist", "twirl"]) == "Twist"
    assert suggestions.suggest("X", ["y", "x"]) == "Did you mean `x`?"
    assert suggestions.nearest("x", ["x", "y"]) is None


def test_the_order_of_the_known_names_does_not_matter() -> None:
    known = ["wheel_a", "wheel_b", "wheel_c"]
    assert suggestions.nearest("wheel", known) == suggestions.nearest("wheel", known[::-1])


def test_advice_asks_first_and_says_what_to_do_otherwise() -> None:
    assert suggestions.advice("hight", ["height"], "Define it.") == (
        "Did you mean `height`? If not, define it."
    )
    assert suggestions.advice("speed", ["height"], "Define it.") == "Define it."


def test_only_a_few_of_many_names_are_listed() -> None:
    names = [f"robot_{number:02}" for number in range(10)]
    assert suggestions.suggest("x", names).endswith("robot_07 and 2 more.")


def test_a_typing_mistake_is_distinguished_from_another_name() -> None:
    known = ["robot_state_publisher", "xacro", "marti_can_msgs", "ros_gz_sim", "gz_sim8_vendor"]
    known += ["nav_msgs", "std_srvs"]
    assert suggestions.misspelled_as("nav_msg", known) == "nav_msgs"
    assert suggestions.misspelled_as("std_srv", known) == "std_srvs"
    assert suggestions.misspelled_as("std_msg", known) is None
    assert suggestions.misspelled_as("robot_state_publiser", known) == "robot_state_publisher"
    assert suggestions.misspelled_as("xarco", known) == "xacro"
    assert suggestions.misspelled_as("ros-gz-sim", known) == "ros_gz_sim"
    assert suggestions.misspelled_as("ros_gz_ism", known) == "ros_gz_sim"
    assert suggestions.misspelled_as("rclcp", ["rclc", "rclcpp", "rclpy"]) == "rclcpp"
    assert suggestions.misspelled_as("my_tst", ["my_test"]) == "my_test"
    assert suggestions.misspelled_as("my_arm", ["my_arms"]) is None
    assert suggestions.misspelled_as("smart_can_msgs", known) is None
    assert suggestions.misspelled_as("ros_ign_sim", known) is None
    assert suggestions.misspelled_as("gz_sim9_vendor", known) is None


def test_mistakes_between_words() -> None:
    assert suggestions.mistakes_between("xacro", "xacro") == 0
    assert suggestions.mistakes_between("xarco", "xacro") == 1
    assert suggestions.mistakes_between("xacr", "xacro") == 1
    assert suggestions.mistakes_between("", "xacro") == 5
