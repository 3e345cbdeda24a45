"""Prints how far the native tracer is from what one core could do at most, on Figure 1.

    python benchmarks/peak.py

The most is the rate of a product of large matrices in double precision, by the library that NumPy brings: nothing that
is computed comes closer to the processor's peak. The tracer's operations are not counted but estimated, as those of
rays that are all compared with every object, see OPERATIONS: that is more than it does, for it passes over objects that
no ray of a group can meet. It is kept from half of the peak from the start, for it may not add and multiply in one
step, or its bytes would depend on the processor.
"""

import os

os.environ["OPENBLAS_NUM_THREADS"] = "1"  # before NumPy is loaded

import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from converter.renderers.native import NativeRenderer
from converter.scene.loading import load_scene
from converter.scene.model import Polyhedron, Scene, Sphere
from converter.scene.settings import Settings

FIGURE1 = Path(__file__).resolve().parent.parent / "scenes" / "figure1.in"
SIZE = 2000
RUNS = 7
OPERATIONS = {Sphere: 20, Polyhedron: 12}
"""Sums, products, quotients and comparisons of a ray with a sphere that it misses: 3 for the way to the centre, 5 for
where it is passed, 6 and 5 for how far away, 1 comparison; and with a plane: 5 for the slope, 6 for the height, a
quotient."""
SURFACE = 200
"""Of a ray's hit: some 25 for the distances, 35 for the point and the normal, 60 for a light, 80 for what follows."""


def main() -> None:
    """Print the peak, the estimate, and their ratio."""
    matrix = np.random.default_rng(1).random((SIZE, SIZE))
    peak = 2 * SIZE**3 / least_seconds(lambda: matrix @ matrix)
    scene, settings, native = load_scene(FIGURE1), Settings(threads=1), NativeRenderer()
    rays = native.render(scene, settings).statistics["rays"]
    operations = rays * (SURFACE + of_objects(scene))
    rate = operations / least_seconds(lambda: native.render(scene, settings))
    print(
        f"Figure 1 on one core: {operations / rays:.0f} operations a ray, were all compared with everything, are"
        f" {rate / 1e9:.1f} G a second,"
        f" {100 * rate / peak:.0f} % of the {peak / 1e9:.0f} G that a product of matrices reaches"
    )


def of_objects(scene: Scene) -> int:
    """Operations of a ray that is compared with all balls and planes."""
    shapes = [o.shape for o in scene.objects]
    planes = sum(len(shape.planes) for shape in shapes if isinstance(shape, Polyhedron))
    return planes * OPERATIONS[Polyhedron] + sum(isinstance(s, Sphere) for s in shapes) * OPERATIONS[Sphere]


def least_seconds(run: Callable[[], object]) -> float:
    """Processor time of one run, the least of several after one that is not counted."""
    run()
    spent = []
    for _ in range(RUNS):
        started = time.process_time()
        run()
        spent.append(time.process_time() - started)
    return min(spent)


if __name__ == "__main__":
    main()
