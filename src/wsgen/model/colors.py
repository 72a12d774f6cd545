"""The colors that `Gazebo/<Name>` stands for: the diffuse colors of Gazebo Classic's materials.

Source: the material script `gazebo.material` that Gazebo Classic ships. RGBA, 0 to 1.
"""

from __future__ import annotations

Rgba = tuple[float, float, float, float]

GAZEBO_COLORS: dict[str, Rgba] = {
    "Gazebo/Grey": (0.7, 0.7, 0.7, 1.0),
    "Gazebo/Gray": (0.7, 0.7, 0.7, 1.0),
    "Gazebo/DarkGrey": (0.175, 0.175, 0.175, 1.0),
    "Gazebo/DarkGray": (0.175, 0.175, 0.175, 1.0),
    "Gazebo/White": (1.0, 1.0, 1.0, 1.0),
    "Gazebo/FlatBlack": (0.1, 0.1, 0.1, 1.0),
    "Gazebo/Black": (0.0, 0.0, 0.0, 1.0),
    "Gazebo/DarkRed": (0.3, 0.0, 0.0, 1.0),
    "Gazebo/Red": (1.0, 0.0, 0.0, 1.0),
    "Gazebo/RedBright": (0.87, 0.26, 0.07, 1.0),
    "Gazebo/Green": (0.0, 1.0, 0.0, 1.0),
    "Gazebo/DarkGreen": (0.0, 0.5, 0.0, 1.0),
    "Gazebo/Blue": (0.0, 0.0, 1.0, 1.0),
    "Gazebo/SkyBlue": (0.13, 0.44, 0.7, 1.0),
    "Gazebo/DarkBlue": (0.0, 0.0, 0.5, 1.0),
    "Gazebo/Yellow": (1.0, 1.0, 0.0, 1.0),
    "Gazebo/DarkYellow": (0.7, 0.7, 0.0, 1.0),
    "Gazebo/ZincYellow": (0.9725, 0.9529, 0.2078, 1.0),
    "Gazebo/Orange": (1.0, 0.5088, 0.0468, 1.0),
    "Gazebo/DarkOrange": (0.7, 0.3, 0.0, 1.0),
    "Gazebo/Purple": (1.0, 0.0, 1.0, 1.0),
    "Gazebo/DarkMagenta": (0.5, 0.0, 0.5, 1.0),
    "Gazebo/Turquoise": (0.0, 1.0, 1.0, 1.0),
    "Gazebo/Indigo": (0.33, 0.0, 0.5, 1.0),
    "Gazebo/Gold": (0.8, 0.6487, 0.1209, 1.0),
    "Gazebo/GreyTransparent": (0.7, 0.7, 0.7, 0.5),
    "Gazebo/BlackTransparent": (0.0, 0.0, 0.0, 0.5),
    "Gazebo/RedTransparent": (1.0, 0.0, 0.0, 0.5),
    "Gazebo/GreenTransparent": (0.0, 1.0, 0.0, 0.5),
    "Gazebo/BlueTransparent": (0.0, 0.0, 1.0, 0.5),
    "Gazebo/YellowTransparent": (1.0, 1.0, 0.0, 0.5),
    "Gazebo/OrangeTransparent": (1.0, 0.44, 0.0, 0.5),
    "Gazebo/TurquoiseGlow": (0.0, 1.0, 1.0, 1.0),
    "Gazebo/RedGlow": (1.0, 0.0, 0.0, 1.0),
    "Gazebo/GreenGlow": (0.0, 1.0, 0.0, 1.0),
    "Gazebo/BlueGlow": (0.0, 0.0, 1.0, 1.0),
    "Gazebo/YellowGlow": (1.0, 1.0, 0.0, 1.0),
    "Gazebo/PurpleGlow": (1.0, 0.0, 1.0, 1.0),
    "Gazebo/WhiteGlow": (1.0, 1.0, 1.0, 1.0),
    # Textures, by the color that they give on the whole.
    "Gazebo/Wood": (0.62, 0.45, 0.28, 1.0),
    "Gazebo/WoodFloor": (0.62, 0.45, 0.28, 1.0),
    "Gazebo/WoodPallet": (0.62, 0.45, 0.28, 1.0),
    "Gazebo/CeilingTiled": (0.85, 0.85, 0.83, 1.0),
    "Gazebo/PaintedWall": (0.85, 0.82, 0.75, 1.0),
    "Gazebo/Bricks": (0.6, 0.35, 0.28, 1.0),
    "Gazebo/Road": (0.3, 0.3, 0.3, 1.0),
    "Gazebo/Residential": (0.5, 0.5, 0.5, 1.0),
    "Gazebo/Grass": (0.3, 0.5, 0.2, 1.0),
    "Gazebo/Pedestrian": (0.7, 0.6, 0.5, 1.0),
    "Gazebo/Chrome": (0.8, 0.8, 0.82, 1.0),
    "Gazebo/PR2": (0.75, 0.75, 0.75, 1.0),
    "Gazebo/Gazebo": (0.7, 0.7, 0.7, 1.0),
}
