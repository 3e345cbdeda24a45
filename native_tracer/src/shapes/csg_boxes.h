// Which leaves of a csg rays may meet, by a tree over the boxes in which leaves matter.

#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "search/bvh.h"
#include "shapes/csg_plan.h"
#include "tracing/box_test.h"
#include "tracing/coarse.h"
#include "tracing/description.h"
#include "tracing/ray.h"
#include "tracing/vector.h"

namespace whitted::WHITTED_ISA {

template <typename Real>
class CsgBoxes {
 public:
    explicit CsgBoxes(const CsgPlan& plan) : space_(plan.tree, plan.growth, plan.reach) {
        for (const BvhNode& node : plan.tree.nodes) {
            nodes_.push_back({space_.box(node.box), static_cast<int>(node.children), static_cast<int>(node.first),
                              static_cast<int>(node.first + node.count)});
        }
    }

    // The uses of the leaves that some ray may meet before its limit, a bit each; `plan` is the one it is made of.
    std::uint64_t uses_met(const CsgPlan& plan, const Rays<Real>& rays, const Lanes<Real>& limit) const {
        std::uint64_t met = 0;
        for (const int leaf : plan.apart) {
            met |= plan.uses[static_cast<std::size_t>(leaf)];
        }
        if (nodes_.empty()) {
            return met;
        }
        const BoxTest<Real> test(rays, space_);
        const Coarse<Real> bound = test.bound(limit);
        int waiting[most_csg_leaves];
        int depth = 0;
        waiting[depth++] = 0;
        while (depth > 0) {
            const Node& node = nodes_[static_cast<std::size_t>(waiting[--depth])];
            Coarse<Real> since;
            if (!test(node.box, bound, since)) {
                continue;
            }
            if (node.children != 0) {
                waiting[depth++] = node.children;
                waiting[depth++] = node.children + 1;
                continue;
            }
            for (int i = node.first; i < node.end; ++i) {
                met |= plan.uses[plan.tree.order[static_cast<std::size_t>(i)]];
            }
        }
        return met;
    }

 private:
    struct Node {
        CoarseBox<Real> box;
        int children;  // the first of two neighbours; 0: it holds the leaves of the tree's order from first to end
        int first, end;
    };

    BoxSpace<Real> space_;
    std::vector<Node> nodes_;
};

}  // namespace whitted::WHITTED_ISA
