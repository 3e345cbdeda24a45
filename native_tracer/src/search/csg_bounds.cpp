#include <algorithm>
#include <cstddef>
#include <variant>
#include <vector>

#include "search/bounds.h"

namespace whitted {

namespace {

using Found = std::optional<Bounds>;

// How much a computation is off is the same as for the shapes that the box is made of.
Bounds combined(const Bounds& a, const Bounds& b) {
    return {{}, std::max(a.growth, b.growth), std::max(a.reach, b.reach)};
}

Found united(const Found& a, const Found& b) {
    if (!a || !b) {
        return std::nullopt;
    }
    Bounds result = combined(*a, *b);
    for (std::size_t k = 0; k < 3; ++k) {
        result.box.low[k] = std::min(a->box.low[k], b->box.low[k]);
        result.box.high[k] = std::max(a->box.high[k], b->box.high[k]);
    }
    return result;
}

Found intersected(const Found& a, const Found& b) {
    if (!a || !b) {
        return a ? a : b;
    }
    Bounds result = combined(*a, *b);
    for (std::size_t k = 0; k < 3; ++k) {
        result.box.low[k] = std::max(a->box.low[k], b->box.low[k]);
        result.box.high[k] = std::min(a->box.high[k], b->box.high[k]);
        if (result.box.low[k] > result.box.high[k]) {
            return a;  // there is nothing in it, which a box cannot say
        }
    }
    return result;
}

}  // namespace

std::optional<Bounds> bounds_of(const CsgDescription& csg) {
    std::vector<Found> stack;
    for (const int step : csg.program) {
        if (step >= 0) {
            stack.push_back(std::visit([](const auto& leaf) { return bounds_of(leaf); },
                                       csg.leaves[static_cast<std::size_t>(step)]));
            continue;
        }
        const Found right = stack.back();
        stack.pop_back();
        Found& left = stack.back();
        if (step == CsgDescription::unite) {
            left = united(left, right);
        } else if (step == CsgDescription::intersect) {
            left = intersected(left, right);
        }
    }
    return stack.back();
}

double cost_of(const CsgDescription& csg) {
    double cost = 0;
    for (const LeafDescription& leaf : csg.leaves) {
        cost += 2 * std::visit([](const auto& primitive) { return cost_of(primitive); }, leaf);
    }
    return cost;
}

}  // namespace whitted
