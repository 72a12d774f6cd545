"""Facts of Gazebo Classic and Gazebo Sim, each once: plugins, systems and sensors, with sources.

Rules, readers and live runs read them. May import `model` and what is below it.
"""
