"""The camera."""

import math

import numpy as np

from converter.scene.model import Camera
from converter.scene.settings import Settings
from converter.to_povray.text import vector


def camera(source: Camera, settings: Settings) -> str:
    """A perspective camera given by vectors, which say where right is: no handedness and no angle is left to POV-Ray.

    POV-Ray's rays pass through the centres of the pixels, and through the points direction + x right + y up, with x and
    y from -1/2 to 1/2. For `--pixel corner` the direction points half a pixel to the left and upwards.
    """
    eye = np.array(source.eye)
    forward = _unit(np.array(source.look_at) - eye)
    right = _unit(np.cross(forward, np.array(source.up)))
    up = np.cross(right, forward)
    height = 2 * math.tan(math.radians(source.fovy) / 2)
    right, up = right * height * settings.width / settings.height, up * height
    if settings.pixel == "corner":
        forward = forward - right / (2 * settings.width) + up / (2 * settings.height)
    vectors = {"location": eye, "direction": forward, "right": right, "up": up}
    return "camera {\n  perspective\n" + "".join(f"  {k} {vector(v.tolist())}\n" for k, v in vectors.items()) + "}\n"


def _unit(v: np.ndarray[tuple[int], np.dtype[np.float64]]) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    v = v / np.abs(v).max()  # so that its square neither overflows nor underflows
    result: np.ndarray[tuple[int], np.dtype[np.float64]] = v / np.linalg.norm(v)
    return result
