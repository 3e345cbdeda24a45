// What rays' passages through the leaves of a csg leave to be known, and the value of its expression along the rays.

#pragma once

#include <limits>

#include "shapes/csg_expression.h"
#include "shapes/csg_plan.h"
#include "tracing/description.h"
#include "tracing/vector.h"

namespace whitted::WHITTED_ISA {

// Through the leaves that some ray may meet, by the order of the leaves.
template <typename Real>
struct CsgPassages {
    using L = Lanes<Real>;

    struct Ends {
        L near, far;
        Indices<Real> near_primitive, far_primitive;
        Mask<Real> inverted;
        L between_primitives;  // the least distance between two of the leaf's own
    };

    Ends ends[most_csg_leaves];
    int leaf[most_csg_leaves];   // whose they are
    int place[most_csg_leaves];  // of those of a leaf that is left, or -1: no ray meets it
    int count;
    ReducedCsg expression;  // without the other leaves

    // The expression's value just behind distance t, and the next distance at which a leaf is met. The stack's top is
    // not in memory: most operands are combined with it at once.
    [[gnu::always_inline]] Mask<Real> value_behind(const L& t, L& next) const {
        const L infinity = std::numeric_limits<Real>::infinity();
        Mask<Real> stack[deepest_csg_stack];
        Mask<Real> top = Mask<Real>::none();
        int size = 0;
        next = infinity;
        for (int i = 0; i < expression.step_count; ++i) {
            const CsgStep& step = expression.steps[i];
            Mask<Real> right = Mask<Real>::none();
            if (step.leaf < 0) {
                right = top;
                top = stack[--size];
            } else if (const int at = place[step.leaf]; at >= 0) {
                const Ends& passage = ends[at];
                const Mask<Real> entered = passage.near <= t;
                const Mask<Real> not_left = t < passage.far;
                right = (entered & not_left) ^ passage.inverted;
                next = min(select(entered, infinity, passage.near), next);
                next = min(select(not_left, passage.far, infinity), next);
            }
            if (step.operation == CsgStep::push) {
                stack[size++] = top;
                top = right;
            } else {
                top = apply(step.operation, top, right);
            }
        }
        return top;
    }
};

}  // namespace whitted::WHITTED_ISA
