// Intersections of half-spaces: whether a body has a volume, whether it is bounded, which planes cut nothing, where it
// is. All this follows from the polygons of its faces; halfspaces/faces.h says how those are found, and what allowance
// is made for rounding.

#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "halfspaces/cutting_order.h"
#include "halfspaces/faces.h"
#include "halfspaces/parallel.h"

namespace whitted::halfspaces {

// The faces of all planes, empty ones too, finished, as far as `far` from the origin. They refer to `planes`.
inline std::vector<Face> faces_of(const std::vector<Plane>& planes, Real far,
                                  std::size_t leaf_size = CuttingOrder::usual_leaf_size) {
    const CuttingOrder order(planes, leaf_size);
    std::vector<Face> faces;
    faces.reserve(planes.size());
    for (std::size_t k = 0; k < planes.size(); ++k) {
        faces.emplace_back(planes, static_cast<int>(k), far);
    }
    const std::vector<int> numbers = order.by_neighborhood();
    constexpr std::size_t share = 256;  // faces, a few milliseconds
    for_each_index(numbers.size(), share, [&](std::size_t i) {
        Face& face = faces[static_cast<std::size_t>(numbers[i])];
        order.cut(face);
        face.finish();
    });
    return faces;
}

// The faces of a body's part in the box of half size `size` around the origin, none of them empty, the box's own among
// them, whose planes are added to `planes`.
inline std::vector<Face> faces_in_box(std::vector<Plane>& planes, const std::vector<Face>& faces, Real size) {
    const int count = static_cast<int>(planes.size());
    for (const Real sign : {Real(-1), Real(1)}) {
        planes.insert(planes.end(), {{sign, 0, 0, -size}, {0, sign, 0, -size}, {0, 0, sign, -size}});
    }
    std::vector<Face> result;
    for (const Face& face : faces) {
        // A plane without a face cuts nothing of the box's faces either.
        if (!face.empty()) {
            result.push_back(face.continued(planes));
            for (int other = count; other < count + 6; ++other) {
                result.back().cut_by(other);
            }
        }
    }
    for (int k = count; k < count + 6; ++k) {
        result.emplace_back(planes, k, 4 * size);
        for (int other = 0; other < count + 6; ++other) {
            result.back().cut_by(other);
        }
    }
    std::erase_if(result, [](const Face& face) { return face.empty(); });
    for (Face& face : result) {
        face.finish();
    }
    return result;
}

// Find a point inside a body whose faces form a closed surface, and go as far as `reach` from the origin: the centroid
// of the surface. The body is nowhere far thicker than that is deep: for cones, the worst case, six times. False if it
// is too thin.
inline bool find_inside(const std::vector<Plane>& planes, const std::vector<Face>& faces, Real reach, Vec& inside) {
    Real total = 0;
    Vec moment;
    for (const Face& face : faces) {
        if (!face.empty()) {
            total += face.area();
            moment = moment + face.area() * face.centroid();
        }
    }
    inside = (1 / total) * moment;
    return std::all_of(planes.begin(), planes.end(), [&](const Plane& plane) {
        return plane.distance(inside) < -2 * rounding * (reach + std::abs(plane.offset));
    });
}

// What is known of an intersection of half-spaces.
struct Body {
    bool solid = false;      // it has a volume
    std::vector<int> plate;  // if it has none, but a face: the two planes that touch there; see halfspaces/plate.h
    bool bounded = true;     // of what is neither, nothing more is known
    std::vector<int> kept, redundant;  // planes that have a face and planes that have none, ascending
    Vec low, high;                     // box around the points that for_each_anchor() finds
    Vec inside;                        // a point well inside
};

// The body as far as `far` from the origin. Leaves the faces of all planes in `faces`.
inline Body body_within(const std::vector<Plane>& planes, Real far, std::vector<Face>& faces) {
    Body body;
    faces = faces_of(planes, far);
    std::vector<bool> has_face(planes.size());
    bool any_narrow = false;
    bool closed = true;
    Real height = 0;
    Real reach = 0;
    for (std::size_t k = 0; k < planes.size(); ++k) {
        if (!faces[k].empty()) {
            has_face[k] = !faces[k].narrow();
            any_narrow = any_narrow || !has_face[k];
            closed = closed && faces[k].bounded();
            height = std::max(height, std::abs(planes[k].offset));
            faces[k].for_each_anchor([&](const Vec& p) { reach = std::max(reach, length(p)); });
        }
    }
    body.solid = closed && find_inside(planes, faces, reach, body.inside);
    const auto look_into_box = [&](Real size) {
        std::vector<Plane> boxed = planes;
        const std::vector<Face> parts = faces_in_box(boxed, faces, size);
        for (const Face& part : parts) {
            if (part.index() < planes.size() && !part.narrow()) {
                has_face[part.index()] = true;
            }
        }
        body.solid = body.solid || find_inside(boxed, parts, size, body.inside);
    };
    // What goes far, and is narrow or thin for that, may be neither where its planes are nearest the origin.
    if (!body.solid || any_narrow) {
        look_into_box(height > 0 ? 2 * height : 1);
    }
    if (!body.solid && reach > 0) {
        look_into_box(2 * reach);
    }
    body.low = {far, far, far};
    body.high = {-far, -far, -far};
    for (std::size_t k = 0; k < planes.size(); ++k) {
        (has_face[k] ? body.kept : body.redundant).push_back(static_cast<int>(k));
        if (has_face[k]) {
            body.bounded = body.bounded && faces[k].bounded();
            faces[k].for_each_anchor([&](const Vec& p) {
                body.low = {std::min(body.low.x, p.x), std::min(body.low.y, p.y), std::min(body.low.z, p.z)};
                body.high = {std::max(body.high.x, p.x), std::max(body.high.y, p.y), std::max(body.high.z, p.z)};
            });
        }
    }
    return body;
}

// An intersection of half-spaces. It counts as unbounded if it goes on for 2^24 times as far from the origin as its
// planes are; if it does not even begin there, for 2^40 times. Leaves the faces of all planes in `faces`.
inline Body body_of(const std::vector<Plane>& planes, std::vector<Face>& faces) {
    Body body;
    if (planes.empty()) {
        body.solid = true;
        body.bounded = false;
        return body;
    }
    Real height = 0;
    for (const Plane& plane : planes) {
        height = std::max(height, std::abs(plane.offset));
    }
    for (const Real far : {0x1p24L, 0x1p40L}) {
        body = body_within(planes, far * (height > 0 ? height : 1), faces);
        if (body.solid) {
            break;
        }
    }
    return body;
}

}  // namespace whitted::halfspaces
