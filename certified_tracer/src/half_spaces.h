// Where rays meet polyhedra: between the last of the half-spaces that they enter and the first that they leave.

#pragma once

#include <cstddef>
#include <limits>
#include <numeric>

#include "plain.h"
#include "prepared.h"
#include "rays.h"
#include "scene.h"
#include "surfaces.h"
#include "undecided.h"

namespace certified {

template <typename End>
class HalfSpaces {
 public:
    using I = Interval<End>;
    using V = Vector<I>;
    using R = Ray<End>;
    using S = typename PreparedScene<End>::PreparedSurface;

    // `plain`: with which to leave out what plain doubles exclude, or none.
    HalfSpaces(const Surfaces<End>& surfaces, Judge<End>& judge, const PlainScene* plain)
        : surfaces_(surfaces), judge_(judge), plain_(plain) {}

    // Where a ray meets a plane: sign of its slope, and the distance if that is not 0; `side` tells of one that runs
    // along.
    int meet_plane(const S& s, const R& ray, I& t, int& side) {
        const bool start = surfaces_.starts_on(s, ray), end = surfaces_.ends_on(s, ray);
        side = 0;
        if (start && end) {
            return 0;
        }
        const I slope = dot(s.vector, ray.direction);
        if (start) {
            t = I(0);
            return judge_.sign(slope, Reason::hit);
        }
        const I height = dot(s.vector, ray.origin) + s.number;
        if (end) {
            t = I(1);
            return -judge_.sign(height, Reason::shadow);
        }
        const int sign = judge_.sign(slope, Reason::hit);
        if (sign == 0) {
            side = judge_.sign(height, Reason::hit);
        } else {
            t = -height / slope;
        }
        return sign;
    }

    Passage<End> pass(const Leaf& leaf, const R& ray, const PlainRay& narrow, double end) {
        if (!sift(leaf, narrow, end, true)) {
            return {};
        }
        Extreme enters{1}, leaves{-1};
        for (const std::size_t k : sieve_.left) {
            const int index = static_cast<int>(leaf.first + k);
            I t;
            int side;
            const int slope = meet_plane(surfaces_[index], ray, t, side);
            if (slope == 0) {
                if (side > 0) {
                    return {};
                }
                continue;
            }
            if (slope > 0 && t.negative()) {
                return {};  // it is left before the start
            }
            consider(slope < 0 ? enters : leaves, t, index);
            if (enters.found && leaves.found && leaves.first.t.high() < enters.first.t.low()) {
                return {};
            }
        }
        Passage<End> result;
        if (enters.found && leaves.found && surfaces_.order(enters.first, leaves.first, Reason::hit) > 0) {
            return {};
        }
        const int entered = enters.found ? judge_.sign(enters.first.t, Reason::hit) : -1;
        const int left = leaves.found ? judge_.sign(leaves.first.t, Reason::hit) : 1;
        result.inside = entered <= 0 && left > 0;
        if (entered > 0) {
            check(enters);
            result.add(enters.first.t, enters.first.surface);
        }
        if (leaves.found && left > 0) {
            if (result.count == 0) {
                check(leaves);
            }
            result.add(leaves.first.t, leaves.first.surface);
            result.last_sure = leaves.sure;
        }
        return result;
    }

    // From a face inward, or a plate's other side.
    bool leave(int index, const Leaf& leaf, const R& ray, const PlainRay& narrow, Met<End>& met) {
        sift(leaf, narrow, std::numeric_limits<double>::infinity(), false);
        Extreme leaves{-1};
        for (const std::size_t k : sieve_.left) {
            const int plane = static_cast<int>(leaf.first + k);
            if (plane == ray.surface) {
                continue;
            }
            I t;
            int side;
            const int slope = meet_plane(surfaces_[plane], ray, t, side);
            if (slope > 0) {
                // From within it is not before the start.
                consider(leaves, max(t, I(0)), plane);
            }
        }
        if (!leaves.found) {
            return false;
        }
        check(leaves);
        met = {leaves.first.t, index, leaves.first.surface, true, true};
        return true;
    }

 private:
    // Of distances the largest (1) or the smallest (-1), and the plane with the lowest number that has it.
    struct Extreme {
        int direction;
        bool found = false, sure = true;
        Crossing<End> first{0, -1};
    };

    void consider(Extreme& extreme, const I& t, int index) {
        if (!extreme.found) {
            extreme.found = true;
            extreme.first = {t, index};
            return;
        }
        Crossing<End>& first = extreme.first;
        const bool above = first.t.high() < t.low(), below = t.high() < first.t.low();
        if (above || below) {
            if (above == (extreme.direction > 0)) {
                first = {t, index};
                extreme.sure = true;
            }
            return;
        }
        int order = 0;
        try {
            order = surfaces_.order({t, index}, first, Reason::plane);
        } catch (const Undecided&) {
            first.t = extreme.direction > 0 ? max(first.t, t) : min(first.t, t);
            extreme.sure = false;
            return;
        }
        if (order * extreme.direction > 0) {
            first = {t, index};
        }
    }

    // Those of a polyhedron that matter, in their order; false: the ray certainly misses it.
    bool sift(const Leaf& leaf, const PlainRay& narrow, double end, bool entries) {
        if (plain_ != nullptr) {
            return plain_->planes[leaf.first].sift(narrow, end, entries, sieve_);
        }
        sieve_.left.resize(leaf.count);
        std::iota(sieve_.left.begin(), sieve_.left.end(), std::size_t(0));
        return true;
    }

    static void check(const Extreme& extreme) {
        if (!extreme.sure) {
            throw Undecided{Reason::plane};
        }
    }

    const Surfaces<End>& surfaces_;
    Judge<End>& judge_;
    const PlainScene* plain_;
    PlainPlanes::Sieve sieve_;
};

}  // namespace certified
