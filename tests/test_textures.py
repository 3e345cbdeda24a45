"""Textures: every way to write a PPM file, other formats, and files that only look like images."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from converter.images.ppm import LARGE
from converter.images.texture import Texture, TextureError, probe_texture, read_texture

PIXELS = np.array([[[0, 1, 2], [50, 100, 150]], [[255, 254, 253], [7, 0, 9]], [[1, 1, 1], [0, 0, 0]]], dtype=np.uint8)
RASTER = PIXELS.tobytes()
PLAIN = " ".join(map(str, PIXELS.ravel())).encode()


def texels(texture: Texture) -> np.ndarray:
    return np.asarray(texture.texels)


def read(folder: Path, data: bytes, name: str = "t.ppm") -> Texture:
    file = folder / name
    file.write_bytes(data)
    texture = read_texture(file)
    assert probe_texture(file) == (texture.width, texture.height)
    return texture


def save(file: Path, pixels: np.ndarray, **attributes: object) -> Path:
    """Write an image with OpenImageIO, as the format for the array's type has it."""
    height, width, channels = pixels.shape
    types = {"uint8": oiio.UINT8, "uint16": oiio.UINT16, "float32": oiio.FLOAT}
    spec = oiio.ImageSpec(width, height, channels, types[str(pixels.dtype)])
    for name, value in attributes.items():
        spec.attribute(name.replace("__", ":"), value)
    output = oiio.ImageOutput.create(str(file))
    assert output.open(str(file), spec)
    assert output.write_image(pixels)
    assert output.close()
    return file


# ----------------------------------------------------------------------------------------------------------------- PPM


@pytest.mark.parametrize(
    "header",
    [
        b"P6\n2 3\n255\n",
        b"P6 2 3 255 ",
        b"P6\t2\r\n3\r255\t",
        b"P6\n# a comment\n2 3\n# 9 9\n255\n",
        b"P6\n2 # columns\n3 # rows\n255\n",
        b"P6#comment\n2 3 255\n",
        b"P6 2#\n3#\n255#\n",
        b"P6\n#" + b"x" * 5000 + b"\n2 3\n255\n",
        b"P6\n002 003\n0255\n",
        b"P6\n2 3\n255\r\n",  # written as text on Windows
    ],
)
def test_headers(header: bytes, tmp_path: Path) -> None:
    texture = read(tmp_path, header + RASTER)
    assert (texture.width, texture.height) == (2, 3)
    np.testing.assert_array_equal(texels(texture), (PIXELS / 255).astype(np.float32))


@pytest.mark.parametrize(
    "data",
    [
        b"P3\n2 3\n255\n" + PLAIN,
        b"P3 2 3 255 " + PLAIN.replace(b" ", b"\n"),
        b"P3\n2 3\n255\n" + PLAIN.replace(b" ", b"\t \r\n") + b"\n",
        b"P3\n2 3\n255\n" + PLAIN.replace(b" ", b"# a comment 1 2 3\n", 4) + b"# the end",
        b"P3\n2 3\n255\n" + PLAIN + b" 1 2 3\n",  # more than asked for, as with P6
    ],
)
def test_plain_files(data: bytes, tmp_path: Path) -> None:
    np.testing.assert_array_equal(texels(read(tmp_path, data)), (PIXELS / 255).astype(np.float32))


def test_what_a_texture_is(tmp_path: Path) -> None:
    texture = read(tmp_path, b"P6 2 3 255\n" + RASTER)
    view = texture.texels
    assert (view.format, view.shape, view.c_contiguous, view.readonly) == ("f", (3, 2, 3), True, True)
    assert view[1, 0, 2] == pytest.approx(253 / 255)  # row 1, column 0, blue
    assert view[2, 1, 0] == 0


def test_bytes_behind_the_raster_are_left_alone(tmp_path: Path) -> None:
    read(tmp_path, b"P6 2 3 255\n" + RASTER + b"\n")
    texture = read(tmp_path, b"P6 2 3 255\n" + RASTER + RASTER)
    np.testing.assert_array_equal(texels(texture), (PIXELS / 255).astype(np.float32))


@settings(max_examples=60, deadline=None)
@given(data=st.data())
def test_every_largest_value(data: st.DataObject, tmp_path_factory: pytest.TempPathFactory) -> None:
    maxval = data.draw(
        st.one_of(st.integers(1, 300), st.integers(1, 65535), st.sampled_from([1, 255, 256, 1000, 65535]))
    )
    size = data.draw(st.tuples(st.integers(1, 4), st.integers(1, 4)))
    count = size[0] * size[1] * 3
    values = data.draw(st.lists(st.integers(0, maxval), min_size=count, max_size=count))
    raster = np.array(values, dtype=np.uint8 if maxval < 256 else ">u2").tobytes()
    folder = tmp_path_factory.mktemp("ppm")
    expected = (np.array(values) / maxval).astype(np.float32).reshape(size[1], size[0], 3)
    binary = read(folder, b"P6 %d %d %d\n" % (*size, maxval) + raster)
    plain = read(folder, b"P3 %d %d %d\n" % (*size, maxval) + " ".join(map(str, values)).encode())
    np.testing.assert_array_equal(texels(binary), expected)
    np.testing.assert_array_equal(texels(plain), expected)


def test_large_files_of_16_bits_are_read_the_same(tmp_path: Path) -> None:
    width, height = 700, LARGE // 2100 + 1
    values = np.random.default_rng(1).integers(0, 1001, (height, width, 3)).astype(">u2")
    head = b"P6 %d %d 1000\n" % (width, height)
    expected = (values / 1000).astype(np.float32)
    np.testing.assert_array_equal(texels(read(tmp_path, head + values.tobytes())), expected)
    values[-1, -1, -1] = 1001
    with pytest.raises(TextureError, match="it has the value 1001 above its largest, 1000"):
        read(tmp_path, head + values.tobytes())


def test_large_plain_files_are_read_in_blocks(tmp_path: Path) -> None:
    values = np.random.default_rng(1).integers(0, 1001, (400, 300, 3))
    data = b"P3 300 400 1000\n" + b"\n".join(b"%d" % value for value in values.ravel())
    assert len(data) > 1 << 20
    np.testing.assert_array_equal(texels(read(tmp_path, data)), (values / 1000).astype(np.float32))


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"P6", "no image that can be read"),
        (b"P6 ", "its header has no proper width, found ''"),
        (b"P6 2 ", "its header has no proper height, found ''"),
        (b"P6 2 x 255\n" + RASTER, "its header has no proper height, found 'x'"),
        (b"P6 2 -3 255\n" + RASTER, "its header has no proper height, found '-'"),
        (b"P6 2.0 3 255\n" + RASTER, "its header has no proper height, found '.'"),
        (b"P6 2 3 99999999999 " + RASTER, "its header has no proper maxval, found '99999999999'"),
        (b"P6 2 3 255", "its header does not end with white space"),
        (b"P6 2 3 255x" + RASTER, "its header does not end with white space"),
        (b"P6 2 3 255 # no end", "it is cut off"),
        (b"P6 #" + b"x" * 100_000 + b"\n2 3 255\n" + RASTER, "its header has no proper width, found ''"),
        (b"P6 0 3 255\n", "it is empty: 0 x 3 pixels"),
        (b"P6 2 3 0\n" + RASTER, "its largest value must lie between 1 and 65535, found 0"),
        (b"P6 2 3 65536\n" + RASTER * 2, "its largest value must lie between 1 and 65535, found 65536"),
        (b"P6 2 3 255\n" + RASTER[:-1], "it is cut off: 2 x 3 pixels need 18 bytes, 17 are there"),
        (b"P6 2 3 256\n" + RASTER, "it is cut off: 2 x 3 pixels need 36 bytes, 18 are there"),
        (b"P6 999999999 999999999 255\n" + RASTER, "it is cut off: 999999999 x 999999999 pixels need"),
        (b"P3 999999999 999999999 255\n" + PLAIN, "it is cut off: 999999999 x 999999999 pixels need at least"),
        (b"P6 2 3 254\n" + RASTER, "it has values above its largest, 254"),
        (b"P6 1 1 256\n\1\1\0\0\0\0", "it has the value 257 above its largest, 256"),
        (b"P3 2 3 254\n" + PLAIN, "it has the value 255 above its largest, 254"),
        (b"P3 2 3 255\n" + PLAIN.replace(b"255", b"9" * 5000), "it has the value inf above its largest, 255"),
        (b"P3 2 3 255\n" + b"100 " * 17, "it is cut off: 18 numbers are needed, 17 are there"),
        (b"P3 1 1 255\n1 2.5 3", "it has '.' where numbers belong"),
        (b"P3 1 1 255\n1 -2 3", "it has '-' where numbers belong"),
        (b"P3 1 1 255\n1 2 3 end", "it has 'end' where numbers belong"),
        (b"", "no image that can be read"),
        (b"no image", "no image that can be read"),
        (b"P7\nWIDTH 2\n", "no image that can be read"),
    ],
)
def test_broken_files(data: bytes, message: str, tmp_path: Path) -> None:
    file = tmp_path / "t.ppm"
    file.write_bytes(data)
    with pytest.raises(TextureError) as caught:
        read_texture(file)
    assert str(caught.value).startswith(f"{file}: {message}")


@settings(max_examples=150, deadline=None)
@given(head=st.sampled_from([b"P3 ", b"P6\n", b"P6 2 3 ", b"P6 2 3 255\n", b"P3 1 1 9 "]), data=st.binary(max_size=60))
def test_no_bytes_do_harm(head: bytes, data: bytes, tmp_path_factory: pytest.TempPathFactory) -> None:
    file = tmp_path_factory.getbasetemp() / "fuzz.ppm"
    file.write_bytes(head + data)
    try:
        texture = read_texture(file)
    except TextureError:
        return
    assert probe_texture(file) == (texture.width, texture.height)
    assert 0 <= texels(texture).min() <= texels(texture).max() <= 1


def test_files_that_are_none(tmp_path: Path) -> None:
    (tmp_path / "Sky.PPM").write_bytes(b"P6 2 3 255\n" + RASTER)
    os.mkfifo(tmp_path / "pipe")
    cases = [
        ("sky.ppm", "no such file (did you mean 'Sky.PPM'?)"),
        ("none/sky.ppm", "no such file"),
        ("Sky.PPM/x.ppm", "not a directory"),
        (".", "not a file"),
        ("pipe", "not a file"),
        ("x" * 300, "file name too long"),
    ]
    for name, message in cases:
        for function in (read_texture, probe_texture):
            with pytest.raises(TextureError) as caught:
                function(tmp_path / name)
            assert str(caught.value) == f"{tmp_path / name}: {message}"


def test_the_courses_textures_need_no_heavy_module(tmp_path: Path) -> None:
    file = tmp_path / "t.ppm"
    file.write_bytes(b"P6 2 3 65535\n" + RASTER * 2)
    code = (
        "import sys; from converter.images.texture import read_texture, probe_texture; "
        f"probe_texture({str(file)!r}); read_texture({str(file)!r}); "
        "print('numpy' in sys.modules, 'OpenImageIO' in sys.modules)"
    )
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert result.stdout.split() == ["False", "False"]


# ------------------------------------------------------------------------------------------------------- other formats


@pytest.mark.parametrize("ending", ["png", "bmp", "tga", "tif", "sgi", "pnm"])
def test_bytes_of_other_formats(ending: str, tmp_path: Path) -> None:
    file = save(tmp_path / f"t.{ending}", PIXELS)
    assert probe_texture(file) == (2, 3)
    texture = read_texture(file)
    assert (texture.width, texture.height, texture.texels.format) == (2, 3, "f")
    assert texture.texels.readonly
    np.testing.assert_allclose(texels(texture), PIXELS / 255, atol=1e-7)  # no gamma undone


@pytest.mark.parametrize("ending", ["exr", "pfm", "tif"])
def test_floats_of_other_formats(ending: str, tmp_path: Path) -> None:
    pixels = np.array([[[0, 0.5, 7], [1, 2, 3]], [[-1, 0, 1e-3], [4, 5, 6]]], dtype=np.float32)
    np.testing.assert_array_equal(texels(read_texture(save(tmp_path / f"t.{ending}", pixels))), pixels)


def test_numbers_of_16_bits(tmp_path: Path) -> None:
    pixels = PIXELS.astype(np.uint16) * 200
    np.testing.assert_allclose(texels(read_texture(save(tmp_path / "t.png", pixels))), pixels / 65535, atol=1e-7)


def test_grey_becomes_rgb(tmp_path: Path) -> None:
    grey = PIXELS[:, :, :1]
    expected = np.repeat(grey / 255, 3, axis=2)
    np.testing.assert_allclose(texels(read_texture(save(tmp_path / "t.png", grey))), expected, atol=1e-7)
    (tmp_path / "t.pgm").write_bytes(b"P5 2 3 255\n" + grey.tobytes())
    np.testing.assert_allclose(texels(read_texture(tmp_path / "t.pgm")), expected, atol=1e-7)


@pytest.mark.parametrize("channels", [2, 4])
def test_alpha_is_dropped_and_colours_stay(channels: int, tmp_path: Path) -> None:
    colors = PIXELS[:, :, : channels - 1]
    alpha = np.full((3, 2, 1), 128, dtype=np.uint8)
    file = save(tmp_path / "t.png", np.concatenate([colors, alpha], axis=2), oiio__UnassociatedAlpha=1)
    expected = np.broadcast_to(colors / 255, (3, 2, 3))
    np.testing.assert_allclose(texels(read_texture(file)), expected, atol=1e-6)


def test_the_ending_does_not_matter(tmp_path: Path) -> None:
    png = save(tmp_path / "t.png", PIXELS).rename(tmp_path / "t.ppm")
    np.testing.assert_allclose(texels(read_texture(png)), PIXELS / 255, atol=1e-7)
    (tmp_path / "t.jpg").write_bytes(b"P6 2 3 255\n" + RASTER)
    np.testing.assert_allclose(texels(read_texture(tmp_path / "t.jpg")), PIXELS / 255, atol=1e-7)


@pytest.mark.parametrize("ending", ["png", "jpg", "exr", "tif", "bmp", "tga"])
def test_other_formats_cut_off(ending: str, tmp_path: Path) -> None:
    noise = np.random.default_rng(1).integers(0, 256, (60, 80, 3), dtype=np.uint8)
    file = save(tmp_path / f"t.{ending}", noise)
    file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])
    with pytest.raises(TextureError, match=f"t.{ending}: "):
        read_texture(file)


def test_a_size_that_no_file_can_hold(tmp_path: Path) -> None:
    header = bytes([0, 0, 10, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xFF, 0xFF, 0xFF, 0xFF, 24, 0])  # TGA, run lengths
    file = tmp_path / "t.tga"
    file.write_bytes(header + bytes(40))
    for function in (read_texture, probe_texture):
        with pytest.raises(TextureError):
            function(file)
