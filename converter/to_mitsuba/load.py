"""Scene descriptions into Mitsuba's memory."""

from typing import Any

import numpy as np


def load_description(description: dict[str, Any]) -> Any:
    """The `mitsuba.Scene` of a description; Mitsuba's variant is set and our plugins are registered.

    Raises:
        RuntimeError: Mitsuba refuses it.

    """
    import mitsuba as mi

    loaded: dict[str, Any] = {}
    for name, element in description.items():
        loaded[name] = _load(mi, name, _resolve(element, loaded)) if isinstance(element, dict) else element
    # Mitsuba's optimisation would merge meshes, whose names and triangles the integrator's geometry refers to.
    return mi.load_dict(loaded, optimize=False)


def _resolve(element: dict[str, Any], loaded: dict[str, Any]) -> dict[str, Any]:
    """An element whose references to earlier ones are those objects."""
    return {
        key: loaded[value["id"]] if isinstance(value, dict) and value["type"] == "ref" else value
        for key, value in element.items()
    }


def _load(mi: Any, name: str, element: dict[str, Any]) -> Any:
    if element["type"] == "mesh":
        return _mesh(mi, name, element["mesh"], element["bsdf"])
    if "data" in element:
        from mitsuba_plugins.intersection.columns import column

        image = element["data"]
        texels = column(mi.Float, np.asarray(image.texels, dtype=np.float32))
        element = element | {"data": mi.TensorXf(texels, (image.height, image.width, 3))}
    plugin = mi.load_dict(element)
    plugin.set_id(name)
    return plugin


def _mesh(mi: Any, name: str, mesh: Any, bsdf: Any) -> Any:
    """A mesh with a normal for each face, or, where it has them, one for each vertex."""
    from mitsuba_plugins.intersection.columns import column

    props = mi.Properties()
    props["mesh_bsdf"] = bsdf
    normals = getattr(mesh, "normals", None)
    props["face_normals"] = normals is None
    shape = mi.Mesh(name, len(mesh.vertices), len(mesh.triangles), has_vertex_normals=normals is not None, props=props)
    params = mi.traverse(shape)
    params["vertex_positions"] = column(mi.Float, mesh.vertices)
    if normals is not None:
        params["vertex_normals"] = column(mi.Float, normals)
    params["faces"] = column(mi.UInt32, mesh.triangles)
    params.update()
    shape.set_id(name)
    return shape
