// The search of a tree over boxes by a group of rays.
//
// A box is tested so that no hit is lost which a test of its objects themselves would find, with all its rounding
// errors: it is widened by a bound of those, which is relative to the coordinates at hand.

#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "search/search.h"
#include "shapes/shapes.h"
#include "tracing/ray.h"
#include "tracing/rounding.h"
#include "tracing/vector.h"

namespace whitted::WHITTED_ISA {

template <typename Real>
struct TreeNode {
    Vector<Real> low, high;
    int children;                          // the first of two neighbours; 0: it is a leaf
    int axis;                              // along which the first child lies before the second
    typename Shapes<Real>::Ranges shapes;  // of a leaf
};

// Where rays are in boxes: all that does not depend on the box.
template <typename Real>
class BoxTest {
 public:
    using L = Lanes<Real>;

    // Objects are found with errors of some 20 epsilon times the coordinates, of the ray's origin or their own, that
    // take part; planes that meet at sharp angles multiply them by up to `growth`. An origin may itself lie outside the
    // object that it is on, by less than t_min.
    BoxTest(const Rays<Real>& rays, Real growth, Real reach) {
        // Boxes are wider still, for what ties with a hit has to be come to, from wherever the ray may lead; nothing in
        // the tree is as far away as twice the sum of both reaches.
        const L both = rays.reach + L(reach);
        const L error = L(std::max(32 * std::numeric_limits<Real>::epsilon(), 4096 * tie_epsilon<Real>)) * both;
        L off = error + rays.t_min;
        if constexpr (decides_ties<Real>) {
            off = off + L(Real(4)) * both * rays.spread;
        }
        const L margin = L(growth) * off;
        const Vector<L> margins{margin, margin, margin};
        before_ = rays.origin + margins;
        behind_ = rays.origin - margins;
        inverse_ = {inverse(rays.direction.x), inverse(rays.direction.y), inverse(rays.direction.z)};
    }

    // The rays that are in the box somewhere between their origin and `limit`, and since when.
    [[gnu::always_inline]] Mask<Real> operator()(const TreeNode<Real>& node, L limit, L& since) const {
        L enter = Real(0);
        L leave = limit;
        clip(L(node.low.x), L(node.high.x), before_.x, behind_.x, inverse_.x, enter, leave);
        clip(L(node.low.y), L(node.high.y), before_.y, behind_.y, inverse_.y, enter, leave);
        clip(L(node.low.z), L(node.high.z), before_.z, behind_.z, inverse_.z, enter, leave);
        since = enter;
        return enter <= leave;
    }

 private:
    // Never infinite, so that no product with it is 0 times infinity.
    static L inverse(L slope) {
        const L least = std::numeric_limits<Real>::min();
        return L(Real(1)) / select(abs(slope) < least, least, slope);
    }

    [[gnu::always_inline]] static void clip(L low, L high, L before, L behind, L inverse, L& enter, L& leave) {
        const L one = (low - before) * inverse;
        const L other = (high - behind) * inverse;
        enter = max(enter, min(one, other));
        leave = min(leave, max(one, other));
    }

    Vector<L> before_, behind_;  // the origin, so moved that boxes need not be widened
    Vector<L> inverse_;
};

template <typename Real>
class Tree {
 public:
    using L = Lanes<Real>;

    // Without its leaves' shapes, which are put into its nodes afterwards.
    explicit Tree(const SearchPlan& plan)
        : growth_(static_cast<Real>(plan.growth)), reach_(static_cast<Real>(plan.reach)) {
        nodes_.reserve(plan.tree.nodes.size());
        for (const BvhNode& node : plan.tree.nodes) {
            const auto corner = [](const std::array<double, 3>& p) {
                return Vector<Real>{static_cast<Real>(p[0]), static_cast<Real>(p[1]), static_cast<Real>(p[2])};
            };
            nodes_.push_back({corner(node.box.low),
                              corner(node.box.high),
                              static_cast<int>(node.children),
                              static_cast<int>(node.axis),
                              {}});
        }
    }

    bool empty() const { return nodes_.empty(); }
    TreeNode<Real>& operator[](std::size_t node) { return nodes_[node]; }

    // Calls visit(leaf) for the leaves that rays enter before `limit`, about in the order in which they do, until it
    // returns false. It may lower `limit`.
    template <typename Visit>
    [[gnu::always_inline]] void for_each_leaf(const Rays<Real>& rays, const L& limit, Visit visit) const {
        if (nodes_.empty()) {
            return;
        }
        const BoxTest<Real> enters(rays, growth_, reach_);
        // Most rays decide which of two children comes first.
        const int most = lane_count<Real> / 2;
        const L zero = Real(0);
        const bool backward[3] = {count(rays.direction.x < zero) > most, count(rays.direction.y < zero) > most,
                                  count(rays.direction.z < zero) > most};
        struct Waiting {
            L since;  // infinite for rays that miss it
            int node;
        };
        Waiting waiting[bvh_most_depth];
        int depth = 0;
        L since;
        if (!any(enters(nodes_[0], limit, since))) {
            return;
        }
        for (int index = 0;;) {
            const TreeNode<Real>& node = nodes_[static_cast<std::size_t>(index)];
            if (node.children != 0) {
                const bool swapped = backward[node.axis];
                const int near = node.children + (swapped ? 1 : 0);
                const int far = node.children + (swapped ? 0 : 1);
                L since_far;
                const bool any_near = any(enters(nodes_[static_cast<std::size_t>(near)], limit, since));
                const Mask<Real> far_rays = enters(nodes_[static_cast<std::size_t>(far)], limit, since_far);
                if (any(far_rays)) {
                    if (!any_near) {
                        index = far;
                        continue;
                    }
                    waiting[depth++] = {select(far_rays, since_far, L(std::numeric_limits<Real>::infinity())), far};
                }
                if (any_near) {
                    index = near;
                    continue;
                }
            } else if (!visit(node)) {
                return;
            }
            do {
                if (depth == 0) {
                    return;
                }
                --depth;
            } while (!any(waiting[depth].since <= limit));
            index = waiting[depth].node;
        }
    }

 private:
    std::vector<TreeNode<Real>> nodes_;
    Real growth_, reach_;
};

}  // namespace whitted::WHITTED_ISA
