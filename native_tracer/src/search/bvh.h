// A bounding volume hierarchy: a binary tree over axis-aligned boxes, in which a search that passes over what lies
// outside a node's box takes a time that grows about as the logarithm of their number.
//
// Built from the top, by the surface area heuristic: a node is split where the sum over both sides of area times number
// is smallest. Tried are the borders of a few equal bins of the boxes' centres along each axis, and of their sizes: one
// box around all others, say a sky, has its centre among theirs, and would make every node it lies in as large as
// itself. Where that is not finished at a depth that a tree of this size should not need, halves are made instead; so
// the time is n log n, and the depth bounded, whatever the boxes. The same boxes give the same tree anywhere.
//
// Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", Interactive Ray Tracing, 2007.

#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace whitted {

struct Box {
    std::array<double, 3> low, high;
};

struct BvhNode {
    Box box;              // the union of its items' boxes
    std::uint32_t first;  // its items are order[first], ..., order[first + count - 1]
    std::uint32_t count;
    std::uint32_t children = 0;  // the first of its two children, which are neighbours; 0: it is a leaf
    std::uint32_t axis = 0;      // along which the first child lies before the second
};

struct Bvh {
    std::vector<BvhNode> nodes;        // the root first, parents before their children; none if there are no items
    std::vector<std::uint32_t> order;  // of the items; ascending within a leaf
};

// No leaf has more ancestors, so that a search may keep what it has put off in an array.
inline constexpr int bvh_most_depth = 96;

// A leaf holds more than one item, and at most `leaf_size`, where looking at them all is cheaper than a further split.
// Boxes are finite, with low <= high, and fewer than 2^31.
Bvh build_bvh(std::span<const Box> boxes, std::uint32_t leaf_size);

// ---- Threaded trees ---------------------------------------------------------------------------------------------------

// The nodes of a tree with one item in each leaf, in eight orders: those in which a ray meets them from one side, for
// each octant of directions, the one with the number sum of 2^k over k with direction[k] < 0. Each order is its own
// block of 2 n - 1 nodes. In it a search without a stack goes from a node to the next one, or to `skip` of it, counted
// within the block, where the node's box is missed or the node is a leaf; 2 n - 1 is the end.
struct ThreadedBvh {
    std::vector<double> corners;  // of the nodes' boxes, six numbers each, low and high
    std::vector<std::uint32_t> skip;
    std::vector<std::uint32_t> item;  // of a leaf

    static constexpr std::uint32_t no_item = 0xffffffff;
};

ThreadedBvh thread_bvh(const Bvh& tree);

}  // namespace whitted
