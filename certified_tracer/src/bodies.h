// Where rays meet bodies, with certainty.

#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "csg.h"
#include "half_spaces.h"
#include "plain.h"
#include "prepared.h"
#include "quadratics.h"
#include "rays.h"
#include "scene.h"
#include "surfaces.h"
#include "undecided.h"

namespace certified {

template <typename End>
class Bodies {
 public:
    using I = Interval<End>;
    using R = Ray<End>;
    using S = typename PreparedScene<End>::PreparedSurface;

    // `plain`: with which to leave out what plain doubles exclude, or none.
    Bodies(const PreparedScene<End>& scene, Judge<End>& judge, const PlainScene* plain)
        : scene_(scene),
          surfaces_(scene, judge),
          quadratics_(surfaces_, judge),
          half_spaces_(surfaces_, judge, plain),
          plain_(plain) {}

    // Parts refer to each other.
    Bodies(const Bodies&) = delete;
    Bodies& operator=(const Bodies&) = delete;

    const Surfaces<End>& surfaces() const { return surfaces_; }

    // The first place beyond the ray's start; whether there is one. `narrow`: the ray in plain doubles;
    // what is certainly not met before `end` may count as missed.
    bool meet(int index, const R& ray, const PlainRay& narrow, double end, Met<End>& met) {
        const Body& body = scene_.scene.bodies[static_cast<std::size_t>(index)];
        if (body.program.empty()) {
            const Leaf& leaf = scene_.scene.leaves[body.leaves[0]];
            const bool own = ray.body == index;
            if (leaf.count > 0 && surfaces_[leaf.first].kind != Kind::quadric && own && !ray.inside) {
                return false;  // they are convex
            }
            if (own && surfaces_[leaf.first].kind == Kind::plane) {
                return half_spaces_.leave(index, leaf, ray, narrow, met);
            }
            const Passage<End> passage = pass(leaf, ray, narrow, end, own);
            if (passage.count == 0) {
                return false;
            }
            met = {passage.crossings[0].t, index, passage.crossings[0].surface, passage.inside, passage.inside};
            return true;
        }
        return meet_csg(index, body, ray, narrow, met);
    }

    // What another kind of intervals has found of this ray, with its own place. Throws Undecided.
    Met<End> located(const Met<double>& found, const R& ray) {
        Met<End> met{{}, found.body, found.surface, found.inside, found.behind};
        if (found.t.low() == 0 && found.t.high() == 0) {
            met.t = I(0);
            return met;
        }
        const S& s = surfaces_[found.surface];
        if (s.kind == Kind::plane) {
            int side;
            if (half_spaces_.meet_plane(s, ray, met.t, side) == 0) {
                throw Undecided{Reason::hit};
            }
            return met;
        }
        const Body& body = scene_.scene.bodies[static_cast<std::size_t>(found.body)];
        const bool own = ray.body == found.body && body.program.empty();
        const Passage<End> passage = s.kind == Kind::sphere ? quadratics_.pass_sphere(found.surface, ray, own)
                                                            : quadratics_.pass_quadric(found.surface, ray, own);
        int places = 0;
        for (int i = 0; i < passage.count; ++i) {
            const I& t = passage.crossings[static_cast<std::size_t>(i)].t;
            if (t.low_double() <= found.t.high() && t.high_double() >= found.t.low()) {
                met.t = t;
                ++places;
            }
        }
        if (places != 1) {
            throw Undecided{Reason::hit};
        }
        return met;
    }

 private:
    Passage<End> pass(const Leaf& leaf, const R& ray, const PlainRay& narrow, double end, bool own) {
        switch (surfaces_[leaf.first].kind) {
            case Kind::sphere:
                if (plain_ != nullptr && !own && plain_->spheres[leaf.first].is_missed(narrow, end) &&
                    !surfaces_.touches(surfaces_[leaf.first], ray)) {
                    return {};
                }
                return quadratics_.pass_sphere(static_cast<int>(leaf.first), ray, own);
            case Kind::plane:
                return half_spaces_.pass(leaf, ray, narrow, end);
            case Kind::quadric:
                break;
        }
        return quadratics_.pass_quadric(static_cast<int>(leaf.first), ray, own);
    }

    bool meet_csg(int index, const Body& body, const R& ray, const PlainRay& narrow, Met<End>& met) {
        way_.clear();
        for (std::size_t k = 0; k < body.leaves.size(); ++k) {
            const Leaf& leaf = scene_.scene.leaves[body.leaves[k]];
            way_.add(pass(leaf, ray, narrow, std::numeric_limits<double>::infinity(), false), k);
        }
        if (ray.body == index && way_.starts_inside(body) != ray.inside && cross_at_start(index, body, ray, met)) {
            return true;
        }
        return way_.meet(body, index, surfaces_, met);
    }

    // A ray that starts on the body, and goes on inside or outside of it, meets what else is at an edge at once, as it
    // does at a polyhedron's: the first surface of those by which the whole is left there, or entered.
    bool cross_at_start(int index, const Body& body, const R& ray, Met<End>& met) const {
        const std::uint64_t turned = subtracted(body);
        for (std::size_t k = 0; k < body.leaves.size(); ++k) {
            const Leaf& leaf = scene_.scene.leaves[body.leaves[k]];
            const bool leaves = ray.inside != ((turned >> k & 1) != 0);
            int first = -1;
            for (std::size_t i = 0; i < std::max(leaf.count, std::size_t(1)); ++i) {
                const S& s = surfaces_[leaf.first + i];
                const int side = surfaces_.side_of_start(s, ray);
                if (side > 0) {
                    first = -1;
                    break;  // beside the leaf
                }
                if (side == 0 && first < 0 && surfaces_.way_from_start(s, ray) == (leaves ? 1 : -1)) {
                    first = static_cast<int>(leaf.first + i);
                }
            }
            if (first >= 0) {
                met = {I(0), index, first, ray.inside, leaves};
                return true;
            }
        }
        return false;
    }

    const PreparedScene<End>& scene_;
    Surfaces<End> surfaces_;
    Quadratics<End> quadratics_;
    HalfSpaces<End> half_spaces_;
    const PlainScene* plain_;
    CsgWay<End> way_;  // one after the other
};

}  // namespace certified
