"""Polyhedra as triangle meshes that remember which plane each triangle lies on.

The planes of a polyhedron become points, its dual, whose convex hull manifold3d finds: a hull vertex is a face of the
polyhedron, a hull triangle a vertex, n log n (Preparata and Shamos, "Computational Geometry", 1985, section 7.3; de
Berg et al., "Computational Geometry", 3rd ed., 2008, section 11.4). Only the neighbourhoods are taken from it, which
face borders on which; coordinates are those of the polygons of `native_tracer.halfspaces`, each from three planes.

manifold3d drops points closer to the hull than 1e-7 of its size. Two things are done about that. The body is scaled,
differently along three axes, until it is about as thick as long, so that slivers are none: affine maps take half-spaces
to half-spaces. And the hull's neighbourhoods are compared with those of the polygons, another method altogether: a hull
that misses a face or an edge is not used. Then the polygons' own are, if they close a surface.
"""

from converter.to_mitsuba.meshes.body import polyhedron_mesh
from converter.to_mitsuba.meshes.mesh import MeshError, PolyhedronMesh, write_ply

__all__ = ["MeshError", "PolyhedronMesh", "polyhedron_mesh", "write_ply"]
