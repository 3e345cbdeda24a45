"""The camera, its film and its sampler."""

from typing import Any

from converter.scene.model import Camera
from converter.scene.settings import Settings


def sensor(camera: Camera, settings: Settings, samples: int) -> dict[str, Any]:
    """A `pinhole` sensor with a film of single-precision RGB whose pixels are the plain mean of so many `samples`."""
    return {
        "type": "pinhole",
        "eye": list(camera.eye),
        "look_at": list(camera.look_at),
        "up": list(camera.up),
        "fovy": camera.fovy,
        **({"aperture": camera.aperture, "focal": camera.focal} if camera.aperture else {}),
        "pixel_offset": -0.5 if settings.pixel == "corner" else 0.0,
        "film": {
            "type": "hdrfilm",
            "width": settings.width,
            "height": settings.height,
            **(_crop_window(settings) if settings.crop is not None else {}),
            "pixel_format": "rgb",
            "component_format": "float32",
            "rfilter": {"type": "box"},
        },
        # The regular grid of n x n cells, for integrators that draw samples from it.
        "sampler": {"type": "stratified", "sample_count": samples, "jitter": False, "seed": settings.seed},
    }


def _crop_window(settings: Settings) -> dict[str, int]:
    left, top, *_ = settings.drawn
    width, height = settings.drawn_size
    return {"crop_offset_x": left, "crop_offset_y": top, "crop_width": width, "crop_height": height}
