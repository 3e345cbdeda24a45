"""Scenes of the course, drawn and compared from Python; what it offers is loaded when it is first used.

>>> import whitted
>>> scene = whitted.load_scene("scenes/figure1.in")
>>> picture = whitted.render(scene, 320, 240)
>>> picture.save("figure1.png")
>>> print(whitted.compare(picture, whitted.render(scene, 320, 240, method="mitsuba")))

A notebook shows pictures and comparisons by themselves.
"""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from converter.certify.certificate import Certificate
    from converter.renderers.base import RendererUnavailable
    from converter.scene.errors import SceneError
    from converter.scene.loading import load_scene
    from converter.scene.model import Scene
    from converter.scene.parser import load_text
    from whitted.comparing import Comparison, compare
    from whitted.drawing import Stopped, methods, render
    from whitted.picture import Picture, load_picture
    from whitted.proving import certify

_HOMES = {
    "Certificate": "converter.certify.certificate",
    "Comparison": "whitted.comparing",
    "Picture": "whitted.picture",
    "RendererUnavailable": "converter.renderers.base",
    "Scene": "converter.scene.model",
    "SceneError": "converter.scene.errors",
    "Stopped": "whitted.drawing",
    "certify": "whitted.proving",
    "compare": "whitted.comparing",
    "load_picture": "whitted.picture",
    "load_scene": "converter.scene.loading",
    "load_text": "converter.scene.parser",
    "methods": "whitted.drawing",
    "render": "whitted.drawing",
}
"""The module in which each name is."""

__all__ = [
    "Certificate",
    "Comparison",
    "Picture",
    "RendererUnavailable",
    "Scene",
    "SceneError",
    "Stopped",
    "certify",
    "compare",
    "load_picture",
    "load_scene",
    "load_text",
    "methods",
    "render",
]


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from converter.commands.version import version

        return version()
    if name not in _HOMES:
        raise AttributeError(f"module 'whitted' has no attribute {name!r}")
    from importlib import import_module

    value = globals()[name] = getattr(import_module(_HOMES[name]), name)
    return value


def __dir__() -> list[str]:
    return sorted([*__all__, "__version__"])
