#include "shapes/csg_plan.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <variant>

#include "search/search.h"

namespace whitted {

namespace {

using Row = std::vector<double>;

// The numbers of a leaf's surfaces, the same for all that describe the same surface, or those with all signs turned.
// A ball is never inside out: a last number, which keeps its sign, tells.
std::vector<Row> surfaces_of(const LeafDescription& leaf) {
    if (const auto* sphere = std::get_if<SphereDescription>(&leaf)) {
        return {{sphere->center[0], sphere->center[1], sphere->center[2], sphere->radius, 1}};
    }
    if (const auto* quadric = std::get_if<QuadricDescription>(&leaf)) {
        return {Row(quadric->coefficients.begin(), quadric->coefficients.end())};
    }
    std::vector<Row> rows;
    for (const Quadruple& plane : std::get<PolyhedronDescription>(leaf).planes) {
        // Of any length: by a power of two, so that the same planes stay the same.
        const int exponent = std::ilogb(std::max({std::abs(plane[0]), std::abs(plane[1]), std::abs(plane[2])}));
        Row row;
        for (const double number : plane) {
            row.push_back(std::scalbn(number, -exponent));
        }
        rows.push_back(row);
    }
    return rows;
}

bool same(const Row& a, const Row& b, double sign) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](double x, double y) { return x == sign * y; });
}

std::vector<Side> sides_of(const std::vector<Row>& surfaces) {
    std::vector<Side> sides;
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
        Side side{static_cast<int>(i), false};
        for (std::size_t k = 0; k < i; ++k) {
            if (same(surfaces[i], surfaces[k], 1)) {
                side = sides[k];
                break;
            }
            if (same(surfaces[i], surfaces[k], -1)) {
                side = {sides[k].surface, !sides[k].reversed};
                break;
            }
        }
        sides.push_back(side);
    }
    return sides;
}

void add_steps(const CsgDescription& csg, CsgPlan& plan) {
    plan.uses.resize(csg.leaves.size());
    for (std::size_t i = 0; i < csg.program.size(); ++i) {
        const int step = csg.program[i];
        if (step < 0) {
            plan.steps.push_back({-1, step});
            plan.needed |= std::uint64_t(1) << (plan.first_step.size() - 1);
            continue;
        }
        const std::uint64_t use = std::uint64_t(1) << plan.first_step.size();
        plan.uses[static_cast<std::size_t>(step)] |= use;
        plan.first_step.push_back(static_cast<int>(plan.steps.size()));
        const bool is_combined = i > 0 && i + 1 < csg.program.size() && csg.program[i + 1] < 0;
        const int operation = is_combined ? csg.program[++i] : CsgStep::push;
        plan.steps.push_back({step, operation});
        if (operation == CsgStep::push || operation == CsgDescription::intersect) {
            plan.needed |= use;
        }
    }
    plan.first_step.push_back(static_cast<int>(plan.steps.size()));
}

}  // namespace

CsgPlan::CsgPlan() = default;
CsgPlan::CsgPlan(CsgPlan&& other) noexcept = default;
CsgPlan::~CsgPlan() = default;

CsgPlan plan_csg(const CsgDescription& csg, int digits) {
    CsgPlan plan;
    add_steps(csg, plan);
    std::vector<Row> surfaces;
    for (std::size_t i = 0; i < csg.leaves.size(); ++i) {
        plan.first_piece.push_back(static_cast<int>(surfaces.size()));
        const std::vector<Row> rows = surfaces_of(csg.leaves[i]);
        surfaces.insert(surfaces.end(), rows.begin(), rows.end());
        plan.leaf_of_piece.insert(plan.leaf_of_piece.end(), rows.size(), static_cast<int>(i));
    }
    plan.first_piece.push_back(static_cast<int>(surfaces.size()));
    plan.sides = sides_of(surfaces);
    add_leaf_tree(csg, digits, plan);
    return plan;
}

}  // namespace whitted
