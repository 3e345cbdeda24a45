"""A pixel's ray trees as the page shows them."""

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from converter.compare.ray_listing import list_rays
from converter.compare.rays import first_unequal, pair_trees
from converter.page.paths import ray_lines
from converter.renderers.records import PixelRecord
from converter.scene.model import Scene
from converter.scene.settings import Settings

MOST_LINES = 400
"""Of the listing: a tree may have thousands of rays."""


def tree_message(scene: Scene, settings: Settings, traced: Mapping[str, PixelRecord]) -> dict[str, Any]:
    """The rays of a pixel by one or two renderers, as a message: listed as `whitted pixel` does, and as lines."""
    names, trees = list(traced), list(traced.values())
    pairs = pair_trees(trees[0].rays, trees[-1].rays)
    first = first_unequal(pairs)
    listed = list_rays(pairs, scene, (names[0][0], names[-1][0]), first)
    lines = [{"text": line.text, "side": line.side, "first": line.first} for line in listed[:MOST_LINES]]
    if len(listed) > MOST_LINES:
        lines.append({"text": f"... and {len(listed) - MOST_LINES} more lines", "side": "both", "first": False})
    colors = {name: " ".join(f"{channel:.6f}" for channel in tree.color) for name, tree in traced.items()}
    drawn = ray_lines(trees[0].rays, scene.camera, settings.width, settings.height)
    verdict = "" if len(names) < 2 else "The trees are the same." if first is None else "The trees differ: see >."
    return {
        "x": trees[0].x,
        "y": trees[0].y,
        "lines": lines,
        "colors": colors,
        "verdict": verdict,
        "path": [asdict(line) for line in drawn],
    }
