"""A package to which something is added: texts with what is inserted, new files, what is left."""

from __future__ import annotations

import os
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, NamedTuple

from wsgen.checks.fixes.manifests import declare, text_of, top_of
from wsgen.checks.fixes.plan import FileFix, is_whole
from wsgen.checks.fixes.source import SourceText, apply, read_source
from wsgen.errors import NotReadableError
from wsgen.isolation.parent import make_scratch
from wsgen.packages.build_files.facts import UNSEEN_FOLDERS, read_build_facts
from wsgen.packages.workspace.manifest import RUN_TAGS
from wsgen.porting.write import write_port
from wsgen.templating.render import render_source
from wsgen.text.files import write_file

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping

    from wsgen.checks.fixes.source import Edit
    from wsgen.model.build_facts import BuildFacts, Executable
    from wsgen.model.target import Target
    from wsgen.packages.workspace.layout import PackageFolder

MANIFEST, CMAKE, SETUP = "package.xml", "CMakeLists.txt", "setup.py"


class Paste(NamedTuple):
    """What cannot be placed safely: the author puts it there."""

    file: Path
    text: str  # the lines
    where: str  # a sentence: where they belong, and why they are not there


class AddPlan(NamedTuple):
    """What is added to a package; nothing of it is written yet."""

    files: tuple[FileFix, ...]
    created: tuple[tuple[Path, str], ...]  # files with their texts
    programs: tuple[Path, ...]  # those of them that can be run
    pasted: tuple[Paste, ...]
    kept: tuple[Path, ...]  # files that exist, and stay as they are

    @property
    def is_empty(self) -> bool:
        """Whether all of it is there already."""
        return not (self.files or self.created or self.pasted)


class Addition:
    """What is added to one package, as far as it is made.

    Each edit sees the text that those before it have made.
    """

    def __init__(
        self, package: PackageFolder, target: Target, workspace: Mapping[str, PackageFolder]
    ) -> None:
        self.package = package
        self.name = package.name
        self.folder = package.path
        self.is_python = package.build_type == "ament_python"
        self.target = target
        self.workspace = workspace  # the packages around it, and itself, by name
        self.pasted: list[Paste] = []
        self._before: dict[Path, SourceText] = {}
        self._now: dict[Path, SourceText] = {}
        self._created: dict[Path, str] = {}
        self._programs: list[Path] = []
        self._kept: list[Path] = []

    @property
    def newline(self) -> str:
        """The line end of new files: that of package.xml."""
        source = self.source(self.folder / MANIFEST)
        return source.newline if source else "\n"

    def source(self, file: Path) -> SourceText | None:
        """A file with what is inserted so far; None where it does not exist or cannot be read."""
        if file in self._created:
            return SourceText(file, self._created[file])
        if file not in self._now:
            read = read_source(file)
            if read is None:
                return None
            self._before[file] = self._now[file] = read
        return self._now[file]

    def will_have(self, file: Path) -> bool:
        """Whether a file is added."""
        return file in self._created

    def require(self, file: Path) -> SourceText:
        """A file of the package with what is inserted so far.

        Raises:
            NotReadableError: It does not exist, or cannot be read.
        """
        source = self.source(file)
        if source is None:
            raise NotReadableError(
                f"{file} does not exist, or is not a text in UTF-8.",
                hint=f"Restore it, for example: git checkout {file.name}",
            )
        return source

    def edit(self, file: Path, edits: Iterable[Edit]) -> bool:
        """Insert into a file; whether it could be done. What would break the file is left out."""
        source = self.require(file)
        after = apply(source.text, edits)
        if after == source.text or (is_whole(source, source.text) and not is_whole(source, after)):
            return False
        changed = SourceText(file, after, mark=source.mark)
        if file in self._created:
            self._created[file] = after
        else:
            self._now[file] = changed
        return True

    def create(self, path: str, template: str, *, runs: bool = False, **names: Any) -> Path:
        """Add a file of a template; one that exists stays as it is."""
        file = self.folder / path
        if os.path.lexists(file):
            self._kept.append(file)
        elif file not in self._created:
            text = self.render(template, **names)
            # A shebang with another line end is not found.
            self._created[file] = text if runs else text.replace("\n", self.newline)
            if runs:
                self._programs.append(file)
        return file

    def render(self, template: str, **names: Any) -> str:
        """The text of a template."""
        package = SimpleNamespace(name=self.name, target=self.target)
        return render_source(f"wsgen:added/{template}.j2", package=package, **names)

    def paste(self, file: Path, text: str, where: str) -> None:
        """List what is left to the author."""
        self.pasted.append(Paste(file, text, where))

    # package.xml

    def depend(self, tag: str, *names: str) -> None:
        """Declare dependencies, where nothing declares them that counts for the same.

        Args:
            tag: `exec_depend` for what is needed to run, `depend` also to build, `test_depend`, or
                another one that is declared as it is.
            names: Of packages.
        """
        file = self.folder / MANIFEST
        source = self.require(file)
        _, top = top_of(source)
        declared: dict[str, set[str]] = {}
        for one in top:
            if one.name.endswith("depend") or one.name == "member_of_group":
                declared.setdefault(text_of(source, one), set()).add(one.name)
        _, before = top_of(self._before[file])
        used = {one.name for one in before}  # as the author writes them
        wanted = [
            (instead, name)
            for name in dict.fromkeys(names)
            if name != self.name
            and (instead := _lacking_tag(tag, declared.get(name, set()), used)) is not None
        ]
        if wanted and not self.edit(file, declare(source, wanted)):
            lines = [f"<{one}>{name}</{one}>" for one, name in wanted]
            self.paste(file, "\n".join(lines), "Add the dependencies to <package>.")

    # What is installed then

    @contextmanager
    def laid_out(self) -> Iterator[Path]:
        """A copy of the package, of links, with what is added."""
        with make_scratch(in_memory=True) as scratch:
            copy = scratch / "src" / self.folder.name
            for folder, folders, files in os.walk(self.folder):
                folders[:] = [name for name in folders if name not in UNSEEN_FOLDERS]
                here = copy / Path(folder).relative_to(self.folder)
                here.mkdir(parents=True)
                for name in files:
                    (here / name).symlink_to(Path(folder) / name)
            for file, text in self._texts():
                place = copy / file.relative_to(self.folder)
                place.parent.mkdir(parents=True, exist_ok=True)
                place.unlink(missing_ok=True)
                place.write_text(text, encoding="utf-8", newline="")
                place.chmod(0o755 if file in self._programs else 0o644)
            yield copy

    def _texts(self) -> Iterator[tuple[Path, str]]:
        yield from self._created.items()
        for file, source in self._now.items():
            if source is not self._before[file]:
                yield file, source.text

    def facts(self) -> tuple[BuildFacts, Path]:
        """What the build files say with what is added, and the folder that its paths are in."""
        with self.laid_out() as copy:
            facts, _ = read_build_facts(copy, self.name, self.package.build_type)
            return facts, copy

    def is_shared(self, file: Path) -> bool:
        """Whether a file is installed into the share folder."""
        facts, copy = self.facts()
        place = copy / file.relative_to(self.folder)
        return any(one.source == place and one.is_of_share(self.name) for one in facts.installed)

    def executable(self, name: str) -> Executable | None:
        """The program of this name that `ros2 run` finds."""
        facts, _ = self.facts()
        return next((one for one in facts.executables if one.name == name), None)

    # The end

    def finish(self) -> AddPlan:
        """All of it."""
        files = [
            FileFix(
                file=file,
                before=self._before[file].text,
                after=source.text,
                data=source.encoded(source.text),
                fixed=(),
            )
            for file, source in self._now.items()
            if source is not self._before[file]
        ]
        return AddPlan(
            files=tuple(sorted(files, key=lambda one: one.file)),
            created=tuple(self._created.items()),
            programs=tuple(self._programs),
            pasted=tuple(dict.fromkeys(self.pasted)),
            kept=tuple(self._kept),
        )


def _lacking_tag(tag: str, tags: set[str], used: set[str]) -> str | None:
    """The tag by which a dependency is to be declared; None: it is, for the same.

    Args:
        tag: That is wanted.
        tags: By which it is declared.
        used: All tags that the author writes.
    """
    if "depend" in tags or tag in tags:
        return None
    if tag == "depend":
        lacking = [
            one
            for one, same in (("build_depend", {"build_depend"}), ("exec_depend", {*RUN_TAGS}))
            if not same & tags
        ]
        return tag if len(lacking) > 1 else lacking[0] if lacking else None
    if tag in {"exec_depend", "test_depend"} and tags & {*RUN_TAGS}:
        return None
    if tag == "buildtool_depend" and "build_depend" in tags:
        return None
    is_whole = tag == "exec_depend" and "exec_depend" not in used and "depend" in used
    return "depend" if is_whole else tag


def write_addition(
    plan: AddPlan, proves: Callable[[], bool] = lambda: True
) -> tuple[list[Path], bool]:
    """Write all files, or none; gives those that are written, and whether they stay.

    Args:
        plan: What is written.
        proves: Is called when all is written; where it is not so, all is taken back.

    Raises:
        NotReadableError: A file cannot be written; those before it are as they were.
    """
    before = {one.file: one.file.read_bytes() for one in plan.files}
    written: list[Path] = []
    stays = False
    try:
        for file in write_port(plan):
            written.append(file)
            if file in plan.programs:
                file.chmod(file.stat().st_mode | 0o111)
        stays = proves()
    except OSError as error:
        raise NotReadableError(
            f"{error.filename} cannot be written: {error.strerror}.",
            hint="Check its folder (ls -ld); nothing has changed.",
        ) from error
    finally:
        for file in () if stays else written:
            if file in before:
                write_file(file, before[file])
            else:
                file.unlink(missing_ok=True)
    return written, stays
