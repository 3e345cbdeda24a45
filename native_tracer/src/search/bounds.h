// The box around a shape, with a proof that it is one, and what a ray's test of the shape costs.

#pragma once

#include <optional>
#include <vector>

#include "search/bvh.h"
#include "tracing/description.h"

namespace whitted {

struct Bounds {
    Box box;
    double
        growth;  // moving the surface outward by some distance moves no side of the box by more than `growth` times it
    double reach;  // no plane that proves the box is farther from the origin
};

// A box that is not much larger than it has to be; nothing if the shape has no bounds or no points. A polyhedron counts
// as unbounded if it goes on for 2^24 times as far from the origin as its planes are.
std::optional<Bounds> bounds_of(const SphereDescription& sphere);
std::optional<Bounds> bounds_of(const PolyhedronDescription& polyhedron);
std::optional<Bounds> bounds_of(const QuadricDescription& quadric);
std::optional<Bounds> bounds_of(const CsgDescription& csg);
std::optional<Bounds> bounds_of(const MovingDescription& moving);  // wherever the body is

// For each leaf of a csg a box outside which it makes no difference whether it is there, if there is one.
std::vector<std::optional<Bounds>> leaf_bounds_of(const CsgDescription& csg);

// The cost of a ray's test, in tests of spheres. Two planes of a polyhedron cost about as much as one.
inline double cost_of(const SphereDescription&) { return 1; }
inline double cost_of(const PolyhedronDescription& polyhedron) {
    return 0.5 * static_cast<double>(polyhedron.planes.size());
}
inline double cost_of(const QuadricDescription&) { return 2; }
double cost_of(const CsgDescription& csg);
double cost_of(const MovingDescription& moving);

}  // namespace whitted
