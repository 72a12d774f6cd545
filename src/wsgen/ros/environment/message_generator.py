"""What generates the code of messages: a program of its own, because it runs the generators of ROS.

Started with PYTHONPATH at the environment of ROS. It reads from its standard input, as JSON:

    package      name
    source       folder with msg, srv, action
    files        interfaces in it: msg/NAME.msg, ...
    share        folder for .idl and .json, which becomes share/PACKAGE
    code         folder for what is compiled, and its headers: PACKAGE/msg/...
    introspection  the same for the type support for introspection, whose files have equal names
    python       folder for the Python package
    resources    share folder of the generators
    shares       share folders of the packages whose types may be used: [name, folder]

The generators run one beside the other, each in a fork: they take turns with nothing. Each of them
would parse all files anew, which takes longer than to generate; so the parsed files are kept.
"""

from __future__ import annotations

import functools
import json
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

# The first one sends messages; Fast DDS describes their types to others by the second.
TYPE_SUPPORTS = ["rosidl_typesupport_fastrtps_c", "rosidl_typesupport_introspection_c"]


def main() -> None:
    """Generate the code of one package."""
    request = json.load(sys.stdin)
    sys.stdout = sys.stderr  # rosidl_adapter prints what it reads
    remember_templates()
    import rosidl_parser.parser  # noqa: PLC0415  only the generator has it

    # Not by the locator of a file, which is another one each time.
    rosidl_parser.parser.parse_idl_string = functools.lru_cache(None)(
        rosidl_parser.parser.parse_idl_string
    )
    from rosidl_adapter import convert_to_idl  # noqa: PLC0415  as above
    from rosidl_generator_c import generate_c  # noqa: PLC0415  as above
    from rosidl_generator_py.generate_py_impl import generate_py  # noqa: PLC0415  as above
    from rosidl_generator_type_description import generate_type_hash  # noqa: PLC0415  as above
    from rosidl_typesupport_c import generate_c as generate_type_support  # noqa: PLC0415
    from rosidl_typesupport_fastrtps_c import generate_typesupport_fastrtps_c  # noqa: PLC0415  as above
    from rosidl_typesupport_introspection_c import generate_c as generate_introspection  # noqa: PLC0415

    package = request["package"]
    source, share = Path(request["source"]), Path(request["share"])
    code = Path(request["code"])
    resources = Path(request["resources"])
    files = [source / name for name in request["files"]]
    names = []
    for file in files:
        if file.suffix == ".idl":
            written = share / file.relative_to(source)
            written.parent.mkdir(parents=True, exist_ok=True)
            written.write_bytes(file.read_bytes())
        else:
            written = convert_to_idl(source, package, file.relative_to(source), share)
        names.append(str(written.relative_to(share)))
    common = {
        "package_name": package,
        "idl_tuples": [f"{share}:{name}" for name in names],
        "target_dependencies": [],
        "ros_interface_files": [str(file) for file in files],
        "include_paths": [f"{name}:{folder}" for name, folder in request["shares"]],
    }

    def arguments(generator: str, output: Path, **more: Any) -> str:
        file = code / f"{generator}.json"
        resource = resources / generator / "resource"
        content = {**common, "output_dir": str(output), "template_dir": str(resource), **more}
        file.write_text(json.dumps(content), encoding="utf-8")
        return str(file)

    generate_type_hash(arguments("rosidl_generator_type_description", share))
    described = [f"{name}:{share / Path(name).with_suffix('.json')}" for name in names]
    target = code / package
    of_c = arguments("rosidl_generator_c", target, type_description_tuples=described)
    of_fastrtps = arguments("rosidl_typesupport_fastrtps_c", target)
    of_introspection = arguments(
        "rosidl_typesupport_introspection_c", Path(request["introspection"], package)
    )
    of_type_support = arguments("rosidl_typesupport_c", target)
    of_python = arguments("rosidl_generator_py", Path(request["python"], package))
    in_forks(
        lambda: generate_py(of_python, ["rosidl_typesupport_c"]),
        lambda: generate_c(of_c),
        lambda: generate_typesupport_fastrtps_c(of_fastrtps),
        lambda: generate_introspection(of_introspection),
        lambda: generate_type_support(of_type_support, TYPE_SUPPORTS),
    )
    Path(request["python"], package, "__init__.py").touch()
    for generator in ("rosidl_generator_c", *TYPE_SUPPORTS):
        for template in Path(resources, generator, "resource").glob("*__visibility_control.h.in"):
            text = template.read_text(encoding="utf-8").replace("@PROJECT_NAME@", package)
            header = target / "msg" / template.name.removesuffix(".in")
            header.parent.mkdir(exist_ok=True)
            header.write_text(text.replace("@PROJECT_NAME_UPPER@", package.upper()), "utf-8")


def remember_templates() -> None:
    """Have empy take each template apart, and compile its code, once.

    It does so for each interface anew, and takes most of the time for that.
    """
    import em  # noqa: PLC0415  only the generator has it

    known: dict[tuple[str, str], list[Any]] = {}

    def parse(interpreter: Any, scanner: Any, names: Any = None) -> None:
        text = scanner.rest()
        if (tokens := known.get((scanner.prefix, text))) is not None:
            scanner.advance(len(text))
            for token in tokens:
                token.run(interpreter, names)
            return
        tokens = []
        while (token := scanner.one()) is not None:
            tokens.append(token)
            token.run(interpreter, names)
        known[scanner.prefix, text] = tokens

    compiled = functools.lru_cache(None)(compile)

    def evaluate(code: str, *names: Any) -> Any:
        return eval(compiled(code.lstrip(" \t"), "<string>", "eval"), *names)  # noqa: S307  as empy

    def execute(code: str, *names: Any) -> None:
        exec(compiled(code, "<string>", "exec"), *names)  # noqa: S102  as empy

    em.Interpreter.parse = parse
    em.eval, em._exec = evaluate, execute  # noqa: SLF001  names that it has


def in_forks(*works: Callable[[], object]) -> None:
    """Do each work in a process of its own, all at the same time."""
    processes = []
    for work in works:
        process = os.fork()
        if process == 0:
            status = 1
            try:
                work()
                status = 0
            except Exception as error:  # noqa: BLE001  the parent reports whatever it is
                sys.stderr.write(f"{type(error).__name__}: {error}\n")
            finally:
                sys.stderr.flush()
                os._exit(status)
        processes.append(process)
    statuses = [os.waitpid(process, 0)[1] for process in processes]
    if any(statuses):
        sys.exit(1)


if __name__ == "__main__":
    main()
