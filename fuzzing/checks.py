"""What has to be true of any input, text or texture: each function lets anything but errors meant for users escape."""

import contextlib
import io
import tracemalloc
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

from finite import assert_finite

from converter.analysis.cutoff import cutoff_bound
from converter.analysis.notices import scene_notices
from converter.commands import main, raytrace
from converter.errors import ExportError
from converter.images import ppm
from converter.renderers.base import EffectUnavailable
from converter.renderers.mitsuba import MitsubaRenderer
from converter.renderers.native import NativeRenderer
from converter.scene.errors import SceneError
from converter.scene.model import Scene
from converter.scene.needs import scene_needs
from converter.scene.parser import parse_scene
from converter.scene.settings import Settings
from converter.to_mitsuba.meshes import MeshError
from converter.to_mitsuba.scene import scene_description
from converter.to_povray.scene import povray_scene

SETTINGS = Settings(width=4, height=3, max_depth=4, threads=1)
LEAST_ROOM, ROOM_A_BYTE = 1 << 20, 500
"""Bytes of memory that reading may take, whatever the input, and for each byte of it."""


def read_texture(data: bytes) -> None:
    """Read a PPM file, which is no scene."""
    with suppress(ValueError):
        header = ppm.read_header(data[: ppm.HEADER_BYTES], len(data))
        assert len(ppm.read_samples(io.BytesIO(data), header)) == header.samples


def read_scene(data: bytes) -> Scene | None:
    """Read a scene; None if it is refused."""
    try:
        return parse_scene(data)
    except SceneError as error:
        assert error.problems
        assert len(str(error)) < 1 << 14
        return None


def read_in_little_memory(read: Callable[[bytes], Any], data: bytes) -> None:
    """Read an input with an eye on the memory that this takes."""
    tracemalloc.start()
    try:
        read(data)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak < LEAST_ROOM + ROOM_A_BYTE * len(data), f"{peak} bytes of memory for {len(data)} of input"


def convert(scene: Scene) -> None:
    """Find out all about a scene, and convert it."""
    scene_needs(scene, SETTINGS)
    scene_notices(scene, SETTINGS)
    cutoff_bound(scene, SETTINGS)
    with suppress(EffectUnavailable):
        scene_description(scene, SETTINGS, with_shapes=False)
    with suppress(EffectUnavailable, MeshError):
        scene_description(scene, SETTINGS)
    with suppress(ExportError):
        povray_scene(scene, SETTINGS)


def draw(scene: Scene) -> None:
    """Draw a scene by the native tracer, in both ways to search it."""
    for search in ("brute", "bvh"):
        with suppress(EffectUnavailable):
            assert_finite(NativeRenderer(search=search).render(scene, SETTINGS).pixels, scene, SETTINGS)


def draw_with_mitsuba(scene: Scene) -> None:
    """Draw a scene by Mitsuba, through the tree, whose kernel most scenes share."""
    with suppress(EffectUnavailable):
        assert_finite(MitsubaRenderer("llvm_ad_rgb", "bvh").render(scene, SETTINGS).pixels, scene, SETTINGS)


def run_programs(data: bytes, folder: Path) -> None:
    """Run the programs on a file in an empty folder: each makes what is asked for, or tells why not and makes nothing.

    With status 2, and no more written to stderr than a scene's problems; warnings of Python are failures, too.
    """
    scene = folder / "scene.in"
    scene.write_bytes(data)
    commands = {
        "picture.ppm": (raytrace.main, (scene, folder / "picture.ppm", 4, 3)),
        "picture.png": (main.main, ("render", scene, folder / "picture.png", 4, 3, "--method", "native-float")),
        "scene.pov": (main.main, ("convert", scene, folder / "scene.pov", 4, 3)),
        "folder": (main.main, ("convert", scene, folder / "folder", 4, 3)),
        "facts.json": (main.main, ("inspect", scene, "--json", folder / "facts.json")),
    }
    for made, (program, words) in commands.items():
        before = set(folder.iterdir())
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()) as told:
            status = program([str(word) for word in words])
        new = {path.name for path in set(folder.iterdir()) - before}
        if status == 0:
            assert made in new, new
        else:
            assert status == 2, status
            assert not new, new
            assert 0 < len(told.getvalue()) < 1 << 14
        assert "Traceback" not in told.getvalue()
