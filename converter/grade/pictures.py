"""Takes the picture that a program has left, and trusts nothing about it."""

import errno
import os
import stat
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from converter.files import shown_name
from converter.grade.run import MIB, Limits, Runner, told
from converter.why.picture import Picture, Theirs, is_lossy, read_theirs

ENDINGS = (".ppm", ".png", ".jpg", ".jpeg", ".bmp", ".tga", ".tif", ".tiff", ".gif", ".webp", ".exr", ".hdr", ".pfm")
MOST_PIXELS = 1 << 22
"""Of a picture that is judged; one of another size than asked may have any."""
_READS = Limits(seconds=20, memory=2048, output=256)


class NoPicture(ValueError):  # noqa: N818 - what it says
    """There is no picture that can be judged; the message says why."""


@dataclass(frozen=True, slots=True)
class Left:
    """What a program has left in its folder: the bytes of a picture, and the name under which they were."""

    data: bytes
    name: str


def take(folder: Path, out: str, before: Sequence[str], most: int) -> Left:
    """The bytes of the picture in a program's folder.

    Under another name it is taken as well, if it is the only picture that has come to the folder. Links are not
    followed: neither to another's picture nor to anything else.

    Args:
        folder: where the program ran, which has ended.
        out: the name that was asked for.
        before: names that were there before.
        most: bytes that are taken.

    Raises:
        NoPicture: there is none.

    """
    within = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
    try:
        names = sorted(set(os.listdir(within)) - {*before})  # noqa: PTH208 - of a descriptor
        if out not in names:
            others = [name for name in names if Path(name).suffix.lower() in ENDINGS]
            if len(others) != 1:
                raise NoPicture("it writes no picture")
            out = others[0]
        return Left(_read(within, out, most), shown_name(out))
    finally:
        os.close(within)


def _read(within: int, name: str, most: int) -> bytes:
    try:
        file = os.open(name, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK, dir_fd=within)
    except OSError as error:
        if error.errno == errno.ELOOP:
            raise NoPicture("its picture is a link to something else") from None
        raise NoPicture(f"its picture cannot be read: {(error.strerror or '').lower()}") from None
    try:
        kind = os.fstat(file)
        if not stat.S_ISREG(kind.st_mode):
            raise NoPicture("its picture is no file")
        if kind.st_nlink != 1:
            raise NoPicture("its picture is a link to something else")
        if kind.st_size == 0:
            raise NoPicture("its picture is empty")
        if kind.st_size > most:
            raise NoPicture(f"its picture has more than {most // MIB} MiB")
        with os.fdopen(file, "rb", closefd=False) as opened:
            return opened.read(most)
    finally:
        os.close(file)


def decode(file: Path, runner: Runner, cores: Sequence[int]) -> Theirs:
    """The picture in a file.

    PPM is read here, by a reader that bears anything. Other formats are read by libraries in C, which may crash or
    never end: by a process of their own, within limits and walls.

    Raises:
        NoPicture: it is none, broken, or too large.

    """
    from converter.images.ppm import is_ppm
    from converter.images.texture import TextureError, probe_texture

    with file.open("rb") as opened:
        plain = is_ppm(opened.read(3))
    try:
        if plain:
            width, height = probe_texture(file)
            _check_size(width, height)
            return read_theirs(file)
    except TextureError as error:
        raise NoPicture(f"its picture cannot be read: {_reason(error, file)}") from None
    return Theirs(file, _decode_apart(file, runner, cores), is_lossy(file))


def _decode_apart(file: Path, runner: Runner, cores: Sequence[int]) -> Picture:
    from tempfile import TemporaryDirectory

    with TemporaryDirectory() as name:
        folder = Path(name)
        command = [sys.executable, "-m", "converter.grade.pictures", str(file), str(folder / "levels.npy")]
        seen = [file, *_own_folders()]
        ending = runner.run(command, folder, seen, _READS, cores)
        if trouble := told(ending, _READS):
            said = ending.told.strip().splitlines()
            reason = said[-1] if ending.status == 1 and said else f"what reads it {trouble}"
            raise NoPicture(f"its picture cannot be read: {reason[:200]}")
        levels: Picture = np.load(folder / "levels.npy", allow_pickle=False)
        return levels


def _own_folders() -> list[Path]:
    """Where Python and this package lie, for a process within walls."""
    paths = {
        Path(sys.prefix),
        Path(sys.base_prefix),
        Path(sys.executable).parent,
        Path(sys.executable).resolve().parent,
    }
    paths |= {Path(path) for path in sys.path if path and Path(path).exists()}
    paths.add(Path(__file__).resolve().parents[2])
    return sorted(p for p in paths if not p.is_relative_to("/usr") and p != Path("/") and p.exists())


def _check_size(width: int, height: int) -> None:
    if width * height > MOST_PIXELS:
        raise NoPicture(f"its picture has {width} x {height} pixels, too many to be judged")


def _reason(error: Exception, file: Path) -> str:
    return str(error).removeprefix(f"{file}: ")


def main() -> int:
    """Read the picture in the first argument, and write its levels into the second."""
    from converter.images.texture import TextureError, probe_texture

    file, out = Path(sys.argv[1]), Path(sys.argv[2])
    try:
        _check_size(*probe_texture(file))
        np.save(out, read_theirs(file).levels)
    except (TextureError, NoPicture) as error:
        print(_reason(error, file).removeprefix("its picture has "))
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
