// The search of a tree over boxes by a group of rays.

#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "search/search.h"
#include "shapes/shapes.h"
#include "tracing/box_test.h"
#include "tracing/ray.h"
#include "tracing/vector.h"

namespace whitted::WHITTED_ISA {

template <typename Real>
struct TreeNode {
    Vector<Real> low, high;
    int children;                          // the first of two neighbours; 0: it is a leaf
    int axis;                              // along which the first child lies before the second
    typename Shapes<Real>::Ranges shapes;  // of a leaf
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
        const BoxTest<Real> test(rays, growth_, reach_);
        const auto enters = [&](const TreeNode<Real>& node, L until, L& since)
                                __attribute__((always_inline)) { return test(node.low, node.high, until, since); };
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
