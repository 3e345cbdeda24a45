// Intersections of half-spaces: whether a body has a volume, whether it is bounded, which planes cut nothing, where it
// is. All this follows from the polygons of its faces; halfspace_faces.h says how those are found, and what allowance
// is made for rounding.

#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "halfspace_faces.h"

namespace whitted::halfspaces {

// The numbers 0 to count - 1 in an order that looks random, the same in every run. In such an order the first few
// planes cut a face down to about its size, and the rest miss it (de Berg et al., section 4.4).
inline std::vector<int> shuffled(std::size_t count) {
    std::vector<int> order(count);
    std::size_t random = 1;
    for (std::size_t i = 0; i < count; ++i) {
        random = (random * 1103515245 + 12345) % 2147483648U;
        const std::size_t j = random / 8 % (i + 1);
        order[i] = order[j];
        order[j] = static_cast<int>(i);
    }
    return order;
}

// The faces of all planes, empty ones too, finished. They refer to `planes`.
inline std::vector<Face> faces_of(const std::vector<Plane>& planes) {
    const std::vector<int> order = shuffled(planes.size());
    std::vector<Face> faces;
    faces.reserve(planes.size());
    for (std::size_t k = 0; k < planes.size(); ++k) {
        Face& face = faces.emplace_back(planes, static_cast<int>(k));
        for (const int other : order) {
            face.cut_by(other);
        }
        face.finish();
    }
    return faces;
}

// What is known of an intersection of half-spaces.
struct Body {
    bool solid = false;  // it has a volume; otherwise nothing below is known
    bool bounded = true;
    std::vector<int> kept, redundant;  // planes that have a face and planes that have none, ascending
    Vec low, high;                     // box around the points that for_each_anchor() finds
    Vec inside;                        // a point well inside
};

// Find a point inside a bounded body that goes as far as `reach` from the origin: the centroid of its surface. The body
// is nowhere far thicker than the point is deep: for cones, the worst case, six times. False if it is too thin.
inline bool find_inside(const std::vector<Plane>& planes, const std::vector<Face>& faces, Real reach, Vec& inside) {
    const auto counts = [](const Face& face) { return !face.empty() && face.finite(); };
    const auto first = std::find_if(faces.begin(), faces.end(), counts);
    if (first == faces.end()) {
        return false;
    }
    const Vec origin = first->centroid();
    Real total = 0;
    Vec moment;
    for (const Face& face : faces) {
        if (counts(face)) {
            total += face.area();
            moment = moment + face.area() * (face.centroid() - origin);
        }
    }
    inside = origin + (1 / total) * moment;
    return std::all_of(planes.begin(), planes.end(), [&](const Plane& plane) {
        return plane.distance(inside) < -2 * rounding * (reach + std::abs(plane.offset));
    });
}

// The same for a body that need not be bounded, of which only the part in a box around the origin counts.
inline bool find_inside_box(std::vector<Plane> planes, const std::vector<Face>& faces, Real size, Vec& inside) {
    const std::size_t count = planes.size();
    for (const Real sign : {Real(-1), Real(1)}) {
        planes.insert(planes.end(), {{sign, 0, 0, -size}, {0, sign, 0, -size}, {0, 0, sign, -size}});
    }
    std::vector<Face> closed;
    for (std::size_t k = 0; k < planes.size(); ++k) {
        // Planes without a face cut nothing of the box's either.
        if (k < count && faces[k].empty()) {
            continue;
        }
        Face& face = closed.emplace_back(k < count ? faces[k].continued(planes) : Face(planes, static_cast<int>(k)));
        for (std::size_t other = k < count ? count : 0; other < planes.size(); ++other) {
            face.cut_by(static_cast<int>(other));
        }
        face.finish();
    }
    return find_inside(planes, closed, size, inside);
}

// Leaves the faces of all planes in `faces`.
inline Body body_of(const std::vector<Plane>& planes, std::vector<Face>& faces) {
    Body body;
    if (planes.empty()) {
        body.solid = true;
        body.bounded = false;
        return body;
    }
    faces = faces_of(planes);
    Real reach = 0;
    Real height = 0;
    body.low = {infinity, infinity, infinity};
    body.high = {-infinity, -infinity, -infinity};
    for (std::size_t k = 0; k < planes.size(); ++k) {
        const Face& face = faces[k];
        if (!face.empty()) {
            height = std::max(height, std::abs(planes[k].offset));
        }
        if (face.empty() || face.narrow()) {
            body.redundant.push_back(static_cast<int>(k));
            continue;
        }
        body.kept.push_back(static_cast<int>(k));
        body.bounded = body.bounded && face.finite();
        face.for_each_anchor([&](const Vec& p) {
            body.low = {std::min(body.low.x, p.x), std::min(body.low.y, p.y), std::min(body.low.z, p.z)};
            body.high = {std::max(body.high.x, p.x), std::max(body.high.y, p.y), std::max(body.high.z, p.z)};
            reach = std::max(reach, length(p));
        });
    }
    if (!body.kept.empty()) {
        // What goes far away, and gets thin there, may be thick where its planes are nearest the origin.
        body.solid = (body.bounded && find_inside(planes, faces, reach, body.inside)) ||
                     find_inside_box(planes, faces, height > 0 ? 2 * height : 1, body.inside) ||
                     find_inside_box(planes, faces, reach > 0 ? 2 * reach : 1, body.inside);
    }
    return body;
}

// Planes, at most a few, that already leave no volume by themselves, of planes that leave none; ascending. By Helly's
// theorem four are enough. Each is the last plane of the shortest beginning that leaves none; it is put first, and the
// next one looked for.
inline std::vector<int> conflict_of(const std::vector<Plane>& planes) {
    std::vector<int> found;
    const auto leaves_none = [&](std::size_t count) {
        std::vector<Plane> some(planes.begin(), planes.begin() + static_cast<std::ptrdiff_t>(count));
        for (const int k : found) {
            some.push_back(planes[static_cast<std::size_t>(k)]);
        }
        std::vector<Face> faces;
        return !body_of(some, faces).solid;
    };
    std::size_t high = planes.size();
    while (found.size() < 4 && !leaves_none(0)) {
        std::size_t low = 0;
        while (high - low > 1) {
            const std::size_t middle = low + (high - low) / 2;
            (leaves_none(middle) ? high : low) = middle;
        }
        found.push_back(static_cast<int>(high - 1));
    }
    std::sort(found.begin(), found.end());
    return found;
}

}  // namespace whitted::halfspaces
