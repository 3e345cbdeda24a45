// Where rays cross the shapes of a scene: those outside its tree are asked one by one, the others as the tree comes to
// them, by all rays together until some are alone in their part of it.
//
// What is sought is a query. It has
//
//     limit             no crossing beyond it matters; negative for rays that ask nothing
//     close             the rays for which it has been noticed that they may meet two things at once, but for rounding
//                       errors
//     by_rules          ties between a shape's primitives are decided instead; no ray leaves the others then
//     which_primitive   a tie of two primitives of one shape makes a difference
//     may_meet          whether a shape matters, by its sight from where a view was made
//     meet              takes crossings with a shape, of which some may be infinite or beyond the limit, which it may
//                       lower; false: enough is known

#pragma once

#include <bit>
#include <cstddef>
#include <limits>

#include "shapes/ball.h"
#include "shapes/crossing.h"
#include "shapes/moving.h"
#include "shapes/shapes.h"
#include "shapes/sphere.h"
#include "tracing/box_test.h"
#include "tracing/ray.h"
#include "tracing/scene.h"
#include "tracing/tree.h"
#include "tracing/vector.h"
#include "tracing/walks.h"
#include "tracing/wide_tree.h"

namespace whitted::WHITTED_ISA {

// ---- Rays that are alone ------------------------------------------------------------------------------------------

// Asks a shape of those rays that have come to it, and takes what is found. False: enough is known.
template <typename Shape, typename Real, typename Query>
[[gnu::always_inline]] inline bool meet_alone(const Shape& shape, const Rays<Real>& rays, Mask<Real> here,
                                              Query& query) {
    Crossing<Real> crossing;
    Mask<Real> may_tie = Mask<Real>::none();
    const Lanes<Real> limit = select(here, query.limit, Lanes<Real>(Real(-1)));
    const bool crosses =
        shape.template intersect<Query::which_primitive>(at_rest(shape, rays), limit, crossing, may_tie);
    query.close |= may_tie & here;  // of a ray along a plane, it may be all that is known
    if (!crosses) {
        return true;
    }
    crossing.t = select(here, crossing.t, Lanes<Real>(std::numeric_limits<Real>::infinity()));
    return query.meet(shape, crossing);
}

// What traverse() does, for what is left to walks. By value: else the query would be in memory there, too.
template <typename Real, typename Query>
[[gnu::noinline]] inline Query traverse_alone(const Scene<Real>& scene, const Rays<Real>& rays,
                                              const BoxTest<Real>& test, Walks<Real>& walks, Query query) {
    constexpr std::size_t spheres = 0;
    const auto meet = [&](unsigned lanes, const int* met) {
        unsigned balls = 0;
        for (unsigned left = lanes; left != 0; left &= left - 1) {
            const int lane = std::countr_zero(left);
            balls |= (WideTree<Real>::shape_at(met[lane]).kind == spheres ? 1U : 0U) << lane;
        }
        // Spheres are met one to a lane,
        if (balls != 0) {
            const auto ball = gather_balls<Real>(balls, [&](int lane) -> const auto& {
                return scene.shapes.template at<Sphere<Real>>(WideTree<Real>::shape_at(met[lane])).ball();
            });
            Crossing<Real> crossing;
            if (ball.intersect(rays, crossing) && !query.meet(ball, crossing)) {
                return false;
            }
        }
        // and each other shape by all that have come to it.
        for (unsigned left = lanes & ~balls; left != 0;) {
            const int shape = met[std::countr_zero(left)];
            const auto has_met = [&](int lane) { return (left >> lane & 1U) != 0 && met[lane] == shape; };
            const Mask<Real> here = Mask<Real>::gather(has_met);
            const auto meet_it = [&](const auto& its) { return meet_alone(its, rays, here, query); };
            if (!scene.shapes.visit(WideTree<Real>::shape_at(shape), meet_it)) {
                return false;
            }
            left &= ~here.bits();
        }
        return true;
    };
    scene.tree.wide().walk(test, walks, query.limit, meet, [&](ShapeIndex shape) {
        if (shape.kind == spheres) {
            __builtin_prefetch(&scene.shapes.template at<Sphere<Real>>(shape));
        }
    });
    return query;
}

// ---- All rays -----------------------------------------------------------------------------------------------------

// Puts the query to the shapes that some ray crosses before its limit, and maybe to others, until it knows enough. With
// a view, rays pass where that was made from.
template <typename Real, typename Query>
[[gnu::always_inline]] inline void traverse(const Scene<Real>& scene, const Rays<Real>& rays, const View<Real>* view,
                                            Query& query) {
    const auto meet = [&](const auto& shape) __attribute__((always_inline)) {
        Crossing<Real> crossing;  // of its own, so that it stays in registers but for calls that need it elsewhere
        const Rays<Real>& resting = at_rest(shape, rays);
        bool crosses;
        if constexpr (Query::by_rules) {
            crosses = shape.intersect_by_rules(resting, crossing);
        } else {
            crosses = shape.template intersect<Query::which_primitive>(resting, query.limit, crossing, query.close);
        }
        return !crosses || query.meet(shape, crossing);
    };
    const auto meet_in_sight = [&](const auto& shape, const auto& sight)
                                   __attribute__((always_inline)) { return !query.may_meet(sight) || meet(shape); };
    const bool goes_on =
        view ? scene.shapes.for_each(scene.apart, *view, meet_in_sight) : scene.shapes.for_each(scene.apart, meet);
    if (!goes_on || scene.tree.empty()) {
        return;
    }
    const BoxTest<Real> test = scene.tree.test(rays);
    Walks<Real> walks;
    const bool unfinished = scene.tree.template for_each_leaf<!Query::by_rules>(
        rays, test, query.limit, walks, [&](const typename Tree<Real>::Leaf& leaf) __attribute__((always_inline)) {
            return scene.shapes.for_each(leaf, meet);
        });
    if constexpr (!Query::by_rules) {
        if (unfinished && walks.lanes() != 0) {
            query = traverse_alone(scene, rays, test, walks, query);
        }
    }
}

}  // namespace whitted::WHITTED_ISA
