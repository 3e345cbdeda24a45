"""The methods: every renderer with every setting that is worth comparing, under a name.

Importing this loads no renderer.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cache
from typing import Any, Literal, cast, get_args

from converter.renderers.base import Renderer
from converter.scene.depth import MAX_DEPTH
from converter.scene.model import Csg, Quadric, Scene
from converter.scene.settings import MOST_THREADS, Points, Settings
from converter.shapes.table import shape_kind
from converter.to_mitsuba.fineness import Fineness

Family = Literal["native", "mitsuba", "povray"]
Arithmetic = Literal["double", "float", "mesh", "offset", "ulp"]
"""Double throughout; single precision throughout; Embree's choice among exact surfaces; Embree's word, with rays moved
off by Mitsuba's offset, or by units in the last place."""

MOST_COMPILED = 128
"""Surfaces up to which a method that compiles each by itself is tried."""
USUAL_DEPTHS = (1, 2, 4, 8, 16)
"""Bounces of the methods that studies run."""


@dataclass(frozen=True, slots=True, eq=False)
class Method:
    """A renderer, how it is made, and the settings that are part of the method; each is there once, in the table.

    Attributes:
        name: what users call it.
        family: which renderer it is.
        group: what it is listed under.
        use: when to use it, in a line.
        options: what the renderer is made with.
        changes: settings that it has instead of the user's.
        most_surfaces: spheres and planes, together, that it bears; None for any number.
        usual: whether studies run it where nobody says which methods to run.
        curved_only: whether it differs from others where there are quadrics or csgs only.

    """

    name: str
    family: Family
    group: str
    use: str
    options: Mapping[str, Any] = field(default_factory=dict)
    changes: Mapping[str, Any] = field(default_factory=dict)
    most_surfaces: int | None = None
    usual: bool = True
    curved_only: bool = False

    def renderer(self, variant: str | None = None) -> Renderer:
        """The renderer; Mitsuba in `variant`, unless that is None or part of the method."""
        options = dict(self.options)
        if self.family == "mitsuba" and variant is not None:
            options.setdefault("variant", variant)
        return _MAKERS[self.family](**options)

    def settings(self, given: Settings) -> Settings:
        """`given` with what the method changes."""
        return replace(given, **self.changes)

    @property
    def arithmetic(self) -> Arithmetic | None:
        """What decides where it fails; None for POV-Ray."""
        if self.family == "povray":
            return None
        kind: Arithmetic
        for kind in ("mesh", "offset", "ulp"):
            if self.options.get("intersections") == kind:
                return kind
        return "float" if self.options.get("precision") == "float" else "double"

    def missing(self) -> str | None:
        """Why the method cannot run on this machine, as far as can be told without running it; None if it can."""
        return _MISSING[self.family](self)

    def unfit(self, scene: Scene) -> str | None:
        """Why the method is not for `scene`; None if it is."""
        if self.curved_only and not any(isinstance(o.shape, Quadric | Csg) for o in scene.objects):
            return "there are no quadrics and no csgs"
        if self.most_surfaces is None:
            return None
        count = sum(shape_kind(o.shape).count(o.shape) for o in scene.objects)
        if count <= self.most_surfaces:
            return None
        return f"{count} spheres and planes would take too long to compile"


def find_method(name: str) -> Method:
    """The method of that name: one of the table, or one with other settings, as in `native:max_depth=4:cutoff=1/64`.

    Raises:
        ValueError: there is none; the message names one like it, or the settings that there are.

    """
    if name in METHODS:
        return METHODS[name]
    base, *changes = name.split(":")
    if base not in METHODS:
        from converter.scene.errors import did_you_mean

        raise ValueError(f"there is no method {base!r}{did_you_mean(base, tuple(METHODS))}")
    return _with_settings(METHODS[base], tuple(changes))


@cache  # so that a method is the same one whenever it is named
def _with_settings(method: Method, texts: tuple[str, ...]) -> Method:
    changes = dict(method.changes)
    for text in texts:
        key, _, value = text.partition("=")
        if key not in _SETTINGS:
            raise ValueError(f"{method.name} has no setting {key!r}: expected {', '.join(_SETTINGS)}")
        what, read = _SETTINGS[key]
        try:
            changes[key] = read(value)
        except (ValueError, ZeroDivisionError):
            raise ValueError(f"{key} must be {what}, found {value!r}") from None
    name = ":".join((method.name, *texts))
    return replace(method, name=name, use=f"{method.name} with other settings", changes=changes, usual=False)


def _within(least: int, most: int) -> Callable[[str], int]:
    def read(text: str) -> int:
        value = int(text)
        if not least <= value <= most:
            raise ValueError
        return value

    return read


def _share(text: str) -> float:
    value = float(Fraction(text))
    if value < 0:
        raise ValueError
    return value


def _points(text: str) -> Points:
    for points in get_args(Points):
        if text == points:
            return cast(Points, points)
    raise ValueError


_SETTINGS: Mapping[str, tuple[str, Callable[[str], Any]]] = {
    "max_depth": (f"a whole number from 0 to {MAX_DEPTH}", _within(0, MAX_DEPTH)),
    "cutoff": ("a number or a fraction from 0 on", _share),
    "threads": (f"a whole number from 1 to {MOST_THREADS}", _within(1, MOST_THREADS)),
    "points": (" or ".join(get_args(Points)), _points),
}
"""Settings that a method's name may have, what their values are, and how these are read."""


# ------------------------------------------------------------------------------------------------------ the renderers


def _native(**options: Any) -> Renderer:
    from converter.renderers.native import NativeRenderer

    return NativeRenderer(**options)


def _mitsuba(**options: Any) -> Renderer:
    from converter.renderers.mitsuba import MitsubaRenderer

    return MitsubaRenderer(**options)


def _povray(**options: Any) -> Renderer:
    from converter.renderers.povray import PovrayRenderer

    return PovrayRenderer(**options)


def _native_missing(method: Method) -> str | None:
    from converter.renderers.base import RendererUnavailable
    from converter.renderers.native import native_module

    try:
        native_module()
    except RendererUnavailable as error:
        return str(error)
    return None


def _mitsuba_missing(method: Method) -> str | None:
    from importlib.util import find_spec

    from mitsuba_plugins.backend import MINIMUM_LLVM, NOT_INSTALLED, find_llvm, has_cuda, llvm_complaint

    if find_spec("mitsuba") is None:
        return NOT_INSTALLED
    if method.options.get("variant") == "cuda_ad_rgb":
        return None if has_cuda() else "no CUDA device answers on this machine"
    if has_cuda():
        return None
    if find_llvm() is None:
        return f"neither a CUDA device nor an LLVM library of version {MINIMUM_LLVM} or newer is there"
    complaint = llvm_complaint()
    return complaint and f"DRJIT_LIBLLVM_PATH names no library that will do: {complaint}"


def _povray_missing(method: Method) -> str | None:
    from shutil import which

    return None if which("povray") else "POV-Ray is not installed (Debian, Ubuntu: apt install povray)"


_MAKERS: Mapping[Family, Callable[..., Renderer]] = {"native": _native, "mitsuba": _mitsuba, "povray": _povray}
_MISSING: Mapping[Family, Callable[[Method], str | None]] = {
    "native": _native_missing,
    "mitsuba": _mitsuba_missing,
    "povray": _povray_missing,
}


# ---------------------------------------------------------------------------------------------------------- the table


def _native_methods() -> Iterator[Method]:
    def method(name: str, use: str, changes: Mapping[str, Any] | None = None, **options: str) -> Method:
        return Method(name, "native", "the native tracer", use, options, changes or {})

    yield method("native", "exact in double precision and fast: what the others are held against")
    yield method(
        "native-float", "single precision: faster, where a wrong pixel at an edge does no harm", precision="float"
    )
    yield method("native-long-double", "to check native itself, tens of times slower", precision="long double")
    yield method("native-brute", "tries every object for every ray: to check the hierarchy", search="brute")
    yield method("native-bvh", "a hierarchy over the objects, however few they are", search="bvh")
    yield method("native:threads=1", "leaves the other cores alone", {"threads": 1})


def _following_methods() -> Iterator[Method]:
    def method(name: str, use: str, **changes: Any) -> Method:
        return Method(name, "native", "the native tracer, following more rays or fewer", use, {}, changes)

    yield method("native:cutoff=0", "drops no ray for its weight, but may for its depth: for figures", cutoff=0.0)
    yield method("native:cutoff=1/4096", "drops rays below 1/4096: dark parts can be brightened", cutoff=1 / 4096)
    yield method("native:cutoff=1/512", "drops rays below 1/512, hardly seen in 8 bits: the default", cutoff=1 / 512)
    yield method("native:cutoff=1/64", "drops rays below 1/64: a preview", cutoff=1 / 64)
    for bounces in USUAL_DEPTHS:
        use = f"follows a ray for {bounces} bounce{'s' if bounces > 1 else ''} at most"
        yield method(f"native:max_depth={bounces}", use, max_depth=bounces)


def _mitsuba_methods() -> Iterator[Method]:
    def method(name: str, use: str, changes: Mapping[str, Any] | None = None, **options: str) -> Method:
        most = MOST_COMPILED if options.get("intersections") == "analytic" else None
        return Method(name, "mitsuba", "Mitsuba", use, options, changes or {}, most)

    yield method("mitsuba", "finds hits in the way that suits the scene, in double precision, on a GPU if there is one")
    yield method("mitsuba-analytic", "surfaces in the kernel, in double: small scenes", intersections="analytic")
    yield method("mitsuba-analytic-float", "the same in single precision", intersections="analytic", precision="float")
    yield method("mitsuba-bvh", "surfaces and a hierarchy in the kernel, in double: large scenes", intersections="bvh")
    yield Method(
        "mitsuba-mixed",
        "mitsuba",
        "Mitsuba",
        "single precision, and double where that cannot decide, or not bound its errors: for GPUs",
        {"precision": "mixed"},
        usual=False,
    )
    yield method(
        "mitsuba-mesh", "Embree says which surface, the exact surface says where, in double", intersections="mesh"
    )
    yield method(
        "mitsuba-ulp",
        "Embree's hits, next rays moved off by units in the last place (Waechter and Binder)",
        intersections="ulp",
    )
    yield method(
        "mitsuba-offset", "Embree's hits and Mitsuba's own ray offset: what Mitsuba alone does", intersections="offset"
    )
    yield method("mitsuba:threads=1", "leaves the other cores alone", {"threads": 1})
    yield method("mitsuba-cuda", "on the GPU: large pictures", variant="cuda_ad_rgb")


def _tessellated_methods() -> Iterator[Method]:
    for share in ("0.1", "0.01", "0.001"):
        yield Method(
            f"mitsuba-spheres-{share}",
            "mitsuba",
            "Mitsuba, spheres as meshes",
            f"{share} radii off the sphere at most, else as mitsuba-offset: to see what tessellation costs",
            {"intersections": "offset", "fineness": Fineness(spheres=float(share))},
        )

    for pixels in ("2", "1/2", "1/8"):
        yield Method(
            f"mitsuba-curved-{pixels}",
            "mitsuba",
            "Mitsuba, quadrics and csgs as coarser meshes",
            f"{pixels} pixels off at most, and not 1/32, else as mitsuba-mesh: to see what tessellation costs",
            {"intersections": "mesh", "fineness": Fineness(pixels=float(Fraction(pixels)))},
            curved_only=True,
        )


def _povray_methods() -> Iterator[Method]:
    yield Method(
        "povray", "povray", "POV-Ray", "a third opinion, where it is installed; whitted chart --vs povray", usual=False
    )


METHODS: Mapping[str, Method] = {
    method.name: method
    for methods in (_native_methods, _following_methods, _mitsuba_methods, _tessellated_methods, _povray_methods)
    for method in methods()
}
"""Every method that is listed, by its name, the groups together; `find_method` knows these with other settings, too."""
