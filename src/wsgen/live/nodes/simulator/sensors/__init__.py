"""The sensors that the simulator has.

A kind is the attribute `type` of a `<sensor>`; the class follows its module, which is imported when
a robot has such a sensor. It takes the `MountedSensor` where that of a plugin takes its element.
"""

from __future__ import annotations

_HERE = "wsgen.live.nodes.simulator.sensors"

SENSORS: dict[str, str] = {
    **dict.fromkeys(("ray", "gpu_ray", "lidar", "gpu_lidar"), f"{_HERE}.lidar:Lidar"),
    "imu": f"{_HERE}.navigation:Imu",
    "contact": f"{_HERE}.forces:ContactSensor",
    "force_torque": f"{_HERE}.forces:ForceTorque",
    **dict.fromkeys(("gps", "navsat"), f"{_HERE}.navigation:NavSat"),
    "altimeter": f"{_HERE}.navigation:Altimeter",
    "air_pressure": f"{_HERE}.navigation:AirPressure",
    "magnetometer": f"{_HERE}.navigation:Magnetometer",
    **dict.fromkeys(
        ("camera", "multicamera", "depth", "depth_camera", "rgbd", "rgbd_camera"),
        f"{_HERE}.camera:Camera",
    ),
}
