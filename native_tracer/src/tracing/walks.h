// Where rays that have left their group are in their search of a tree: for each, what it has yet to visit.

#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <limits>

#include "tracing/coarse.h"
#include "tracing/lanes.h"

namespace whitted::WHITTED_ISA {

template <typename Real>
class Walks {
 public:
    using C = Coarse<Real>;
    using Number = typename C::Number;
    static constexpr int width = lane_count<Real>;  // of the tree, see WideTree
    static constexpr int most_levels = 8;           // of its nodes, below one where rays leave
    static constexpr int none = std::numeric_limits<int>::min();

    // The lanes of rays that have left, a bit each.
    unsigned lanes() const { return lanes_; }

    // Whether one more node can be noted for these lanes.
    bool have_room(unsigned lanes) const {
        bool room = true;
        for (; lanes != 0; lanes &= lanes - 1) {
            room &= depth_[std::countr_zero(lanes)] < most_left;
        }
        return room;
    }

    // A ray leaves at a node, which it enters at the distance `since`.
    void leave(int lane, Number since, int node) {
        lanes_ |= 1U << lane;
        since_[lane][depth_[lane]] = since;
        child_[lane][depth_[lane]++] = node;
    }

    // After the last has left: they go on where they left first.
    void begin() {
        for (unsigned left = lanes_; left != 0; left &= left - 1) {
            const int lane = std::countr_zero(left);
            std::reverse(since_[lane], since_[lane] + depth_[lane]);
            std::reverse(child_[lane], child_[lane] + depth_[lane]);
        }
    }

    // What the ray visits next, of what it enters before `bound`; or none.
    int next(int lane, Number bound) {
        while (depth_[lane] > 0) {
            const int last = --depth_[lane];
            if (since_[lane][last] <= bound) {
                return child_[lane][last];
            }
        }
        return none;
    }

    // Puts those of a node's `count` children first that the ray enters before `bound`, without a branch for each, and
    // returns the very first of all, or none.
    [[gnu::always_inline]] int put(int lane, const C& since, Number bound, const int* children, int count) {
        using R = typename C::R;
        const C bounds = bound;
        for (int i = 0; i < width / R::lanes; ++i) {
            const typename R::Truths in_time = R::less_equal(since.value[i], bounds.value[i]);
            const typename R::Truths is_child = R::less(numbers() + i * R::lanes, typename R::Integers{} + count);
            const typename R::Truths entered = in_time & is_child;
            typename R::Integers numbers;
            load(children + i * R::lanes, numbers);
            R::pack(entered, since.value[i], since_[lane] + depth_[lane]);
            R::pack(entered, numbers, child_[lane] + depth_[lane]);
            depth_[lane] += std::popcount(R::bits(entered));
        }
        return depth_[lane] == 0 ? none : child_[lane][depth_[lane] - 1];
    }

 private:
    static constexpr int most_left = 16;
    // Each level leaves the others of a node's children, and room for a register is needed behind the last.
    static constexpr int most = most_left + (most_levels + 1) * width;

    // 0, 1, 2 and so on.
    static auto numbers() {
        typename C::R::Integers result{};
        if constexpr (C::R::lanes > 1) {
            for (int i = 0; i < C::R::lanes; ++i) {
                result[i] = i;
            }
        }
        return result;
    }

    unsigned lanes_ = 0;
    int depth_[width] = {};
    Number since_[width][most];
    int child_[width][most];
};

}  // namespace whitted::WHITTED_ISA
