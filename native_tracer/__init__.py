"""The native tracer: build a `Scene`, draw it into an `Image` with `render`.

Everything is in the scene's own terms and needs neither NumPy nor the parser:

>>> scene = Scene()
>>> scene.set_camera((0, 0, 5), (0, 0, 0), (0, 1, 0), 40)
>>> scene.set_ambient((1, 1, 1))
>>> red = scene.add_solid((1, 0, 0))
>>> matte = scene.add_finish(ka=0.2, kd=0.8, ks=0, alpha=1, kr=0, kt=0, eta=1)
>>> ball = scene.add_sphere(red, matte, (0, 0, 0), 1)
>>> image = Image(80, 60)
>>> render(scene, image, cutoff=1 / 512, max_depth=8)
>>> image.pixels.shape
(60, 80, 3)
"""

from native_tracer._core import (
    Image,
    PassSums,
    Scene,
    count_nan_pixels,
    keep_reserve,
    quantize,
    render,
    scan_scene,
    trace_pixel,
)

__all__ = [
    "Image",
    "PassSums",
    "Scene",
    "count_nan_pixels",
    "keep_reserve",
    "quantize",
    "render",
    "scan_scene",
    "trace_pixel",
]
