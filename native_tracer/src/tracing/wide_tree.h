// The search of a tree by rays that are alone.
//
// Rays that have lost their coherence soon have a node almost to themselves, and a group that visits it for one of them
// wastes its other lanes. Such rays go on alone, each through a tree with as many children to a node as there are
// lanes, whose boxes are tested at once.
//
// Wald, Benthin and Boulos, "Getting Rid of Packets: Efficient SIMD Single-Ray Traversal using Multi-branching BVHs",
// Interactive Ray Tracing, 2008. Benthin, Wald, Woop, Ernst and Mark, "Combining Single and Packet-Ray Tracing for
// Arbitrary Ray Distributions on the Intel MIC Architecture", IEEE Transactions on Visualization and Computer Graphics
// 18(9), 2012. Ylitie, Karras and Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs",
// High Performance Graphics, 2017.

#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "search/search.h"
#include "search/wide.h"
#include "shapes/shape_lists.h"
#include "tracing/box_test.h"
#include "tracing/vector.h"
#include "tracing/walks.h"

namespace whitted::WHITTED_ISA {

// Boxes of a node's children, a lane each. Trees of many objects do not fit into the processor's caches: corners are
// bytes, in steps from the lowest of all. A step is a power of two, so that only the sum is rounded, the same way
// wherever it is computed.
template <typename Real>
class ByteBoxes {
 public:
    using C = Coarse<Real>;
    using Number = typename C::Number;

    // Each holds one of these; those of other lanes are any.
    void put(const CoarseBox<Real>* boxes, int count) {
        for (int k = 0; k < 3; ++k) {
            Number highest = boxes[0].high[k];
            corner_[k] = boxes[0].low[k];
            for (int i = 1; i < count; ++i) {
                corner_[k] = std::min(corner_[k], boxes[i].low[k]);
                highest = std::max(highest, boxes[i].high[k]);
            }
            const Number size = std::max(highest - corner_[k], std::numeric_limits<Number>::min());
            step_[k] = std::ldexp(Number(1), std::max(std::ilogb(size) - 8, std::numeric_limits<Number>::min_exponent));
            while (at(k, most) < highest) {
                step_[k] *= 2;
            }
            for (int i = 0; i < count; ++i) {
                int low = steps_to(k, boxes[i].low[k]);
                int high = steps_to(k, boxes[i].high[k]);
                low -= at(k, low) > boxes[i].low[k];
                high += at(k, high) < boxes[i].high[k];
                low_[k][i] = static_cast<unsigned char>(low);
                high_[k][i] = static_cast<unsigned char>(high);
            }
        }
    }

    [[gnu::always_inline]] CoarseBoxes<Real> all() const {
        CoarseBoxes<Real> result;
        for (int k = 0; k < 3; ++k) {
            result.low[k] = multiply_subtract(C::of_bytes(low_[k]), C(step_[k]), C(-corner_[k]));
            result.high[k] = multiply_subtract(C::of_bytes(high_[k]), C(step_[k]), C(-corner_[k]));
        }
        return result;
    }

 private:
    static constexpr int most = 255;

    Number at(int k, int steps) const { return corner_[k] + static_cast<Number>(steps) * step_[k]; }
    int steps_to(int k, Number place) const {
        return std::min(static_cast<int>((place - corner_[k]) / step_[k]), most);
    }

    Number corner_[3], step_[3];
    unsigned char low_[3][lane_count<Real>] = {}, high_[3][lane_count<Real>] = {};
};

template <typename Real>
class WideTree {
 public:
    using C = Coarse<Real>;
    using Number = typename C::Number;
    static constexpr int width = lane_count<Real>;

    // Its nodes are some of the binary tree's: put_node(node, here) is told which, of those where rays may leave.
    // shape_of(item) says where the shape of an object is.
    template <typename ShapeOf, typename PutNode>
    void build(const SearchPlan& plan, const BoxSpace<Real>& space, ShapeOf shape_of, PutNode put_node) {
        if (width > 1 && !plan.tree.nodes.empty()) {
            int levels;
            add(plan, space, 0, shape_of, put_node, levels);
        }
    }

    // Goes on with rays that have left their group. Again and again each of them comes to the next shape whose box it
    // enters before its limit, nearer ones about before those farther away, and meet(lanes, shapes) is called for the
    // lanes that have one, until it returns false. It may lower `limit`. The rays take turns from node to node, so that
    // the processor need not wait for one to know what to do for the others. fetch(shape) may begin to load a shape
    // that a ray will come to.
    template <typename Meet, typename Fetch>
    [[gnu::always_inline]] void walk(const BoxTest<Real>& test, Walks<Real>& walks, const Lanes<Real>& limit, Meet meet,
                                     Fetch fetch) const {
        int met[width];
        walks.begin();
        for (unsigned walking = walks.lanes(); walking != 0;) {
            const C bounds = test.bound(limit);
            unsigned meeting = 0;
            while (walking != 0) {
                for (unsigned lanes = walking; lanes != 0; lanes &= lanes - 1) {
                    const int lane = std::countr_zero(lanes);
                    const Number bound = bounds[lane];
                    const int child = walks.next(lane, bound);
                    if (child >= 0) {
                        enter(nodes_[static_cast<std::size_t>(child)], test, lane, bound, walks, fetch);
                        continue;
                    }
                    walking &= ~(1U << lane);
                    if (child != Walks<Real>::none) {
                        meeting |= 1U << lane;
                        met[lane] = child;
                    }
                }
            }
            if (meeting == 0 || !meet(meeting, met)) {
                return;
            }
            walking = meeting;
        }
    }

    // That a child is, or meet() is called with.
    static ShapeIndex shape_at(int child) {
        const auto number = static_cast<unsigned>(-1 - child);
        return {number & ((1U << kind_bits) - 1), number >> kind_bits};
    }

 private:
    static constexpr unsigned kind_bits = 3;
    static int child_of(ShapeIndex shape) {
        return -1 -
               static_cast<int>(static_cast<unsigned>(shape.index) << kind_bits | static_cast<unsigned>(shape.kind));
    }

    struct alignas(64) Node {
        ByteBoxes<Real> boxes;
        int count;
        int child[width];  // a node, or a shape, which is negative
    };

    template <typename Fetch>
    [[gnu::always_inline]] void enter(const Node& node, const BoxTest<Real>& test, int lane, Number bound,
                                      Walks<Real>& walks, Fetch fetch) const {
        C since;
        test.alone(lane)(node.boxes.all(), C(bound), since);
        const int next = walks.put(lane, since, bound, node.child, node.count);
        if (next >= 0) {
            const char* there = reinterpret_cast<const char*>(&nodes_[static_cast<std::size_t>(next)]);
            for (std::size_t line = 0; line < sizeof(Node); line += 64) {
                __builtin_prefetch(there + line);
            }
        } else if (next != Walks<Real>::none) {
            fetch(shape_at(next));
        }
    }

    // Returns the number of the node that is made of the one `from`, and how many levels of nodes it has.
    template <typename ShapeOf, typename PutNode>
    int add(const SearchPlan& plan, const BoxSpace<Real>& space, std::uint32_t from, ShapeOf& shape_of,
            PutNode& put_node, int& levels) {
        WideChild children[width];
        const int count = collapse(plan, from, width, children);
        const std::size_t index = nodes_.size();
        nodes_.emplace_back();
        CoarseBox<Real> boxes[width];
        int child[width] = {};
        levels = 1;
        for (int i = 0; i < count; ++i) {
            boxes[i] = space.box(children[i].box);
            if (children[i].is_item) {
                child[i] = child_of(shape_of(plan.tree.order[children[i].index]));
                continue;
            }
            int below;
            child[i] = add(plan, space, children[i].index, shape_of, put_node, below);
            levels = std::max(levels, below + 1);
        }
        if (levels <= Walks<Real>::most_levels) {
            put_node(from, static_cast<int>(index));
        }
        Node& node = nodes_[index];
        node.boxes.put(boxes, count);
        node.count = count;
        std::copy_n(child, width, node.child);
        return static_cast<int>(index);
    }

    std::vector<Node> nodes_;
};

}  // namespace whitted::WHITTED_ISA
