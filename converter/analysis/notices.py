"""What a scene's reader should be told although nothing is wrong."""

from converter.analysis.enclosure import enclosure_notices
from converter.analysis.oddities import oddity_notices
from converter.scene.errors import place, so_are
from converter.scene.model import Scene
from converter.scene.needs import is_index, scene_needs
from converter.scene.settings import Settings
from converter.shapes.table import shape_kind


def scene_notices(scene: Scene, settings: Settings) -> list[str]:
    """One line for each thing: what its parser chose, that it is sampled, plates without thickness, what is shut in or
    out, and what is surely not meant.

    `ior_notices` are not among them: they are for whoever looks into a scene, or draws it without `--ior`.
    """
    return [
        *scene.notes,
        *_sampling_notices(scene, settings),
        *_plate_notices(scene, settings),
        *enclosure_notices(scene, settings),
        *oddity_notices(scene, settings),
    ]


def ior_notices(scene: Scene, settings: Settings) -> list[str]:
    """One line if an `ior` that something shows is read as n2/n1 for no other reason than that it is above 1."""
    used = sorted({o.finish for o in scene.objects})
    found = [k for k in used if scene.finishes[k].kt > 0 and is_index(scene.finishes[k], settings.ior)]
    if settings.ior != "auto" or not found:
        return []
    k = found[0]
    line = scene.finish_lines[k] if k < len(scene.finish_lines) else 0
    reading = "and read as the material's own index, n2/n1 (--ior ratio reads n1/n2)"
    where = f"{place(scene.file, line)}: finish {k}"
    return [f"{where}: ior {scene.finishes[k].ior:g} is above 1 {reading}{so_are(len(found) - 1)}"]


def _sampling_notices(scene: Scene, settings: Settings) -> list[str]:
    """One line if there are more rays a pixel than one because something is random."""
    needs = scene_needs(scene, settings)
    if not needs.sampled or settings.samples is not None:
        return []
    cause = next(iter(needs.effects.values()))
    return [f"{cause}: {needs.samples} rays a pixel are drawn (--samples asks for another number)"]


def _plate_notices(scene: Scene, settings: Settings) -> list[str]:
    """One line for all plates without thickness, at the first."""
    plates = scene_needs(scene, settings).plates
    found = [i for i, plate in enumerate(plates) if plate]
    if not found:
        return []
    i = found[0]
    planes = shape_kind(scene.objects[i].shape).planes(scene.objects[i].shape)
    sides = " and ".join(f"{k} ({' '.join(f'{x:.12g}' for x in planes[k])})" for k in plates[i])
    where = place(scene.file, scene.objects[i].line)
    what = f"object {i} is a plate without thickness, seen from both sides: its planes {sides} touch"
    return [f"{where}: {what}{so_are(len(found) - 1)}"]
