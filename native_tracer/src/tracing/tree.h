// The search of a tree over boxes by a group of rays.

#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "search/search.h"
#include "shapes/shapes.h"
#include "tracing/box_test.h"
#include "tracing/ray.h"
#include "tracing/vector.h"
#include "tracing/wide_tree.h"

namespace whitted::WHITTED_ISA {

template <typename Real>
class Tree {
 public:
    // Rays leave at a node of so many items that no more of them enter: else it is faster to stay, and always without
    // AVX-512, for its lanes and its instruction that packs them. Measured on sphereflakes of 91 to 66,431 balls and on
    // 1,000 polyhedra.
    static constexpr bool leaving_pays = Coarse<Real>::R::lanes >= 16;
    static constexpr std::uint32_t least_items = 3 * lane_count<Real>;
    static constexpr int most_alone = lane_count<Real> / 4;

    using L = Lanes<Real>;
    using Leaf = typename Shapes<Real>::Ranges;

    // Without its leaves' shapes, which are put into its nodes afterwards.
    explicit Tree(const SearchPlan& plan) : space_(plan.tree, plan.growth, plan.reach) {
        nodes_.reserve(plan.tree.nodes.size());
        for (const BvhNode& node : plan.tree.nodes) {
            nodes_.push_back({space_.box(node.box), static_cast<int>(node.children), node.axis & 3U, none});
        }
    }

    bool empty() const { return nodes_.empty(); }
    void put_leaf(std::size_t node, const Leaf& leaf) {
        nodes_[node].other = static_cast<unsigned>(leaves_.size()) & none;
        leaves_.push_back(leaf);
    }

    // To be called when all leaves are put into it: shape_of(item) says where the shape of an object is.
    template <typename ShapeOf>
    void finish(const SearchPlan& plan, ShapeOf shape_of) {
        if (!leaving_pays && !plan.forced) {
            return;
        }
        wide_.build(plan, space_, shape_of, [&](std::uint32_t node, int here) {
            if (nodes_[node].children != 0 && plan.tree.nodes[node].count >= least_items) {
                nodes_[node].other = static_cast<unsigned>(here) & none;
            }
        });
    }

    BoxTest<Real> test(const Rays<Real>& rays) const { return BoxTest<Real>(rays, space_); }
    const WideTree<Real>& wide() const { return wide_; }

    // Calls visit(leaf) for the leaves that rays enter before `limit`, about in the order in which they do, until it
    // returns false, and returns false then. It may lower `limit`. Rays that have a node almost to themselves leave
    // there, if they may: what is below is left to their walks.
    template <bool may_leave, typename Visit>
    [[gnu::always_inline]] bool for_each_leaf(const Rays<Real>& rays, const BoxTest<Real>& test, const L& limit,
                                              Walks<Real>& walks, Visit visit) const {
        using C = Coarse<Real>;
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
            return true;
        }
        for (int index = 0;;) {
            const Node& node = nodes_[static_cast<std::size_t>(index)];
            if (may_leave && node.children != 0 && node.other != none &&
                leave(since, bound, static_cast<int>(node.other), walks)) {
                // The rest is theirs.
            } else if (node.children != 0) {
                const bool swapped = backward[node.axis];
                const int near = node.children + (swapped ? 1 : 0);
                const int far = node.children + (swapped ? 0 : 1);
                C since_far;
                const bool any_near = test(nodes_[static_cast<std::size_t>(near)].box, bound, since);
                const bool any_far = test(nodes_[static_cast<std::size_t>(far)].box, bound, since_far);
                if (any_far) {
                    if (!any_near) {
                        index = far;
                        since = since_far;
                        continue;
                    }
                    waiting[depth++] = {since_far, far};
                }
                if (any_near) {
                    index = near;
                    continue;
                }
            } else {
                if (!visit(leaves_[static_cast<std::size_t>(node.other)])) {
                    return false;
                }
                bound = test.bound(limit);
            }
            do {
                if (depth == 0) {
                    return true;
                }
                --depth;
            } while (!any_less_equal(waiting[depth].since, bound));
            index = waiting[depth].node;
            since = waiting[depth].since;
        }
    }

 private:
    // Whether all rays that enter a node leave their group.
    static bool leave(const Coarse<Real>& since, const Coarse<Real>& bound, int wide, Walks<Real>& walks) {
        const unsigned entering = bits_less_equal(since, bound);
        if (std::popcount(entering) > most_alone || !walks.have_room(entering)) {
            return false;
        }
        for (unsigned lanes = entering; lanes != 0; lanes &= lanes - 1) {
            const int lane = std::countr_zero(lanes);
            walks.leave(lane, since[lane], wide);
        }
        return true;
    }

    static constexpr unsigned none = (1U << 30U) - 1U;

    struct Node {
        CoarseBox<Real> box;
        int children;         // the first of two neighbours; 0: it is a leaf
        unsigned axis : 2;    // along which the first child lies before the second
        unsigned other : 30;  // the number of the leaf, or of the same node in the wide tree, if there is one
    };

    std::vector<Node> nodes_;
    std::vector<Leaf> leaves_;
    BoxSpace<Real> space_;
    WideTree<Real> wide_;
};

}  // namespace whitted::WHITTED_ISA
