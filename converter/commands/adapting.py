"""`--adaptive`: pixels are drawn with more samples where they need them."""

import argparse
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from converter.commands.exits import UsageError
from converter.scene.settings import ADAPTIVE_SAMPLES, Settings

if TYPE_CHECKING:
    from converter.commands.method_options import Chosen
    from converter.renderers.adaptive import Adapting


def write_map(file: Path, adapted: "Adapting") -> None:
    """Draw how many samples pixels have: white for all, black for one."""
    import numpy as np

    from converter.images.write import write_image

    height, width = adapted.samples.shape
    gray = (adapted.samples - 1) / (adapted.most - 1)
    ending = None if file.suffix else ".ppm"
    write_image(file, np.repeat(gray[..., None], 3, axis=2).astype(np.float32), width, height, ending)


def adapting(arguments: argparse.Namespace, method: "Chosen") -> "tuple[Adapting | None, Settings]":
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
    from converter.renderers.adaptive import Adapting  # late: it imports NumPy

    return Adapting(arguments.adaptive, samples), replace(method.settings, samples=samples)
