"""Scene descriptions into a folder that Mitsuba loads: scene.xml, and meshes, textures and exact surfaces beside it."""

import math
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any
from xml.etree import ElementTree

from converter.errors import ExportError
from converter.pigments.table import PIGMENT_KINDS
from converter.scene.model import Scene
from converter.scene.settings import Settings
from converter.to_mitsuba.scene import scene_description

ELEMENTS = {
    "whitted": "integrator",
    "pinhole": "sensor",
    "hdrfilm": "film",
    "box": "rfilter",
    "stratified": "sampler",
    "phong": "bsdf",
    "attenuated_point": "emitter",
    "sphere": "shape",
    "ply": "shape",
    **{kind.TEXTURE: "texture" for kind in PIGMENT_KINDS.values()},
}
"""The kind of each plugin that descriptions name, as scene files mark it."""

README = b"""\
A Mitsuba 3 scene, written by `whitted convert`. Its plugins come with the Python package `whitted`. To render it,
in this folder:

    import mitsuba_plugins, mitsuba             # in this order
    mitsuba_plugins.set_variant()               # llvm_ad_rgb or cuda_ad_rgb: no other variant knows the plugins
    image = mitsuba.render(mitsuba.load_file("scene.xml"))
    mitsuba_plugins.write_image("picture.png", image)

The last line writes the bytes that `whitted render` does. The course's colours are display values, while
mitsuba.util.write_bitmap takes them for linear light and applies sRGB's curve: its .png and .jpg are much brighter, and
differ in all pixels. An .exr holds the same numbers either way.
"""


MOST_SHAPES = 1000
"""Objects that become Mitsuba's shapes, at most: each is a plugin, and takes its time and memory when it is loaded."""


def export_scene(scene: Scene, settings: Settings, folder: Path) -> list[Path]:
    """Write `scene`, drawn with `settings`, for Mitsuba, and return the files written, scene.xml first.

    A scene of more than `MOST_SHAPES` objects has exact surfaces only, which the `whitted` integrator draws, and no
    shapes that other integrators see.

    The files appear when all of them are written; an earlier export stays until then.

    Raises:
        ExportError: the folder holds something that this function did not write.
        EffectUnavailable, TextureError, MeshError, OSError: as `scene_description` and the file system have it.
    """
    description = scene_description(scene, settings, with_shapes=len(scene.objects) <= MOST_SHAPES)
    earlier = _earlier_files(folder)
    is_new = not folder.exists()
    folder.mkdir(parents=True, exist_ok=True)
    try:
        with TemporaryDirectory(prefix=".whitted-", dir=folder) as staging:
            written = _write(description, Path(staging))
            for path in earlier:
                path.unlink()
            return [_moved(path, Path(staging), folder) for path in written]
    finally:
        leftovers = [folder / "meshes", folder / "textures", *([folder] if is_new else [])]
        for empty in leftovers:
            with suppress(OSError):  # it is not empty, or was never there
                empty.rmdir()


def _write(description: dict[str, Any], folder: Path) -> list[Path]:
    """Write a description into an empty folder; return the files, scene.xml first."""
    (folder / "meshes").mkdir()
    (folder / "textures").mkdir()
    files = [folder / "scene.xml"]
    root = ElementTree.Element("scene", version="3.0.0")
    for name, element in description.items():
        if isinstance(element, dict):
            element, written = _with_files(name, element, folder)
            files.extend(written)
        if name != "type":
            _append(root, name, element)
    ElementTree.indent(root)
    ElementTree.ElementTree(root).write(files[0], encoding="utf-8", xml_declaration=True)
    files.append(folder / "README.txt")
    files[-1].write_bytes(README)
    return files


def _moved(path: Path, start: Path, end: Path) -> Path:
    """Move a file from somewhere in the folder `start` to the same place in `end`."""
    target = end / path.relative_to(start)
    target.parent.mkdir(exist_ok=True)
    return path.replace(target)


def _earlier_files(folder: Path) -> list[Path]:
    """The files of an earlier export; a folder that is new, empty, or holds no others will do."""
    if not folder.exists():
        return []
    if not folder.is_dir():
        raise ExportError(f"{folder} is a file: expected a folder to write the scene to")
    ours = [*folder.glob("meshes/object_*.ply"), *folder.glob("textures/pigment_*.exr")]
    ours += [folder / name for name in ("scene.xml", "geometry.json", "README.txt") if (folder / name).exists()]
    others = [path for path in folder.rglob("*") if path.is_file() and path not in ours]
    readme = folder / "README.txt"
    if others or (ours and not (readme.is_file() and readme.read_bytes() == README)):
        raise ExportError(f"{folder} holds files that are not of an exported scene: name a new or empty folder")
    return ours


def _with_files(name: str, element: dict[str, Any], folder: Path) -> tuple[dict[str, Any], list[Path]]:
    """An element with what only memory can hold in a file."""
    rest = {key: value for key, value in element.items() if key not in ("mesh", "data", "geometry")}
    if "mesh" in element:
        from converter.to_mitsuba.meshes import write_ply

        path = folder / "meshes" / f"{name}.ply"
        smooth = write_ply(element["mesh"], path)
        return rest | {"type": "ply", "filename": f"meshes/{name}.ply", "face_normals": not smooth}, [path]
    if "data" in element:
        from converter.images.write import write_image

        path = folder / "textures" / f"{name}.exr"
        image = element["data"]
        write_image(path, image.texels, image.width, image.height)
        return rest | {"filename": f"textures/{name}.exr"}, [path]
    if "geometry" in element:
        path = folder / "geometry.json"
        path.write_text(element["geometry"], encoding="utf-8")
        return rest | {"filename": "geometry.json"}, [path]
    return rest, []


def _append(parent: ElementTree.Element, name: str, value: Any) -> None:
    """Add one property or plugin to an XML element."""
    if isinstance(value, dict):
        _append_object(parent, name, value)
    elif isinstance(value, bool):
        ElementTree.SubElement(parent, "boolean", name=name, value=str(value).lower())
    elif isinstance(value, int):
        ElementTree.SubElement(parent, "integer", name=name, value=str(value))
    elif isinstance(value, float):
        ElementTree.SubElement(parent, "float", name=name, value=_number(value))
    elif isinstance(value, str):
        ElementTree.SubElement(parent, "string", name=name, value=value)
    else:
        tag = "point" if name == "center" else "vector"
        ElementTree.SubElement(parent, tag, name=name, value=", ".join(map(_number, value)))


def _append_object(parent: ElementTree.Element, name: str, value: dict[str, Any]) -> None:
    kind = value["type"]
    if kind == "rgb":
        ElementTree.SubElement(parent, "rgb", name=name, value=", ".join(map(_number, value["value"])))
        return
    if kind == "ref":
        ElementTree.SubElement(parent, "ref", name=name, id=value["id"])
        return
    attributes = {"type": kind, "id": name} if parent.tag == "scene" else {"type": kind, "name": name}
    child = ElementTree.SubElement(parent, ELEMENTS[kind], attributes)
    for key, inner in value.items():
        if key != "type":
            _append(child, key, inner)


def _number(value: float) -> str:
    """The shortest digits that read back as the same double."""
    if not math.isfinite(value):
        raise ExportError(f"{value} cannot be written to a scene file")
    return repr(float(value))
