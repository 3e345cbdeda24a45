// Rays: in groups, one to a lane, as they are traced, and one by one, as they wait for it.

#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "tracing/rounding.h"
#include "tracing/vector.h"

namespace whitted::WHITTED_ISA {

template <typename Real>
struct Rays {
    Vector<Lanes<Real>> origin, direction;  // directions are unit vectors
    Lanes<Real> t_min;                      // how far the origin may be off; a hit on anything but `object` is farther
    Indices<Real> object, primitive;        // what the ray starts on; -1: nothing
    Mask<Real> inside;                      // it travels inside `object`
    Lanes<Real> spread;                     // how far the direction may be off, see rounding.h
    Lanes<Real> reach;                      // no coordinate of the origin is larger
    Lanes<Real> time = Real(0);             // from 0 to 1, where something moves
};

// A bound of the rounding error of points found at distance t of their rays, `reach` being their largest coordinate.
// Some thirty operations on numbers of about that size lead to a coordinate, each wrong by half an epsilon at most; 32
// epsilon is twice their sum.
template <typename Real>
Lanes<Real> rounding_error(Lanes<Real> reach, Lanes<Real> t) {
    return Lanes<Real>(32 * input_epsilon<Real>) * (reach + t);
}

// Rays that are traced together, one to a lane. Nobody looks at the lanes that are not active.
template <typename Real>
struct Group {
    Rays<Real> rays;
    Lanes<Real> weight;   // what a ray's colour counts for in its pixel
    Indices<Real> depth;  // bounces before it
    Indices<Real> pixel;
    Indices<Real> record;  // what the observer knows it by
    // In scenes that are sampled: which sample of the pixel the ray belongs to, and its path, see sampler.h.
    Indices<Real> sample, path;
    Mask<Real> active;
};

// Calls visit(field) for all that is known of a group's rays; those of samples only where they are wanted.
template <typename Group, typename Visit>
[[gnu::always_inline]] constexpr void for_each_field(Group& group, bool sampled, Visit visit) {
    for (auto* vector : {&group.rays.origin, &group.rays.direction}) {
        visit(vector->x);
        visit(vector->y);
        visit(vector->z);
    }
    visit(group.rays.t_min);
    visit(group.rays.object);
    visit(group.rays.primitive);
    visit(group.rays.inside);
    visit(group.rays.spread);
    visit(group.weight);
    visit(group.depth);
    visit(group.pixel);
    visit(group.record);
    if (sampled) {
        visit(group.sample);
        visit(group.path);
    }
}

// Rays that wait for their turn: a stack that keeps each field in a row of its own, so that groups enter and leave it
// a register at a time.
template <typename Real>
class RayStack {
 public:
    explicit RayStack(bool sampled) : sampled_(sampled), fields_(sampled ? fields_of(true) : fields_of(false)) {}

    std::size_t size() const { return size_; }
    void clear() { size_ = 0; }

    // Adds the rays of the group that the mask names.
    [[gnu::always_inline]] void push(const Group<Real>& group, Mask<Real> named) {
        reserve(lane_count<Real>);
        Cell* end = cells_.data() + size_;
        for_each_field(group, sampled_, [&](const auto& field) {
            pack(named, field, end);
            end += capacity_;
        });
        size_ += static_cast<std::size_t>(count(named));
    }

    // The rays from `first` on, as many as there are lanes and rays left.
    [[gnu::always_inline]] Group<Real> group(std::size_t first) const {
        Group<Real> group;
        const Cell* from = cells_.data() + first;
        for_each_field(group, sampled_, [&](auto& field) {
            load(from, field);
            from += capacity_;
        });
        group.rays.reach = max_norm(group.rays.origin);
        group.active = Mask<Real>::first(static_cast<int>(std::min<std::size_t>(size_ - first, lane_count<Real>)));
        return group;
    }

    // Moves its last rays, `most` of them or all, to the end of another stack.
    void move_last(std::size_t most, RayStack& to) {
        const std::size_t moved = std::min(most, size_);
        to.reserve(moved);
        size_ -= moved;
        for (std::size_t field = 0; field < fields_; ++field) {
            std::copy_n(cells_.data() + field * capacity_ + size_, moved,
                        to.cells_.data() + field * to.capacity_ + to.size_);
        }
        to.size_ += moved;
    }

 private:
    struct Cell {
        Real value;  // or an integer
    };
    // As many as for_each_field() visits.
    static constexpr std::size_t fields_of(bool sampled) {
        Group<Real> group;
        std::size_t number = 0;
        for_each_field(group, sampled, [&](const auto&) { ++number; });
        return number;
    }

    // Makes room for so many rays, and for a whole group behind them.
    void reserve(std::size_t rays) {
        const std::size_t needed = size_ + rays + lane_count<Real>;
        if (needed <= capacity_) {
            return;
        }
        std::vector<Cell> cells(fields_ * 2 * needed);
        for (std::size_t field = 0; field < fields_; ++field) {
            std::copy_n(cells_.data() + field * capacity_, size_, cells.data() + field * 2 * needed);
        }
        cells_ = std::move(cells);
        capacity_ = 2 * needed;
    }

    const bool sampled_;
    const std::size_t fields_;
    std::vector<Cell> cells_;  // fields x capacity
    std::size_t capacity_ = 0;
    std::size_t size_ = 0;
};

}  // namespace whitted::WHITTED_ISA
