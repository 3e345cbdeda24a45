"""Writes pictures: PPM directly, all other formats through OpenImageIO.

No object of OpenImageIO is kept at module level: nanobind would report it as leaked when Mitsuba is loaded as well.
"""

import errno
import os
from contextlib import suppress
from pathlib import Path
from typing import Any

from converter.descriptors import named_descriptor
from converter.files import check_special, is_special, replacing, temporary_name

COMMON_ENDINGS = (".ppm", ".png", ".exr", ".jpg", ".tif", ".hdr", ".pfm", ".bmp", ".tga", ".webp")
"""Endings to suggest; OpenImageIO knows more."""
FLOAT_ENDINGS = frozenset({".exr", ".hdr", ".pfm", ".tif", ".tiff"})
"""Formats that keep the floats as they are, neither clamped nor rounded."""
_NO_FILES = frozenset({".term", ".null", ".nul"})  # OpenImageIO's outputs that leave no file
_HARMLESS = "TIFFWriteCustomDirectory"  # OpenImageIO complains so of every TIFF file, and all is well with it


class ImageError(OSError):
    """A picture cannot be written; the message names the file and says why."""


def check_ending(path: str | Path, ending: str | None = None) -> None:
    """See that there are pictures of that ending, the given one or that of `path`.

    Raises:
        ImageError: nothing is known of it.
    """
    try:
        _known(Path(path), ending)
    except ImageError as error:
        raise ImageError(f"{path}: {error}") from None


def check_writable(path: str | Path, ending: str | None = None) -> None:
    """See that `write_image` could write `path`, so that no one waits for a picture that cannot be saved.

    Raises:
        ImageError: the ending is unknown, its folder missing or not writable, or it is a folder itself, or a terminal.
    """
    path = Path(path)
    try:
        ending = _known(path, ending)
        if is_special(path):
            _check_special(path)
            return
        temporary = temporary_name(_target(path), ending)
        try:
            temporary.touch(exist_ok=False)
        finally:
            with suppress(OSError):
                temporary.unlink()
    except OSError as error:
        raise ImageError(f"{path}: {_reason(error, path)}") from error


def write_image(path: str | Path, pixels: Any, width: int, height: int, ending: str | None = None) -> None:
    """Write a picture.

    Formats of 8 bits hold the nearest of 255 levels (see `native_tracer.quantize`), with no gamma; those of
    `FLOAT_ENDINGS` hold the colours as they are.
    The file appears as a whole or not at all, whatever happens; an older one is replaced. Into what is special, such as
    a pipe, /dev/null or /dev/stdout, the picture is copied.

    Args:
        path: the file; if it is a link, what it points to is written.
        pixels: buffer of height x width x 3 float32, linear RGB, row 0 on top.
        width: columns.
        height: rows.
        ending: chooses the format; that of `path`, if not given, and .ppm for what is special and has none.

    Raises:
        ImageError: it cannot be written.
        BrokenPipeError: whoever reads the pipe went away.
        ValueError: `pixels` has another size.
    """
    path = Path(path)
    values = memoryview(pixels)
    if (
        values.format != "f"
        or not values.c_contiguous
        or values.nbytes != 12 * width * height
        or min(width, height) < 1
    ):
        expected = f"{width} x {height} pixels of three float32, one after the other"
        raise ValueError(f"expected {expected}, found {values.nbytes} bytes of format {values.format!r}")
    try:
        ending = _known(path, ending)
        write = _write_ppm if ending == ".ppm" else _write_other
        with replacing(path if is_special(path) else _target(path), ending) as temporary:
            write(temporary, values, width, height)
    except BrokenPipeError:
        raise
    except OSError as error:
        raise ImageError(f"{path}: {_reason(error, path)}") from error


def _write_ppm(path: Path, values: memoryview, width: int, height: int) -> None:
    from native_tracer import quantize

    with path.open("xb") as file:
        file.write(b"P6\n%d %d\n255\n" % (width, height))
        file.write(quantize(values))


def _write_other(path: Path, values: memoryview, width: int, height: int) -> None:
    import OpenImageIO as oiio  # noqa: N813 - its own documentation's name

    if path.suffix.lower() in FLOAT_ENDINGS:
        format_, data = oiio.FLOAT, values.cast("B").cast("f")
    else:
        from native_tracer import quantize

        format_, data = oiio.UINT8, memoryview(quantize(values))
    # Room is taken first: OpenImageIO does not notice a full disk in every format, and its WebP then never returns.
    with path.open("xb") as file:
        if hasattr(os, "posix_fallocate"):  # macOS has none
            os.posix_fallocate(file.fileno(), 0, data.nbytes + 65536)
            file.truncate(0)
    output = oiio.ImageOutput.create(_utf8(path))
    if output is None:
        raise OSError(oiio.geterror())
    spec = oiio.ImageSpec(width, height, 3, format_)
    spec.attribute("DateTime", "")  # that of writing, else, and the same picture would be another file
    done = output.open(str(path), spec)
    done = done and output.write_image(data)
    done = output.close() and done
    complaints = [line for line in output.geterror().splitlines() if _HARMLESS not in line]
    if not done or complaints:
        raise OSError(complaints[0] if complaints else "OpenImageIO does not say why")


def _utf8(path: Path) -> str:
    """A path as OpenImageIO takes it; `ImageError` where its bytes are no UTF-8."""
    try:
        return str(path).encode().decode()
    except UnicodeEncodeError as error:
        told = f"{path.suffix} files need folders whose names are UTF-8, which PPM files do not"
        raise ImageError(told) from error


def _known(path: Path, given: str | None) -> str:
    """The given ending, else that of `path`; `ImageError` for a format that nobody writes."""
    ending = (path.suffix if given is None else given).lower()
    if ending == ".ppm" or (not ending and is_special(path)):
        return ".ppm"
    if ending and ending not in _NO_FILES:
        import OpenImageIO as oiio  # noqa: N813

        if oiio.ImageOutput.create(f"picture{ending}") is not None:
            return ending
        oiio.geterror()  # clears it
    found = f"unknown picture format {ending!r}" if ending else "no ending that says which picture format is meant"
    raise ImageError(f"{found}; use one of {', '.join(COMMON_ENDINGS)}")


def _check_special(path: Path) -> None:
    check_special(path)
    descriptor = named_descriptor(path)
    if descriptor is not None and os.isatty(descriptor):
        raise ImageError("this is a terminal, which shows no picture: name a file, or send it on with > or |")


def _target(path: Path) -> Path:
    """The file to replace: what `path` points to, if it is a link."""
    try:
        target = path.resolve() if path.is_symlink() else path
    except RuntimeError as error:
        raise OSError(errno.ELOOP, "this is a link that leads to itself") from error
    if target.is_dir():
        raise IsADirectoryError(errno.EISDIR, "this is a folder")
    if target.exists() and not os.access(target, os.W_OK):  # replacing it would succeed, and is not wanted
        raise PermissionError(errno.EACCES, "the file there is write-protected")
    return target


def _reason(error: OSError, path: Path) -> str:
    if isinstance(error, ImageError):
        return str(error)
    if isinstance(error, FileNotFoundError):
        return f"there is no folder {str(path.parent)!r}"
    if isinstance(error, NotADirectoryError):
        return f"{str(path.parent)!r} is not a folder"
    return (error.strerror or str(error)).strip().lower()
