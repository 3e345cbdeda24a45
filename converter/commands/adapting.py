"""`--adaptive`: pixels are drawn with more samples where they need them."""

import argparse
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from converter.commands.exits import UsageError
from converter.scene.settings import ADAPTIVE_SAMPLES, Settings

if TYPE_CHECKING:
    from converter.commands.method_options import Chosen


class Adapting:
    """A `Refinement` of one picture, which keeps how many samples each pixel has got.

    What a ray changes in a colour that weighs less than the limit is below the limit, too, or nearly.

    Args:
        limit: in levels of 255.
        samples: rays a pixel, at most.

    """

    def __init__(self, limit: float, samples: int) -> None:
        self.least_weight = min(limit / 255, 1.0)
        self._limit = limit
        self._most = samples
        self._spread: Any = None
        self._samples: Any = None

    def unlike(self, signatures: Any, colors: Any) -> Any:
        """The pixels that need a pass of samples, as `Refinement` has it."""
        from converter.renderers.adaptive import unlike_neighbors
        from native_tracer.passes import passes

        self._most = len(passes(self._most)[0])
        result = unlike_neighbors(signatures, colors, self._limit)
        self._samples = 1 + self._most * result.astype("uint32")
        return result

    def unsure(self, sums: Any, size: int, drawn: Any) -> Any:
        """The pixels that need another pass, as `Refinement` has it."""
        from converter.renderers.adaptive import Spread

        self._spread = self._spread or Spread(self._limit)
        result = self._spread.unsure(sums, size, drawn)
        self._samples = self._spread.samples
        return result

    def statistics(self) -> dict[str, Any]:
        """How many pixels got as many samples as any may, and how many rays from the eye a pixel has in the mean."""
        refined = self._samples >= self._most
        return {
            "refined_pixels": int(refined.sum()),
            "refined_share": round(float(refined.mean()), 4),
            "rays_a_pixel": round(float(self._samples.mean()), 4),
        }

    def write_map(self, file: Path) -> None:
        """Draw how many samples pixels have: white for all, black for one."""
        import numpy as np

        from converter.images.write import write_image

        height, width = self._samples.shape
        gray = (np.minimum(self._samples, self._most) - 1) / (self._most - 1)
        ending = None if file.suffix else ".ppm"
        write_image(file, np.repeat(gray[..., None], 3, axis=2).astype(np.float32), width, height, ending)


def adapting(arguments: argparse.Namespace, method: "Chosen") -> tuple[Adapting | None, Settings]:
    """What `--adaptive` asks for, if it is given, and the settings with which it is done.

    Raises:
        UsageError: the options do not go together.

    """
    from converter.renderers.base import draws_adaptively

    if arguments.adaptive is None:
        if arguments.adaptive_map is not None:
            raise UsageError("--adaptive-map: there is one with --adaptive only")
        return None, method.settings
    if not draws_adaptively(method.renderer):
        raise UsageError(f"--adaptive: {method.name} draws all pixels alike")
    if (reason := method.renderer.unfit_to_adapt()) is not None:
        raise UsageError(f"--adaptive: not with {method.name}: {reason}")
    if arguments.resume:
        raise UsageError("--adaptive draws in no passes that --resume could go on from")
    samples = method.settings.samples or ADAPTIVE_SAMPLES
    if samples == 1:
        raise UsageError("--adaptive: with --samples 1 there is nothing to add")
    return Adapting(arguments.adaptive, samples), replace(method.settings, samples=samples)
