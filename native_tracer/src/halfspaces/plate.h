// Plates without thickness: two half-spaces that touch, and what the others leave of the plane between them.
//
// An intersection without a volume that has a face lies in that face's plane. Around a point within the face none but
// that plane's own half-spaces matter, and these leave no volume only if there is one on either side of it. So such a
// pair is among the planes, and it is all that leaves no volume: halfspaces/conflict.h finds it.

#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "halfspaces/halfspaces.h"

namespace whitted::halfspaces {

// Whether two planes are the same but for roundings, and face away from each other.
inline bool touch(const Plane& one, const Plane& other) {
    const Vec sum = one.normal + other.normal;
    return std::max({std::abs(sum.x), std::abs(sum.y), std::abs(sum.z)}) <= few_roundings &&
           std::abs(one.offset + other.offset) <= few_roundings * std::abs(one.offset);
}

// What the planes leave of plane `front`, as far as `far` from its point nearest the origin; empty if that has no
// width.
inline Face plate_face(const std::vector<Plane>& planes, int front, Real far) {
    Face face(planes, front, far);
    for (std::size_t k = 0; k < planes.size(); ++k) {
        const int other = static_cast<int>(k);
        if (!face.empty() && !face.coincides_with(other)) {
            face.cut_by(other);
        }
    }
    face.finish();
    return face;
}

// A body of which it is known that the planes of `pair` leave no volume: it may still be a plate. It is as unbounded as
// body_of() has it. Leaves its face, that of the pair's first plane, in `face`.
inline Body plate_of(const std::vector<Plane>& planes, const std::vector<int>& pair, std::vector<Face>& face) {
    Body body;
    face.clear();
    const int front = pair[0];
    const int back = pair[1];
    if (!touch(planes[static_cast<std::size_t>(front)], planes[static_cast<std::size_t>(back)])) {
        return body;
    }
    Real height = 0;
    for (const Plane& plane : planes) {
        height = std::max(height, std::abs(plane.offset));
    }
    const Real scale = height > 0 ? height : 1;
    face.push_back(plate_face(planes, front, 0x1p24L * scale));
    const Face& whole = face[0];
    if (whole.empty()) {
        return body;
    }
    // What goes far, and is narrow for that, may not be where its planes are nearest the origin.
    const Face near = plate_face(planes, front, 2 * scale);
    const bool wide_near = !near.empty() && !near.narrow();
    if (!wide_near && whole.narrow()) {
        return body;
    }
    body.plate = pair;
    body.bounded = whole.bounded();
    body.inside = wide_near && !body.bounded ? near.centroid() : whole.centroid();
    std::vector<bool> is_kept(planes.size());
    is_kept[static_cast<std::size_t>(front)] = is_kept[static_cast<std::size_t>(back)] = true;
    for (const auto& [turn, edge] : whole.edges()) {
        if (edge.neighbor >= 0) {
            is_kept[static_cast<std::size_t>(edge.neighbor)] = true;
        }
    }
    for (std::size_t k = 0; k < planes.size(); ++k) {
        (is_kept[k] ? body.kept : body.redundant).push_back(static_cast<int>(k));
    }
    body.low = body.high = body.inside;
    bool any = false;
    whole.for_each_anchor([&](const Vec& p) {
        body.low = any ? Vec{std::min(body.low.x, p.x), std::min(body.low.y, p.y), std::min(body.low.z, p.z)} : p;
        body.high = any ? Vec{std::max(body.high.x, p.x), std::max(body.high.y, p.y), std::max(body.high.z, p.z)} : p;
        any = true;
    });
    return body;
}

}  // namespace whitted::halfspaces
