from glob import glob

from setuptools import setup

setup(
    name="liner",
    version="0.1.0",
    packages=["liner"],
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/liner"]),
        ("share/liner", ["package.xml"]),
        ("share/liner/launch", glob("launch/*")),
        ("share/liner/urdf", glob("urdf/*")),
        ("share/liner/worlds", glob("worlds/*")),
    ],
    install_requires=["setuptools"],
    zip_safe=True,
    maintainer="student",
    maintainer_email="student@example.com",
    description="A robot that follows a line on the ground, in Gazebo",
    license="Apache-2.0",
    entry_points={
        "console_scripts": [
            "camera_follower = liner.camera_follower:main",
            "lidar_follower = liner.lidar_follower:main",
        ],
    },
)
