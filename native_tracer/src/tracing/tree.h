// The search of a tree over boxes by a group of rays.

#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "search/search.h"
#include "shapes/shapes.h"
#include "tracing/box_test.h"
#include "tracing/ray.h"
#include "tracing/vector.h"

namespace whitted::WHITTED_ISA {

template <typename Real>
class Tree {
 public:
    using L = Lanes<Real>;
    using Leaf = typename Shapes<Real>::Ranges;

    // Without its leaves' shapes, which are put into its nodes afterwards.
    explicit Tree(const SearchPlan& plan) : space_(plan.tree, plan.growth, plan.reach) {
        nodes_.reserve(plan.tree.nodes.size());
        for (const BvhNode& node : plan.tree.nodes) {
            nodes_.push_back({space_.box(node.box), static_cast<int>(node.children), static_cast<int>(node.axis)});
        }
    }

    bool empty() const { return nodes_.empty(); }
    void put_leaf(std::size_t node, const Leaf& leaf) {
        nodes_[node].axis_or_leaf = static_cast<int>(leaves_.size());
        leaves_.push_back(leaf);
    }

    // Calls visit(leaf) for the leaves that rays enter before `limit`, about in the order in which they do, until it
    // returns false. It may lower `limit`.
    template <typename Visit>
    [[gnu::always_inline]] void for_each_leaf(const Rays<Real>& rays, const L& limit, Visit visit) const {
        if (nodes_.empty()) {
            return;
        }
        using C = Coarse<Real>;
        const BoxTest<Real> test(rays, space_);
        // Most rays decide which of two children comes first.
        const int most = lane_count<Real> / 2;
        const L zero = Real(0);
        const bool backward[3] = {count(rays.direction.x < zero) > most, count(rays.direction.y < zero) > most,
                                  count(rays.direction.z < zero) > most};
        struct Waiting {
            C since;  // infinite for rays that miss it
            int node;
        };
        Waiting waiting[bvh_most_depth];
        int depth = 0;
        C since;
        C bound = test.bound(limit);
        if (!test(nodes_[0].box, bound, since)) {
            return;
        }
        for (int index = 0;;) {
            const Node& node = nodes_[static_cast<std::size_t>(index)];
            if (node.children != 0) {
                const bool swapped = backward[node.axis_or_leaf];
                const int near = node.children + (swapped ? 1 : 0);
                const int far = node.children + (swapped ? 0 : 1);
                C since_far;
                const bool any_near = test(nodes_[static_cast<std::size_t>(near)].box, bound, since);
                const bool any_far = test(nodes_[static_cast<std::size_t>(far)].box, bound, since_far);
                if (any_far) {
                    if (!any_near) {
                        index = far;
                        continue;
                    }
                    waiting[depth++] = {since_far, far};
                }
                if (any_near) {
                    index = near;
                    continue;
                }
            } else {
                if (!visit(leaves_[static_cast<std::size_t>(node.axis_or_leaf)])) {
                    return;
                }
                bound = test.bound(limit);
            }
            do {
                if (depth == 0) {
                    return;
                }
                --depth;
            } while (!any_less_equal(waiting[depth].since, bound));
            index = waiting[depth].node;
        }
    }

 private:
    struct Node {
        CoarseBox<Real> box;
        int children;      // the first of two neighbours; 0: it is a leaf
        int axis_or_leaf;  // along which the first child lies before the second, or the number of the leaf
    };

    std::vector<Node> nodes_;
    std::vector<Leaf> leaves_;
    BoxSpace<Real> space_;
};

}  // namespace whitted::WHITTED_ISA
