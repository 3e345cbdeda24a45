"""The student's tracer, ready for a scene: its deviations, and the pixels it draws with some of them."""

from collections.abc import Collection, Iterable, Sequence
from dataclasses import MISSING, dataclass, field, fields
from functools import cache
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from converter.analysis.coplanar import with_planes_shared
from converter.renderers.base import RendererUnavailable
from converter.renderers.native import available_cores
from converter.renderers.records import PixelRecord, pixel_record
from converter.scene.model import (
    Camera,
    Checker,
    Finish,
    Light,
    Object,
    Pigment,
    Polyhedron,
    Scene,
    Solid,
    Sphere,
    Texmap,
)
from converter.scene.needs import scene_needs
from converter.scene.settings import Settings
from converter.why.first_light import first_light

Places = NDArray[np.int32]
"""(n, 2) columns and rows of pixels."""
Colors = NDArray[np.float32]
"""(n, 3) linear RGB, not clamped."""
Levels = NDArray[np.uint8]
"""(n, 3) of 0..255."""
Causes = frozenset[str]
"""Deviations that a tracer has at once, by name."""

LEVELS = "levels"
"""A part of a tracer, see `Deviation.part`."""

_KNOWN = {
    Camera: {"eye", "look_at", "up", "fovy", "focal"},  # a focal distance means nothing without an aperture
    Light: {"position", "color", "attenuation"},
    Finish: {"ka", "kd", "ks", "alpha", "kr", "kt", "ior"},
    Object: {"pigment", "finish", "shape", "line"},
}


class UnknownToStudent(ValueError):  # noqa: N818 - what it says
    """The student's tracer does not know something that the scene holds; the message says what."""


@dataclass(frozen=True, slots=True)
class Deviation:
    """A mistake that students make, or another reading of the statement.

    Attributes:
        name: it, for programs.
        part: what of a tracer has it: "levels" (colours become bytes), "picture" (where a pixel lies), or another.
        group: a tracer has one deviation of a group at most.
        sentence: it, in the course's words, to stand after "with".
        hint: where in a program to look.
        index: its place in the table.

    """

    name: str
    part: str
    group: str
    sentence: str
    hint: str
    index: int


@cache
def deviations() -> dict[str, Deviation]:
    """Every deviation by its name, in the table's order.

    Raises:
        RendererUnavailable: the student's tracer is not built.

    """
    rows = _module().deviations()
    return {row[0]: Deviation(row[0], row[1], row[2] or row[0], row[3], row[4], i) for i, row in enumerate(rows)}


@dataclass(slots=True)
class Student:
    """A scene that the student's tracer draws, at the size of a picture.

    Attributes:
        width, height: of the picture.
        base: deviations that are there always: readings that the settings ask for.
        traced: pixels that it has traced so far.

    """

    width: int
    height: int
    base: Causes
    threads: int
    _scene: Any = field(repr=False)
    traced: int = 0

    def candidates(self) -> list[Deviation]:
        """The deviations that the scene can show."""
        based = {deviations()[name].group for name in self.base}
        shows = _module().shows(self._scene)
        return [d for d in deviations().values() if shows[d.index] and d.group not in based]

    def colors(self, places: Places, sets: Sequence[Causes]) -> NDArray[np.float32]:
        """(sets, n, 3) colours of pixels, before they become levels, with each set of deviations."""
        self.traced += len(places) * len(sets)
        indices = [_indices(self.base | causes) for causes in sets]
        result: NDArray[np.float32] = _module().trace(
            self._scene, self.width, self.height, np.ascontiguousarray(places, np.int32), indices, self.threads
        )
        return result

    def levels(self, colors: Colors, causes: Causes) -> Levels:
        """(n, 3) bytes of those colours."""
        return to_levels(colors, self.base | causes)

    def drawn(self, places: Places, causes: Causes) -> Levels:
        """(n, 3) levels of pixels with these causes."""
        after = after_tracing(causes)
        return self.levels(self.colors(places, [causes - after])[0], after)

    def trace_pixel(self, x: int, y: int, causes: Causes) -> PixelRecord:
        """The rays of a pixel."""
        indices = _indices(self.base | causes)
        return pixel_record(_module().trace_pixel(self._scene, self.width, self.height, x, y, indices))


def to_levels(colors: Colors, causes: Collection[str] = ()) -> Levels:
    """(n, 3) bytes of (n, 3) colours, where `causes` change how they are made."""
    result: Levels = _module().levels(np.ascontiguousarray(colors, np.float32), _indices(causes))
    return result


def after_tracing(causes: Causes) -> Causes:
    """Those that change what becomes of colours, and no colour."""
    return frozenset(name for name in causes if deviations()[name].part == LEVELS)


def make_student(scene: Scene, settings: Settings) -> Student:
    """The student's tracer for a scene.

    Raises:
        RendererUnavailable: it is not built.
        UnknownToStudent: the scene, or what the settings ask for, is more than it knows.
        ValueError: a texture cannot be read.

    """
    _check_known(scene, settings)
    needs = scene_needs(scene, settings)
    camera = scene.camera
    student = _module().Scene(
        eye=camera.eye,
        look_at=camera.look_at,
        up=camera.up,
        fovy=camera.fovy,
        ambient=scene.ambient,
        background=needs.background,
        cutoff=settings.cutoff,
        max_depth=needs.max_depth,
    )
    if scene.file is not None and (lamp := first_light(scene.file)) is not None:
        student.set_ambient_lamp(*lamp)
    for light in scene.lights:
        student.add_lamp(light.position, light.color, light.attenuation)
    pigments = {i: _add_pigment(student, scene.pigments[i]) for i in needs.pigments}
    for f, eta in zip(scene.finishes, needs.etas, strict=True):
        student.add_finish(ka=f.ka, kd=f.kd, ks=f.ks, alpha=f.alpha, kr=f.kr, kt=f.kt, eta=eta, ior=f.ior or 1.0)
    for o, bounded in zip(with_planes_shared(scene).objects, needs.bounded, strict=True):
        if isinstance(o.shape, Sphere):
            student.add_sphere(pigments[o.pigment], o.finish, o.shape.center, o.shape.radius)
        else:
            assert isinstance(o.shape, Polyhedron)
            student.add_polyhedron(pigments[o.pigment], o.finish, list(o.shape.planes), bounded)
    base = {
        name
        for name, asked in (("pixel_center", settings.pixel == "center"), ("blinn", settings.specular == "blinn"))
        if asked
    }
    return Student(settings.width, settings.height, frozenset(base), settings.threads or available_cores(), student)


def _module() -> ModuleType:
    try:
        import student_tracer
    except ImportError as error:
        raise RendererUnavailable(
            f"the student's tracer is not built ({error}); `make` or `pip install .` builds it"
        ) from None
    return student_tracer


def _indices(causes: Collection[str]) -> list[int]:
    return sorted(deviations()[name].index for name in causes)


def _add_pigment(student: Any, pigment: Pigment) -> int:
    if isinstance(pigment, Solid):
        return int(student.add_solid(pigment.color))
    if isinstance(pigment, Checker):
        return int(student.add_checker(pigment.first, pigment.second, pigment.size))
    from converter.images.texture import read_texture

    texture = read_texture(pigment.file, pigment.place)
    return int(student.add_texmap(np.asarray(texture.texels), pigment.p0, pigment.p1))


# ---- What it does not know -------------------------------------------------------------------------------------------


def _check_known(scene: Scene, settings: Settings) -> None:
    if settings.rays_a_pixel() != 1:
        raise UnknownToStudent("mistakes are looked for with one ray a pixel; leave out --samples")
    parts: Iterable[tuple[str, Any]] = [
        ("the camera", scene.camera),
        *((f"light {i + 2}", light) for i, light in enumerate(scene.lights)),
        *((f"finish {i}", finish) for i, finish in enumerate(scene.finishes)),
        *((f"object {i}{_line(o)}", o) for i, o in enumerate(scene.objects)),
    ]
    for told, part in parts:
        for extra in _additions(part):
            raise UnknownToStudent(f"mistakes are not looked for in scenes with {extra}, which {told} has")
    for i, o in enumerate(scene.objects):
        if not isinstance(o.shape, Sphere | Polyhedron):
            kind = type(o.shape).__name__.lower()
            raise UnknownToStudent(
                f"mistakes are looked for in spheres and polyhedra, and object {i}{_line(o)} is a {kind}"
            )
    for i, pigment in enumerate(scene.pigments):
        if not isinstance(pigment, Solid | Checker | Texmap):
            raise UnknownToStudent(
                f"mistakes are not looked for in pigments such as number {i}, a {type(pigment).__name__.lower()}"
            )


def _additions(part: Any) -> list[str]:
    """Names of what a part of a scene has beyond the statement: numbers that are optional and given."""
    return [
        f.name.replace("_", " ")
        for f in fields(part)
        if f.name not in _KNOWN[type(part)] and getattr(part, f.name) != _default(f) and getattr(part, f.name)
    ]


def _default(f: Any) -> Any:
    return f.default_factory() if f.default_factory is not MISSING else f.default


def _line(o: Object) -> str:
    return f" (line {o.line})" if o.line else ""
