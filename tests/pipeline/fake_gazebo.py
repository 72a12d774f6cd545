# ruff: noqa: T201  it prints its answers
"""Answers as the command line tools of Gazebo do: the server is a file with what it has.

The texts are those that Gazebo Classic 11.1 printed, and that the documentation of gz-sim shows.
Its name says which program it is; FAKE_GAZEBO is the folder of the file, FAKE_GAZEBO_MODE what it
does: "loses" (what it is first asked to spawn), "sinks" (all models), "refuses"
(to spawn), "crashes" or "hangs" (when it is to simulate).
"""

import json
import os
import re
import signal
import sys
import time
from pathlib import Path
from typing import Any

FOLDER = Path(os.environ["FAKE_GAZEBO"])
MODE = os.environ.get("FAKE_GAZEBO_MODE", "")
STATE = FOLDER / "state.json"


def read() -> Any:
    return json.loads(STATE.read_text()) if STATE.exists() else None


def write(state: Any) -> None:
    part = STATE.with_suffix(f".{os.getpid()}")
    part.write_text(json.dumps(state))
    part.replace(STATE)


def serve() -> None:
    write({"models": {}, "iterations": 0, "pid": os.getpid(), "words": sys.argv[1:]})
    print("[Err] [Plugin.hh:178] Failed to load plugin libnone.so: libnone.so: cannot open shared")
    print("[Err] [RenderEngine.cc:744] Can't open display:", flush=True)
    while True:
        time.sleep(60)


def spawn(file: str, name: str, pose: list[float]) -> bool:
    state = read()
    if MODE == "refuses":
        print("Error Code 19: Msg: a reason")
        return False
    assert Path(file).exists()
    if MODE == "loses" and not state.get("lost"):
        write({**state, "lost": True})
        return True
    z = pose[2] - (0.2 if MODE == "sinks" else 0.0)
    write({**state, "models": {**state["models"], name: [*pose[:2], z]}})
    return True


def step(count: int) -> None:
    state = read()
    if MODE == "crashes":
        os.kill(state["pid"], signal.SIGSEGV)
    if MODE == "hangs":
        return
    write({**state, "iterations": state["iterations"] + count})


def option(words: list[str], *names: str) -> str:
    for place, word in enumerate(words):
        for name in names:
            if word == name:
                return words[place + 1]
            if word.startswith(f"{name}="):
                return word[len(name) + 1 :]
    return ""


def classic(words: list[str]) -> None:
    if words == ["topic", "-l"]:
        print("/gazebo/default/world_stats" if read() else "An instance of Gazebo is not running.")
    elif words[0] == "topic":
        print(f"paused: true iterations: {read()['iterations']}")
    elif words[0] == "world":
        step(int(option(words, "-m")))
    elif option(words, "--spawn-file"):
        pose = [float(option(words, f"--pose-{axis}")) for axis in "xyz"]
        spawn(option(words, "--spawn-file"), option(words, "--model-name"), pose)
    else:
        name = option(words, "-m")
        pose = read()["models"].get(name)
        if pose is None:
            print(f"Unable to get info on model[{name}] in the world[default]")
            return
        print(f'name: "{name}"')
        print_pose(pose, "")
        print(f'joint {{\n  name: "{name}::j"\n  angle: 0.5\n  type: REVOLUTE\n}}')
        print(f'link {{\n  name: "{name}::base"\n  inertial {{\n    mass: 2\n  }}')
        print_pose([0.0, 0.0, 0.0], "  ")
        print("}")


def print_pose(pose: list[float], indent: str) -> None:
    x, y, z = pose
    place = f"position {{\n x: {x}\n y: {y}\n z: {z}\n}}\norientation {{\n w: 1\n}}"
    print(f"{indent}pose {{\n{place}\n}}")


MODEL = """
Requesting state for world [default]...

Model: [8]
  - Name: {name}
  - Pose [ XYZ (m) ] [ RPY (rad) ]:
    [{pose}]
    [0.000000 -0.000000 0.000000]
  - Link [9]
    - Name: base
    - Parent: {name} [8]
    - Mass (kg): 2.000000
    - Inertial Pose [ XYZ (m) ] [ RPY (rad) ]:
      [0.000000 0.000000 7.000000]
      [0.000000 0.000000 0.000000]
    - Inertial Matrix (kg.m^2):
      [0.1 0.0 0.0]
      [0.0 0.1 0.0]
      [0.0 0.0 0.1]
    - Pose [ XYZ (m) ] [ RPY (rad) ]:
      [0.000000 0.000000 0.000000]
      [0.000000 0.000000 0.000000]
  - Joint [21]
    - Name: j
    - Type: revolute
    - Parent Link: base [9]
  - Joint [22]
    - Name: k
    - Type: fixed
"""


def sim(words: list[str]) -> None:
    if words == ["topic", "-l"]:
        print("/clock\n/world/default/stats" if read() else "")
    elif words[0] == "topic":
        print(f"sim_time {{\n sec: 3\n}}\niterations: {read()['iterations']}\npaused: true")
    elif words[0] == "model":
        name = option(words, "-m")
        pose = read()["models"].get(name)
        shown = f"No model named <{name}> was found"
        if pose is not None:
            shown = MODEL.format(name=name, pose=" | ".join(f"{one:f}" for one in pose))
        print(shown)
    else:
        request = option(words, "--req")
        assert option(words, "--reptype").endswith(".msgs.Boolean")
        steps = re.search(r"multi_step: (\d+)", request)
        done = True
        if steps:
            step(int(steps[1]))
        else:
            given = re.findall(r'sdf_filename: "(.+?)", name: "(.+?)".*position: {(.+?)}', request)
            ((file, name, place),) = given
            done = spawn(file, name, [float(one.split(":")[1]) for one in place.split(",")])
        print(f"data: {str(done).lower()}")


program, words = Path(sys.argv[0]).name, sys.argv[1:]
if program == "gzserver" and words == ["--version"]:
    print("Gazebo multi-robot simulator, version 11.10.2")
elif program == "gzserver":
    serve()
elif words[0] in ("sim", "gazebo") and os.environ.get("FAKE_GAZEBO_KIND") == "classic":
    print("Invalid arguments")
    sys.exit(255)
elif words[1:] == ["--versions"]:
    print("8.6.0")
elif words[0] in ("sim", "gazebo"):
    serve()
else:
    (classic if os.environ.get("FAKE_GAZEBO_KIND") == "classic" else sim)(words)
