"""`--adaptive`: pixels that are unlike their neighbours are drawn with more samples."""

import argparse
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from converter.commands.exits import UsageError
from converter.scene.settings import SAMPLES, Settings

if TYPE_CHECKING:
    from converter.commands.method_options import Chosen


class Adapting:
    """Chooses the pixels of a picture, for `draw`, and keeps what was chosen."""

    def __init__(self, limit: float, samples: int) -> None:
        self._limit = limit
        self._samples = samples
        self._chosen: Any = None

    def __call__(self, signatures: Any, colors: Any) -> Any:
        """Choose, as `converter.renderers.base.Choose` has it."""
        from converter.renderers.adaptive import unlike_neighbors

        self._chosen = unlike_neighbors(signatures, colors, self._limit)
        return self._chosen

    def statistics(self) -> dict[str, Any]:
        """How many pixels were refined, and how many rays from the eye a pixel has in the mean."""
        share = float(self._chosen.mean())
        refined = int(self._chosen.sum())
        return {"refined_pixels": refined, "refined_share": share, "rays_a_pixel": 1 + self._samples * share}

    def write_map(self, file: Path) -> None:
        """Draw the pixels that were chosen: white, the others black."""
        import numpy as np

        from converter.images.write import write_image

        height, width = self._chosen.shape
        ending = None if file.suffix else ".ppm"
        write_image(file, np.repeat(self._chosen[..., None], 3, axis=2).astype(np.float32), width, height, ending)


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
    samples = method.settings.samples or SAMPLES
    if samples == 1:
        raise UsageError("--adaptive: with --samples 1 there is nothing to add")
    return Adapting(arguments.adaptive, samples), replace(method.settings, samples=samples)
