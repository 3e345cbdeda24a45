// The Boolean expression of a csg: its value, and what is left of it without leaves that are empty.

#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "shapes/csg_plan.h"
#include "tracing/description.h"
#include "tracing/isa.h"

namespace whitted::WHITTED_ISA {

// What an operation makes of two operands: truth values, in as many bits or lanes as they have.
template <typename Truths>
[[gnu::always_inline]] inline Truths apply(int operation, Truths left, Truths right) {
    return operation == CsgDescription::unite      ? left | right
           : operation == CsgDescription::subtract ? left & ~right
                                                   : left & right;
}

// The expression's value inside these leaves, a bit each. Its stack is the bits of a number.
inline bool value_inside(const CsgPlan& plan, std::uint64_t leaves) {
    std::uint64_t stack = 0;
    for (const CsgStep& step : plan.steps) {
        const std::uint64_t right = (step.leaf >= 0 ? leaves >> step.leaf : stack) & 1;
        stack >>= step.leaf >= 0 ? 0 : 1;
        if (step.operation == CsgStep::push) {
            stack = stack << 1 | right;
            continue;
        }
        stack = stack >> 1 << 1 | apply(step.operation, stack & 1, right);
    }
    return stack != 0;
}

// What is left of an expression.
struct ReducedCsg {
    CsgStep steps[2 * most_csg_leaves];
    int step_count;

    // The leaves that are left, a bit each.
    std::uint64_t leaves() const {
        std::uint64_t result = 0;
        for (int i = 0; i < step_count; ++i) {
            if (steps[i].leaf >= 0) {
                result |= std::uint64_t(1) << steps[i].leaf;
            }
        }
        return result;
    }
};

// Leaves out of the expression the leaves that no ray meets: they are empty, and so may be what they are part of. `met`
// are the uses of the others, a bit each.
inline void reduce(const CsgPlan& plan, std::uint64_t met, ReducedCsg& reduced) {
    constexpr int empty = -1;
    int stack[deepest_csg_stack];  // where each operand begins
    int size = 0;
    int end = 0;
    for (std::uint64_t uses = met | plan.needed; uses != 0; uses &= uses - 1) {
        const auto use = static_cast<std::size_t>(std::countr_zero(uses));
        const bool is_met = (met >> use & 1) != 0;
        for (int i = plan.first_step[use]; i < plan.first_step[use + 1]; ++i) {
            const CsgStep& step = plan.steps[static_cast<std::size_t>(i)];
            const bool is_leaf = step.leaf >= 0;
            const int right = !is_leaf ? stack[--size] : is_met ? end : empty;
            if (step.operation == CsgStep::push) {
                stack[size++] = right;
                reduced.steps[end] = step;
                end += is_met;
                continue;
            }
            int& left = stack[size - 1];
            if (left != empty && right != empty) {
                reduced.steps[end++] = step;
            } else if (step.operation == CsgDescription::unite) {
                if (right != empty && is_leaf) {
                    reduced.steps[end++] = {step.leaf, CsgStep::push};
                }
                left = std::max(left, right);
            } else if (step.operation == CsgDescription::intersect || left == empty) {
                const int operand = std::max(left, right);
                end = operand == empty ? end : operand;
                left = empty;
            }
        }
    }
    reduced.step_count = end;
}

}  // namespace whitted::WHITTED_ISA
