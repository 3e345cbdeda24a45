"""Lights. The ambient light is the integrator's: see `integrator`."""

from typing import Any

from converter.scene.model import Light


def light(source: Light) -> dict[str, Any]:
    """An `attenuated_point` emitter."""
    return {
        "type": "attenuated_point",
        "position": list(source.position),
        "color": color(source.color),
        "attenuation": list(source.attenuation),
        **({"radius": source.radius} if source.radius else {}),
    }


def color(rgb: tuple[float, float, float]) -> dict[str, Any]:
    """Linear RGB as Mitsuba's dictionaries write it."""
    return {"type": "rgb", "value": list(rgb)}
