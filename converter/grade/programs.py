"""The programs that are graded: what the command line says of each, and how it is built and called."""

import hashlib
import os
import re
import shlex
import shutil
import stat
import subprocess
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from converter.files import shown_name
from converter.grade.run import Limits, Runner, build_limits, told

PLACES = ("{scene}", "{out}", "{width}", "{height}")
"""What stands in a command for the scene, the picture, and its size."""
CALL = " ".join(PLACES)
_USUAL = ("raytrace", "raytracer", "ray_tracer", "tracer", "rt", "main", "a.out")
"""Names that a program has where a folder holds several."""
_BUILDS = {
    "Makefile": "make",
    "makefile": "make",
    "GNUmakefile": "make",
    "CMakeLists.txt": "cmake -S . -B build -DCMAKE_BUILD_TYPE=Release && cmake --build build",
}
_NAMED = re.compile(r"([\w.-]+)=(.*)", re.DOTALL)
_SAID = 20
"""Lines of what a failed build says that are kept."""


class NoProgram(ValueError):  # noqa: N818 - what it says
    """What the command line names cannot be a program; the message says why."""


@dataclass(frozen=True, slots=True)
class Program:
    """A student's program.

    Attributes:
        name: under which it is told; no other has it.
        folder: what it is built from; None where nothing is built.
        call: its command line, with `PLACES`; "" where the build shows which it is.
        seen: files and folders that it needs.

    """

    name: str
    folder: Path | None
    call: str
    seen: tuple[Path, ...] = ()


@dataclass(frozen=True, slots=True)
class Built:
    """A program that can be run, or why it cannot.

    Attributes:
        call: its command line, with `PLACES`.
        seen: files and folders that it may read.
        trouble: why there is nothing to run; "" if there is.
        said: what the build said where it failed.

    """

    call: str
    seen: tuple[Path, ...]
    trouble: str = ""
    said: str = ""

    def command(self, scene: Path, out: str, width: int, height: int) -> list[str]:
        """The words of its command line for a scene."""
        filled = dict(zip(PLACES, (str(scene), out, str(width), str(height)), strict=True))
        return [
            re.sub("|".join(map(re.escape, PLACES)), lambda found: filled[found[0]], word)
            for word in shlex.split(self.call)
        ]


def read_programs(words: Iterable[str], call: str | None = None) -> list[Program]:
    """What the command line names: folders, programs, or command lines with `PLACES` in them, perhaps `NAME=...`.

    Args:
        words: of the command line.
        call: the command line of the program in each folder, with `PLACES`, relative to it.

    Raises:
        NoProgram: one is none of these.

    """
    programs: list[Program] = []
    taken: dict[str, int] = {}
    for word in words:
        program = _read(word, call)
        taken[program.name] = count = taken.get(program.name, 0) + 1
        if count > 1:
            name = f"{program.name}-{count}"
            program = Program(name, program.folder, program.call, program.seen)
            taken[name] = 1
        programs.append(program)
    return programs


def _read(word: str, call: str | None) -> Program:
    if "{scene}" in word:
        return _of_command_line(word)
    path = Path(word)
    if path.is_dir():
        return Program(plain_name(path.resolve().name), path.resolve(), call or "")
    if not path.is_file():
        raise NoProgram(f"{word}: no such program or folder; a command line has {{scene}} and {{out}} in it")
    if not os.access(path, os.X_OK):
        raise NoProgram(f"{word}: this file is no program: it is not executable")
    path = path.resolve()
    return Program(plain_name(path.name), None, f"{shlex.quote(str(path))} {CALL}", (path.parent,))


def _of_command_line(word: str) -> Program:
    named = _NAMED.match(word)
    name, line = (named[1], named[2]) if named else ("", word)
    try:
        words = shlex.split(line)
    except ValueError as error:
        raise NoProgram(f"{line}: {error}".lower()) from None
    if "{out}" not in line:
        raise NoProgram(f"{line}: there is no {{out}} in it, the picture to be written")
    found = shutil.which(words[0])
    if found is None:
        raise NoProgram(f"{line}: there is no program {words[0]!r}")
    words[0] = str(Path(found).absolute())
    seen = []
    for k, each in enumerate(words):
        if not any(place in each for place in PLACES) and (k == 0 or Path(each).exists()):
            path = Path(each).absolute()
            words[k] = str(path)
            seen += [where if where.is_dir() else where.parent for where in (path, path.resolve())]
    last = next((each for each in reversed(words) if Path(each).is_file()), words[0])
    return Program(name or plain_name(Path(last).stem), None, shlex.join(words), tuple(_outermost(seen)))


def _outermost(paths: Iterable[Path]) -> Iterator[Path]:
    """Folders that lie in none of the others."""
    for path in sorted({*paths}):
        if not any(other in path.parents for other in paths):
            yield path


def plain_name(name: str) -> str:
    """A name that can be a file's on any system."""
    return re.sub(r"[^\w.-]+", "_", shown_name(name)).strip(".") or "program"


def build(
    program: Program, work: Path, command: str | None, limits: Limits, runner: Runner, cores: Sequence[int]
) -> Built:
    """Make the program, in a copy of its folder below `work`; its own folder stays as it is.

    Args:
        program: it.
        work: a folder for the copy, which stays.
        command: what makes it; None: by what its folder holds, `make` for a Makefile.
        limits: those of the program, see `build_limits`.
        runner: runs what makes it.
        cores: processors on which it is made.

    """
    if program.folder is None:
        return Built(program.call, program.seen)
    copy = work / program.name
    remove_all(copy)
    try:
        _copy(program.folder, copy)
    except (OSError, shutil.Error) as error:
        return Built("", (), f"its folder cannot be copied: {_first(error)}")
    maker = command or next((made for file, made in _BUILDS.items() if (copy / file).is_file()), None)
    before = {file: _stamp(file) for file in _executables(copy)}
    if maker is not None:
        of_build = build_limits(limits)
        ending = runner.run(["/bin/sh", "-c", maker], copy, program.seen, of_build, cores)
        if trouble := told(ending, of_build):
            return Built("", (), f"its build {trouble}", "\n".join(ending.told.strip().splitlines()[-_SAID:]))
    if program.call:
        return Built(_in_folder(program.call, copy), (copy, *program.seen))
    found = _executables(copy)
    made = [file for file in found if before.get(file) != _stamp(file)] or found
    if not made:
        return Built("", (), "there is no Makefile and no program" if maker is None else "its build makes no program")
    chosen = _choose(made, program.name)
    if chosen is None:
        names = ", ".join(sorted(str(file.relative_to(copy)) for file in made)[:4])
        return Built("", (), f"it is not clear which of {names} is the program: say so by --run")
    return Built(f"{shlex.quote(str(chosen))} {CALL}", (copy, *program.seen))


def _choose(made: Sequence[Path], name: str) -> Path | None:
    if len(made) == 1:
        return made[0]
    for usual in (*_USUAL, name):
        named = [file for file in made if file.stem == Path(usual).stem]
        if len(named) == 1:
            return named[0]
    return None


def _in_folder(call: str, folder: Path) -> str:
    """A command line whose files lie in a folder, by their whole names."""
    words = shlex.split(call)
    return shlex.join(str(folder / word) if (folder / word).is_file() else word for word in words)


def _executables(folder: Path) -> list[Path]:
    """Programs in a folder, of machine code or with a first line that names what runs them."""
    found = []
    for parent, _, names in os.walk(folder):
        for name in names:
            path = Path(parent, name)
            with suppress(OSError):
                kind = path.lstat().st_mode
                if stat.S_ISREG(kind) and kind & stat.S_IXUSR and not name.endswith((".so", ".o", ".sh")):
                    with path.open("rb") as opened:
                        if opened.read(4).startswith((b"\x7fELF", b"#!", b"\xcf\xfa\xed\xfe")):
                            found.append(path)
    return sorted(path for path in found if "CMakeFiles" not in path.parts)


def _stamp(file: Path) -> tuple[int, int]:
    seen = file.stat()
    return seen.st_mtime_ns, seen.st_size


def _copy(folder: Path, copy: Path) -> None:
    """Copy a folder; of what is no file or folder, nothing, and links as they are."""

    def strange(parent: str, names: list[str]) -> list[str]:
        kinds = {name: Path(parent, name).lstat().st_mode for name in names}
        return [
            name for name, kind in kinds.items() if not (stat.S_ISREG(kind) or stat.S_ISDIR(kind) or stat.S_ISLNK(kind))
        ]

    copy.parent.mkdir(parents=True, exist_ok=True)
    shutil.copytree(folder, copy, symlinks=True, ignore=strange)


def remove_all(folder: Path) -> None:
    """Remove what a stranger's program has left: locked folders, and deeper ones than Python bears, too."""
    if not folder.exists():
        return
    for words in (["chmod", "-R", "u+rwX"], ["rm", "-rf"]):
        subprocess.run([*words, "--", str(folder)], check=False, capture_output=True)


def fingerprint(program: Program) -> str:
    """A number that changes with the program: with its call, and with the files that it consists of."""
    digest = hashlib.sha256(f"{program.call}\0".encode())
    roots = [program.folder] if program.folder is not None else [Path(w) for w in shlex.split(program.call)]
    for root in roots:
        for file in _files(root):
            digest.update(f"{file}\0".encode(errors="surrogateescape"))
            with suppress(OSError):
                if stat.S_ISREG(file.lstat().st_mode) and file.stat().st_size <= _MOST_READ:
                    digest.update(file.read_bytes())
                else:
                    digest.update(str(file.lstat().st_size).encode())
    return digest.hexdigest()


_MOST_READ = 1 << 26


def _files(root: Path) -> list[Path]:
    if root.is_dir() and not root.is_symlink():
        return sorted(Path(parent, name) for parent, _, names in os.walk(root) for name in names)
    return [root] if root.is_file() else []


def _first(error: Exception) -> str:
    return str(error).strip().partition("\n")[0]
