"""Finishes as BSDFs."""

from typing import Any

from converter.scene.model import Finish
from converter.scene.settings import Settings


def bsdf(finish: Finish, eta: float, pigment: dict[str, Any], settings: Settings) -> dict[str, Any]:
    """A `phong` BSDF: a finish with n1/n2 `eta` on a pigment, a texture or a reference to one."""
    return {
        "type": "phong",
        "pigment": pigment,
        "ka": finish.ka,
        "kd": finish.kd,
        "ks": finish.ks,
        "alpha": finish.alpha,
        "kr": finish.kr,
        "kt": finish.kt,
        "eta": eta,
        **({"cone": finish.cone} if finish.cone else {}),
        "blinn": settings.specular == "blinn",
    }
