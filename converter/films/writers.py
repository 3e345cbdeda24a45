"""Pictures into film files: .mp4 and .webm by PyAV, .gif, .webp and .png by Pillow."""

from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from typing import Any

from converter.films.errors import FilmError
from converter.renderers.base import Progress

CODECS = {".mp4": "libx264", ".webm": "libvpx-vp9"}
_QUALITY = {".mp4": {"crf": "18", "preset": "medium"}, ".webm": {"crf": "24", "b:v": "0", "row-mt": "1"}}
ENDINGS = (".mp4", ".webm", ".gif", ".webp", ".png")


def check_writer(ending: str) -> None:
    """See that films of that ending can be written here.

    Raises:
        FilmError: what is needed is not installed.

    """
    _library("av" if ending in CODECS else "PIL")


def write_film(file: Path, ending: str, pictures: Sequence[Path], fps: Fraction, progress: Progress) -> None:
    """Write a film of pictures of one size, `fps` of them a second, into a new file.

    Raises:
        FilmError: what is needed is not installed, or refuses it.
        OSError: it cannot be written.

    """
    write: Callable[..., None] = _write_video if ending in CODECS else _write_animation
    write(file, ending, pictures, fps, progress)


def _write_video(file: Path, ending: str, pictures: Sequence[Path], fps: Fraction, progress: Progress) -> None:
    av: Any = _library("av")
    try:
        with av.open(str(file), "w", format=ending[1:]) as film:
            first = _levels(pictures[0])
            height, width = first.shape[:2]
            # Players that decode by hardware know colours at half the resolution only, which needs even sizes.
            colors = "yuv420p" if width % 2 == height % 2 == 0 else "yuv444p"
            stream = film.add_stream(CODECS[ending], rate=fps, options=_QUALITY[ending])
            stream.width, stream.height, stream.pix_fmt = width, height, colors
            for k, picture in enumerate(pictures):
                frame = av.VideoFrame.from_ndarray(_levels(picture), format="rgb24")
                frame.pts, frame.time_base = k, 1 / fps
                film.mux(stream.encode(frame))
                progress((k + 1) / len(pictures))
            film.mux(stream.encode(None))
    except av.error.FFmpegError as error:
        raise FilmError(f"{file.suffix} film: {error.strerror or error}") from error


def _levels(picture: Path) -> Any:
    """The picture's 8-bit RGB, height x width x 3."""
    import numpy as np

    image = _library("PIL.Image").open(picture)
    with image:
        return np.asarray(image.convert("RGB"))


def _write_animation(file: Path, ending: str, pictures: Sequence[Path], fps: Fraction, progress: Progress) -> None:
    frames = _Frames(pictures, ending == ".gif", progress)
    options: dict[str, Any] = {"quality": 85, "method": 4} if ending == ".webp" else {}
    durations = _durations(len(pictures), fps, 10 if ending == ".gif" else 1)
    frames.opened(0).save(
        file, ending[1:].upper(), save_all=True, append_images=frames, duration=durations, loop=0, **options
    )


class _Frames:
    """The pictures after the first, opened one by one, as often as Pillow asks for them."""

    def __init__(self, pictures: Sequence[Path], palette: bool, progress: Progress) -> None:
        self._pictures, self._palette, self._progress = pictures, palette, progress

    def __iter__(self) -> Iterator[Any]:
        for k in range(1, len(self._pictures)):
            yield self.opened(k)
            self._progress((k + 1) / len(self._pictures))

    def opened(self, k: int) -> Any:
        image: Any = _library("PIL.Image")
        with image.open(self._pictures[k]) as found:
            found.load()
        return _with_palette(found, image) if self._palette else found


def _with_palette(found: Any, image: Any) -> Any:
    """256 colours of the picture's own: without dithering, which would crawl over what stands still."""
    return found.convert("RGB").quantize(256, method=image.Quantize.MEDIANCUT, dither=image.Dither.NONE)


def _durations(count: int, fps: Fraction, step: int) -> list[int]:
    """Milliseconds of each picture in whole steps, so that their sum is off by less than one."""
    ends = [round(1000 * k / fps / step) * step for k in range(count + 1)]
    return [end - begin for begin, end in pairwise(ends)]


def _library(name: str) -> Any:
    from importlib import import_module

    try:
        return import_module(name)
    except ImportError:
        raise FilmError("films need PyAV and Pillow, which are not here: pip install 'whitted[film]'") from None
