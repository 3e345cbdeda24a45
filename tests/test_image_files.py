"""Pictures are written as they should be, whole or not at all, and trouble is told before it costs anything."""

import os
import resource
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio  # noqa: N813
import pytest

from converter.images import write
from converter.images.texture import read_texture
from converter.images.write import ImageError, check_writable, write_image

NAN, INF = float("nan"), float("inf")
PIXELS = np.array(
    [
        [[0, 0.5, 1], [-1, 2, NAN]],
        [[INF, -INF, 1e-9], [0.2, 0.4, 0.6]],
        [[1 / 255, 0.4999 / 255, 0.5001 / 255], [0, 0, 1]],
    ],
    dtype=np.float32,
)
BYTES = np.array(
    [[[0, 128, 255], [0, 255, 0]], [[255, 0, 0], [51, 102, 153]], [[1, 0, 1], [0, 0, 255]]], dtype=np.uint8
)
FINITE = np.array([[[0, 0.5, 1], [-1, 2, 300]], [[1e-3, 0, 7], [1, 2, 3]]], dtype=np.float32)


def files(folder: Path) -> list[str]:
    return sorted(entry.name for entry in folder.iterdir())


def test_ppm_to_the_byte(tmp_path: Path) -> None:
    write_image(tmp_path / "a.ppm", PIXELS, 2, 3)
    assert (tmp_path / "a.ppm").read_bytes() == b"P6\n2 3\n255\n" + BYTES.tobytes()
    assert files(tmp_path) == ["a.ppm"]


@pytest.mark.parametrize("ending", [".png", ".PNG", ".bmp", ".tga", ".sgi", ".pnm", ".PPM", ".dpx"])
def test_other_formats_hold_the_same_bytes(ending: str, tmp_path: Path) -> None:
    file = tmp_path / f"a{ending}"
    write_image(file, PIXELS, 2, 3)
    np.testing.assert_array_equal(np.rint(np.asarray(read_texture(file).texels) * 255), BYTES)
    assert files(tmp_path) == [file.name]


@pytest.mark.parametrize("ending", [".exr", ".pfm", ".tif", ".tiff"])
def test_float_formats_keep_what_is_there(ending: str, tmp_path: Path) -> None:
    file = tmp_path / f"a{ending}"
    write_image(file, FINITE, 2, 2)
    np.testing.assert_array_equal(np.asarray(read_texture(file).texels), FINITE)


def test_hdr_keeps_what_it_can(tmp_path: Path) -> None:
    write_image(tmp_path / "a.hdr", FINITE, 2, 2)
    expected = np.maximum(FINITE, 0)
    np.testing.assert_allclose(np.asarray(read_texture(tmp_path / "a.hdr").texels), expected, atol=1.5)


@pytest.mark.parametrize("ending", [".exr", ".tif", ".png"])
def test_the_same_picture_is_the_same_file_later(ending: str, tmp_path: Path) -> None:
    file = tmp_path / f"a{ending}"
    write_image(file, FINITE, 2, 2)
    assert not oiio.ImageBuf(str(file)).spec().get_string_attribute("DateTime")


@pytest.mark.parametrize("ending", [".jpg", ".jpeg", ".webp", ".gif", ".jp2"])
def test_lossy_formats_come_close(ending: str, tmp_path: Path) -> None:
    ramp = np.linspace(0, 1, 64, dtype=np.float32)
    pixels = np.repeat(np.repeat(ramp[:, None, None], 64, axis=1), 3, axis=2)
    write_image(tmp_path / f"a{ending}", pixels, 64, 64)
    texture = read_texture(tmp_path / f"a{ending}")
    assert (texture.width, texture.height) == (64, 64)
    np.testing.assert_allclose(np.asarray(texture.texels), pixels, atol=0.04)


@pytest.mark.parametrize("name", ["a.ppm", "a.png", "a.exr"])
def test_any_float_buffer_will_do(name: str, tmp_path: Path) -> None:
    flat = memoryview(FINITE.tobytes()).cast("f")
    for pixels in (flat, flat.cast("B").cast("f", (2, 2, 3)), FINITE.reshape(4, 3)):
        write_image(tmp_path / name, pixels, 2, 2)
        assert read_texture(tmp_path / name).width == 2


@pytest.mark.parametrize(
    ("pixels", "width", "height"),
    [
        (PIXELS, 3, 3),
        (PIXELS.astype(np.float64), 2, 3),
        (BYTES, 2, 3),
        (np.zeros(0, np.float32), 2, 3),
        (PIXELS[::-1], 2, 3),
    ],
)
def test_a_buffer_of_another_size_or_type_is_refused(pixels: Any, width: int, height: int, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=f"expected {width} x {height} pixels of three float32"):
        write_image(tmp_path / "a.ppm", pixels, width, height)
    assert files(tmp_path) == []


def test_an_older_picture_is_replaced(tmp_path: Path) -> None:
    (tmp_path / "a.ppm").write_text("old")
    write_image(tmp_path / "a.ppm", PIXELS, 2, 3)
    assert (tmp_path / "a.ppm").read_bytes().startswith(b"P6")
    assert files(tmp_path) == ["a.ppm"]


def test_a_link_stays_and_its_target_is_written(tmp_path: Path) -> None:
    (tmp_path / "real").mkdir()
    (tmp_path / "real" / "b.data").write_text("old")
    (tmp_path / "a.png").symlink_to(tmp_path / "real" / "b.data")
    check_writable(tmp_path / "a.png")
    write_image(tmp_path / "a.png", PIXELS, 2, 3)
    assert (tmp_path / "a.png").is_symlink()
    assert (tmp_path / "real" / "b.data").read_bytes().startswith(b"\x89PNG")
    assert files(tmp_path / "real") == ["b.data"]


@pytest.mark.parametrize("name", ["pipe.ppm", "pipe.png", "link.ppm"])
def test_into_a_pipe_the_picture_is_copied(name: str, tmp_path: Path) -> None:
    pipe = tmp_path / f"pipe{Path(name).suffix}"
    os.mkfifo(pipe)
    (tmp_path / "link.ppm").symlink_to(pipe)
    write_image(tmp_path / f"file{pipe.suffix}", PIXELS, 2, 3)
    before = files(tmp_path)
    with os.fdopen(
        os.open(pipe, os.O_RDWR), "rb", buffering=0
    ) as reader:  # both ends, so that neither waits for the other
        check_writable(tmp_path / name)
        write_image(tmp_path / name, PIXELS, 2, 3)
        expected = (tmp_path / f"file{pipe.suffix}").read_bytes()
        assert reader.read(len(expected)) == expected
    assert pipe.is_fifo()
    assert files(tmp_path) == before


def test_a_full_device_is_told(tmp_path: Path) -> None:
    if not Path("/dev/full").exists():
        pytest.skip("there is no /dev/full")
    (tmp_path / "a.ppm").symlink_to("/dev/full")
    with pytest.raises(ImageError, match=r"a\.ppm: no space left on device"):
        write_image(tmp_path / "a.ppm", PIXELS, 2, 3)
    assert not Path("/dev/full").is_file()


def test_a_given_ending_counts_more_than_the_name(tmp_path: Path) -> None:
    check_writable(tmp_path / "picture", ".ppm")
    write_image(tmp_path / "picture", PIXELS, 2, 3, ".ppm")
    assert (tmp_path / "picture").read_bytes().startswith(b"P6")


def test_names_with_blanks_and_accents(tmp_path: Path) -> None:
    for name in ("uma esfera.ppm", "céu #1.png", "x" * 250 + ".exr"):
        check_writable(tmp_path / name)
        write_image(tmp_path / name, PIXELS, 2, 3)
        assert (tmp_path / name).is_file()


def test_a_picture_has_the_usual_permissions(tmp_path: Path) -> None:
    (tmp_path / "usual").touch()
    for name in ("a.ppm", "a.png"):
        write_image(tmp_path / name, PIXELS, 2, 3)
        assert (tmp_path / name).stat().st_mode == (tmp_path / "usual").stat().st_mode


# ------------------------------------------------------------------------------------------------------------- trouble


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("a.xyz", "unknown picture format '.xyz'; use one of .ppm, .png, .exr"),
        ("a.term", "unknown picture format '.term'"),
        ("a.null", "unknown picture format '.null'"),
        ("a", "no ending that says which picture format is meant; use one of .ppm"),
        (".ppm", "no ending that says which picture format is meant; use one of .ppm"),
        ("none/a.ppm", "there is no folder '"),
        ("none/a.png", "there is no folder '"),
        ("file/a.ppm", "is not a folder"),
        ("folder.ppm", "this is a folder"),
        ("folder.png", "this is a folder"),
        ("x" * 300 + ".ppm", "file name too long"),
        ("loop.ppm", "this is a link that leads to itself"),
    ],
)
def test_trouble_is_told_before_and_after(name: str, message: str, tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    (tmp_path / "folder.ppm").mkdir()
    (tmp_path / "folder.png").mkdir()
    (tmp_path / "loop.ppm").symlink_to(tmp_path / "loop.ppm")
    before = files(tmp_path)
    for attempt in (lambda: check_writable(tmp_path / name), lambda: write_image(tmp_path / name, PIXELS, 2, 3)):
        with pytest.raises(ImageError) as caught:
            attempt()
        assert str(caught.value).startswith(f"{tmp_path / name}: ")
        assert message in str(caught.value)
        assert files(tmp_path) == before


def test_checking_leaves_nothing(tmp_path: Path) -> None:
    (tmp_path / "old.png").write_text("old")
    for name in ("a.ppm", "a.png", "old.png"):
        check_writable(tmp_path / name)
    assert files(tmp_path) == ["old.png"]
    assert (tmp_path / "old.png").read_text() == "old"


def test_what_is_write_protected_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "a.ppm").write_text("old")
    # Whoever runs the tests as root may write anything: the answer is given for an ordinary user.
    monkeypatch.setattr("os.access", lambda path, mode: False)
    for attempt in (lambda: check_writable(tmp_path / "a.ppm"), lambda: write_image(tmp_path / "a.ppm", PIXELS, 2, 3)):
        with pytest.raises(ImageError, match=r"a\.ppm: the file there is write-protected"):
            attempt()
    assert (tmp_path / "a.ppm").read_text() == "old"


@pytest.mark.parametrize("name", ["a.ppm", "a.png", "a.jpg", "a.exr", "a.hdr", "a.tif", "a.webp", "a.bmp", "a.pfm"])
def test_a_full_disk_is_told_and_leaves_the_old_picture(name: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text("old")
    noise = np.random.default_rng(1).random((200, 300, 3)).astype(np.float32)
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, limits[1]))  # the nearest to a full disk that any user can make
    try:
        with pytest.raises(ImageError, match="file too large"):
            write_image(tmp_path / name, noise, 300, 200)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert files(tmp_path) == [name]
    assert (tmp_path / name).read_text() == "old"


@pytest.mark.parametrize("name", ["a.ppm", "a.png"])
@pytest.mark.parametrize("error", [KeyboardInterrupt, MemoryError, OSError("boom")])
def test_an_interrupt_leaves_the_old_picture(
    name: str, error: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / name).write_text("old")

    def half(path: Path, *rest: Any) -> None:
        path.write_bytes(b"half of it")
        raise error

    monkeypatch.setattr(write, "_write_ppm", half)
    monkeypatch.setattr(write, "_write_other", half)
    with pytest.raises((KeyboardInterrupt, MemoryError, ImageError)):
        write_image(tmp_path / name, PIXELS, 2, 3)
    assert files(tmp_path) == [name]
    assert (tmp_path / name).read_text() == "old"


def test_what_openimageio_refuses_is_told(tmp_path: Path) -> None:
    pixels = np.zeros((300, 300, 3), np.float32)
    with pytest.raises(ImageError, match=r"a\.ico: .*256x256"):
        write_image(tmp_path / "a.ico", pixels, 300, 300)
    with pytest.raises(ImageError, match=r"a\.jp2: "):
        write_image(tmp_path / "a.jp2", PIXELS[:1, :1].copy(), 1, 1)
    assert files(tmp_path) == []


def test_nothing_of_openimageio_is_kept() -> None:
    kept = [name for name, value in vars(write).items() if type(value).__module__.startswith("OpenImageIO")]
    assert kept == []
    assert not any(value is oiio for value in vars(write).values())


def test_ppm_needs_no_heavy_module(tmp_path: Path) -> None:
    code = (
        "import sys; from converter.images.write import check_writable, write_image; "
        f"file = {str(tmp_path / 'a.ppm')!r}; check_writable(file); "
        "write_image(file, memoryview(bytes(72)).cast('f'), 2, 3); "
        "print('numpy' in sys.modules, 'OpenImageIO' in sys.modules)"
    )
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert result.stdout.split() == ["False", "False"]
