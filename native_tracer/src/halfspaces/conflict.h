// Why an intersection of half-spaces has no volume.
//
// By Helly's theorem four of the planes, at most, already leave none. The search for them knows few planes at a time: a
// point well inside of those tells which others matter, namely the ones that exclude it (Clarkson, "Las Vegas
// Algorithms for Linear and Integer Programming When the Dimension Is Small", JACM 42(2), 1995, adds planes likewise).
// Each exclusion takes a good share of the volume that is left, as every cut through the middle of a body does.

#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "halfspaces/halfspaces.h"

namespace whitted::halfspaces {

// The last plane of the shortest beginning of `planes` that leaves no volume together with the planes `found`; it is
// one of the first `count`, which leave none.
inline int last_in_conflict(const std::vector<Plane>& planes, std::size_t count, const std::vector<int>& found) {
    std::vector<Plane> known;
    std::vector<bool> is_known(planes.size());
    const auto learn = [&](std::size_t k) {
        known.push_back(planes[k]);
        is_known[k] = true;
    };
    for (const int k : found) {
        learn(static_cast<std::size_t>(k));
    }
    std::size_t last = 0;
    for (;;) {
        std::vector<Face> faces;
        const Body body = body_of(known, faces);
        if (!body.solid) {
            return static_cast<int>(last);
        }
        std::size_t k = 0;
        while (k < count && (is_known[k] || planes[k].distance(body.inside) <
                                                -rounding * (length(body.inside) + std::abs(planes[k].offset)))) {
            ++k;
        }
        // All planes before this one leave room around the point inside.
        last = std::max(last, k);
        if (k < count) {
            learn(k);
            continue;
        }
        // It is for roundings only that there is no volume; which plane it is that brings them about is not known.
        last = count - 1;
        for (k = 0; k < count; ++k) {
            if (!is_known[k]) {
                learn(k);
            }
        }
    }
}

// Planes, at most a few, that already leave no volume by themselves, of planes that leave none; ascending. Each is the
// last plane of the shortest beginning that leaves none; it is put first, and the next one looked for.
inline std::vector<int> conflict_of(const std::vector<Plane>& planes) {
    std::vector<int> found;
    std::size_t count = planes.size();
    const auto leave_none = [&] {
        std::vector<Plane> some;
        for (const int k : found) {
            some.push_back(planes[static_cast<std::size_t>(k)]);
        }
        std::vector<Face> faces;
        return !body_of(some, faces).solid;
    };
    while (found.size() < 4 && count > 0 && !leave_none()) {
        found.push_back(last_in_conflict(planes, count, found));
        count = static_cast<std::size_t>(found.back());
    }
    std::sort(found.begin(), found.end());
    return found;
}

}  // namespace whitted::halfspaces
