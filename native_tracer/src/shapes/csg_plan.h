// What is worked out of a csg once, for all kernels.

#pragma once

#include <cstdint>
#include <vector>

#include "search/bvh.h"
#include "tracing/description.h"

namespace whitted {

// The surface that a primitive is a piece of. Primitives that are the same but for their sides have the same surface.
struct Side {
    int surface;
    bool reversed;  // its inner side is the surface's outer one
};

// A step of an expression in reverse Polish notation: an operand is pushed, or at once combined with the one below.
struct CsgStep {
    static constexpr int push = 0;  // another operation is one of CsgDescription's
    int leaf;                       // or -1: the operand is there
    int operation;
};

struct CsgPlan {
    // The program. Leaves are used once or more: each use has a number, in order, and steps that begin with it.
    std::vector<CsgStep> steps;
    std::vector<int> first_step;      // of each use, and their number
    std::vector<std::uint64_t> uses;  // of each leaf, a bit each
    std::uint64_t needed = 0;         // uses that make a difference also where the leaf is empty
    std::vector<int> first_piece;     // of each leaf, and their number
    std::vector<int> leaf_of_piece;   // pieces are the leaves' primitives, in order
    std::vector<Side> sides;          // of the pieces
    // A tree over the boxes in which leaves matter, and the leaves outside it; see BoxTest.
    Bvh tree;
    std::vector<int> apart;
    double growth = 1, reach = 0;

    // Not here: kernels must offer no functions to one another, see isa.h.
    CsgPlan();
    CsgPlan(CsgPlan&& other) noexcept;
    ~CsgPlan();
};

// For numbers with so many digits, in bits.
CsgPlan plan_csg(const CsgDescription& csg, int digits);

}  // namespace whitted
