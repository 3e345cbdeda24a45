"""POV-Ray draws what `whitted convert` writes, and its pictures are the native tracer's."""

import os
import shutil
import signal
import sys
import threading
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from converter.compare.metrics import compare_pixels
from converter.renderers import povray
from converter.renderers.base import Interrupted, RendererUnavailable
from converter.renderers.native import NativeRenderer
from converter.renderers.povray import PovrayError, PovrayRenderer
from converter.scene.model import Camera, Finish, Light, Object, Polyhedron, Scene, Solid, Sphere, Texmap
from converter.scene.parser import load_scene
from converter.scene.settings import Settings
from converter.to_povray.scale import scaled

SCENES = Path(__file__).resolve().parent.parent / "scenes"
needs_povray = pytest.mark.skipif(
    shutil.which(povray.PROGRAM) is None, reason="POV-Ray is not installed (Debian, Ubuntu: apt install povray)"
)
BOX = ((1, 0, 0, -1), (-1, 0, 0, -1), (0, 1, 0, -1), (0, -1, 0, -1), (0, 0, 1, -1), (0, 0, -1, -1))


def agree(scene: Scene, settings: Settings, rms: float = 1e-4, pixels: int = 0) -> tuple[str, ...]:
    """See that both draw the same, and return POV-Ray's omissions."""
    drawn = PovrayRenderer().render(scene, settings)
    assert drawn.statistics["clamped"] is False
    native = np.asarray(NativeRenderer().render(scene, settings).pixels)
    found = compare_pixels(native, np.asarray(drawn.pixels))
    assert found.disagreeing <= pixels, found.largest
    assert found.rms <= rms
    assert native.std() > 0.02  # there is something to see
    return tuple(drawn.statistics["omissions"])


def lit(scene: Scene, attenuation: tuple[float, float, float], brightness: float = 1.0) -> Scene:
    lights = tuple(
        replace(source, attenuation=attenuation, color=tuple(brightness * channel for channel in source.color))
        for source in scene.lights
    )
    return replace(scene, lights=lights)


@pytest.fixture
def plain(small_scene: Scene) -> Scene:
    """The small scene in constant light, on a floor with bounds."""
    floor = ((0, 1, 0, 0.01), (0, -1, 0, -1), (1, 0, 0, -40), (-1, 0, 0, -40), (0, 0, 1, -40), (0, 0, -1, -40))
    objects = (replace(small_scene.objects[0], shape=Polyhedron(floor)), *small_scene.objects[1:])
    return lit(replace(small_scene, objects=objects), (1, 0, 0))


@needs_povray
@pytest.mark.parametrize("name", ["figure1", "nested", "room", "tiles", "underwater", "whitted"])
def test_scenes(name: str) -> None:
    agree(load_scene(SCENES / f"{name}.in"), Settings(width=120, height=90), rms=1e-4)


@needs_povray
@pytest.mark.parametrize(
    "settings",
    [
        Settings(pixel="center"),
        Settings(samples=9, cutoff=0.0, max_depth=4),
        Settings(specular="blinn"),
        Settings(background=(0.2, 0.5, 0.1), max_depth=2),
        Settings(ior="ratio"),
        Settings(threads=1, cutoff=0.0, max_depth=5),
    ],
    ids=lambda settings: f"{settings.pixel}-{settings.samples}-{settings.specular}-{settings.ior}-{settings.max_depth}",
)
def test_settings(plain: Scene, settings: Settings) -> None:
    agree(plain, replace(settings, width=80, height=60), rms=1e-3 if settings.cutoff else 1e-4)


@needs_povray
@pytest.mark.parametrize(
    ("attenuation", "brightness", "exact"),
    [
        ((2, 0, 0), 1, True),
        ((0, 1, 0), 6, True),
        ((0, 0, 1), 40, True),
        ((1, 0.2, 0), 2, True),
        ((1, 0, 0.03), 3, True),
        ((0, 0.2, 0.1), 10, True),
        ((0.1, 0.8, 0.1), 10, True),
        ((0.5, 0.05, 0.003), 1, False),
    ],
)
def test_attenuation(plain: Scene, attenuation: tuple[float, float, float], brightness: float, exact: bool) -> None:
    matte = tuple(replace(finish, kt=0) for finish in plain.finishes)
    scene = replace(lit(plain, attenuation, brightness), finishes=matte)
    told = agree(scene, Settings(width=80, height=60), rms=1e-4 if exact else 1e-3)
    assert [text.split(":")[0] for text in told] == ([] if exact else ["light 1", "light 2"])


@needs_povray
@pytest.mark.parametrize(
    ("p0", "p1", "maxval"),
    [
        ((0.7, 0.1, 0.0, 0.2), (0.0, 0.9, 0.3, 0.1), 255),
        ((-0.21, 0.0, 0.0, -0.3), (0.0, 0.0, 0.17, 0.0), 65535),
        ((0.0, 0.0, 0.31, 0.05), (0.0, 0.0, 0.0, -0.4), 255),
        ((0.0, 0.0, 0.0, 5.4), (0.13, 0.11, 0.0, -3.0), 65535),
        ((0.0, 0.0, 0.0, 0.4), (0.0, 0.0, 0.0, -0.6), 255),
        ((0.2, 0.1, 0.1, 0.2), (0.4, 0.2, 0.2, 0.1), 65535),
    ],
)
def test_textures(
    plain: Scene,
    tmp_path: Path,
    p0: tuple[float, float, float, float],
    p1: tuple[float, float, float, float],
    maxval: int,
) -> None:
    """On both sides of the origin, along one axis, two that are parallel, or none; on glass too."""
    file = tmp_path / "texels.ppm"
    samples = np.random.default_rng(1).integers(0, maxval + 1, (3, 4, 3)).astype("u1" if maxval < 256 else ">u2")
    file.write_bytes(b"P6 4 3 %d\n" % maxval + samples.tobytes())
    texmap = Texmap(file, p0, p1)
    agree(
        replace(plain, pigments=(texmap, plain.pigments[1], texmap)), Settings(80, 60, cutoff=0, max_depth=4), pixels=2
    )


@needs_povray
@pytest.mark.parametrize("first", [9, 10, 13, 32, 35])
def test_textures_that_begin_like_a_header(plain: Scene, tmp_path: Path, first: int) -> None:
    """White space and comments end where the header does."""
    file = tmp_path / "texels.ppm"
    file.write_bytes(b"P6 2 2 255\n" + bytes([first, 90, 200, 40, 50, 60] * 2))
    texmap = Texmap(file, (0.7, 0.1, 0.0, 0.2), (0.0, 0.9, 0.3, 0.1))
    agree(replace(plain, pigments=(texmap, *plain.pigments[1:])), Settings(80, 60, cutoff=0, max_depth=4), pixels=2)


@needs_povray
@pytest.mark.parametrize("finish", [(0.2, 0.3, 0, 1.0), (0.0, 0.3, 0.2, 0.5), (0.1, 0, 0.3, 2), (0, 0, 1, 0.3)])
def test_glass(plain: Scene, finish: tuple[float, float, float, float]) -> None:
    """With no kr, with kr + kt above and below 1: the local colour is not dimmed, total reflection weighs kr + kt."""
    ka, kd, kr, kt = finish
    dark = replace(
        plain, ambient=(0.1, 0.12, 0.15), finishes=(*plain.finishes[:3], Finish(ka, kd, 0.1, 9, kr, kt, 1.5))
    )
    assert agree(dark, Settings(80, 60, cutoff=0, max_depth=3), rms=1e-4) == ()


@needs_povray
@pytest.mark.parametrize("index", [1.5, 0.6])
@pytest.mark.parametrize("inside", ["nothing", "ball", "box", "box in ball", "ball in box", "halfspace"])
def test_bodies_within_bodies(plain: Scene, inside: str, index: float) -> None:
    """Each body's own n1/n2 counts, whatever is around it, and whatever the camera is in."""
    ball, box = Sphere((0, 0, 0), 4), Polyhedron(tuple((a, b, c, 3 * d) for a, b, c, d in BOX))
    around = {
        "nothing": [],
        "ball": [ball],
        "box": [box],
        "box in ball": [box, Sphere((0, 0, 0), 6)],
        "ball in box": [Sphere((0, 0, 0), 2.7), box],
        "halfspace": [Polyhedron(((0, 1, 0, -2),))],
    }[inside]
    glass = Finish(0.02, 0.1, 0.2, 20, 0.1, 0.9, 1.0)
    sides = (
        (1, 0, 0, -1.6),
        (-1, 0, -0.2, 0.7),
        (0, 1, 0.1, -0.6),
        (0, -1, 0, -0.7),
        (0, 0, 1, -0.5),
        (0, 0, -1, -0.4),
    )
    wedge = Polyhedron(sides)
    scene = Scene(
        Camera((0.2, 0.3, -2.4), (0, 0, 0), (0, 1, 0), 60),
        (0.4, 0.5, 0.6),
        (Light((1.2, 1.5, -1.0), (0.6, 0.6, 0.6), (1, 0, 0)), Light((0, 90, -90), (0.5, 0.4, 0.3), (1, 0, 0))),
        (Solid((0.9, 0.4, 0.3)), plain.pigments[0]),
        (replace(glass, ior=index), replace(glass, ior=0.8), Finish(0.5, 0.4, 0, 1, 0, 0, 0)),
        (
            Object(1, 2, Polyhedron(tuple((-a, -b, -c, 30 * d) for a, b, c, d in BOX[:1]))),
            Object(1, 2, Sphere((0, 0, 0), 25)),
            Object(0, 0, Sphere((-0.5, 0, 0), 0.9)),
            Object(0, 1, Sphere((-0.4, 0.1, 0), 0.5)),
            Object(0, 0, wedge),
            *(Object(0, 1, shape) for shape in around),
        ),
    )
    assert agree(scene, Settings(80, 60, ior="ratio", cutoff=0, max_depth=5), rms=2e-3, pixels=2) == ()


@needs_povray
@pytest.mark.parametrize("factor", [1e-4, 1.0, 3e5])
def test_any_unit_of_length(plain: Scene, factor: float) -> None:
    agree(scaled(plain, factor), Settings(80, 60, cutoff=0, max_depth=4))


@needs_povray
def test_seconds_and_statistics(plain: Scene) -> None:
    shares: list[float] = []
    drawn = PovrayRenderer().render(plain, Settings(width=8, height=6), shares.append)
    assert list(drawn.seconds) == ["build", "start", "render"]
    assert min(drawn.seconds.values()) >= 0 and drawn.seconds["start"] > 0
    assert shares == [1.0]


@needs_povray
def test_says_where_colours_end(plain: Scene) -> None:
    bright = PovrayRenderer().render(plain, Settings(width=8, height=6, background=(9, 0.5, 7.5)))
    assert bright.statistics["clamped"] is True
    assert np.asarray(bright.pixels)[0, 0] == pytest.approx((8, 0.5, 7.5), abs=1e-4)


def test_says_what_to_install(plain: Scene, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(RendererUnavailable, match="apt install povray"):
        PovrayRenderer().render(plain, Settings(width=8, height=6))


def program(folder: Path, text: str) -> Path:
    file = folder / "povray"
    file.write_text(f"#!{sys.executable}\n{text}\n")
    file.chmod(0o755)
    return file


def test_tells_why_povray_failed(plain: Scene, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    told = r"Licence\nFile 'scene.pov' line 3: Parse Error: Expected\n 'numeric expression', } found instead\n"
    monkeypatch.setattr(
        povray, "PROGRAM", str(program(tmp_path, f'import sys; sys.stderr.write("{told}"); sys.exit(1)'))
    )
    with pytest.raises(
        PovrayError, match=r"failed: File 'scene.pov' line 3: Parse Error: Expected 'numeric expression'"
    ):
        PovrayRenderer().render(plain, Settings(width=8, height=6))


@pytest.fixture
def heeded_interrupt() -> Iterator[None]:
    """Ctrl-C raises KeyboardInterrupt, also in a process of pytest-xdist's, which ignores it."""
    previous = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, previous)


@pytest.mark.usefixtures("heeded_interrupt")
def test_interrupt_ends_povray(plain: Scene, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    pid = tmp_path / "pid"
    sleeper = program(
        tmp_path, f"import os, time\nopen({str(pid)!r}, 'w').write(str(os.getpid()) + '.')\ntime.sleep(60)"
    )
    monkeypatch.setattr(povray, "PROGRAM", str(sleeper))

    def interrupt() -> None:
        while not (pid.exists() and pid.read_text().endswith(".")):
            pass
        os.kill(os.getpid(), signal.SIGINT)

    thread = threading.Thread(target=interrupt)
    thread.start()
    with pytest.raises(Interrupted) as stopped:
        PovrayRenderer().render(plain, Settings(width=8, height=6))
    thread.join()
    assert np.asarray(stopped.value.partial.pixels).shape == (6, 8, 3)
    with pytest.raises(ProcessLookupError):
        os.kill(int(pid.read_text()[:-1]), 0)
