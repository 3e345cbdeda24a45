#include "search/search.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <variant>

#include "search/bounds.h"

namespace whitted {

namespace {

constexpr std::uint32_t leaf_size = 4;

// From such a cost of a ray on, see bounds.h, a tree is faster than testing all objects. Measured on scattered balls
// and blocks and on small scenes, in float and double: below 16 a tree was up to a fifth slower, above 26 up to a
// tenth, and faster in all but one.
constexpr double least_cost_of_a_tree = 24;

double cost_of(const SceneDescription& scene) {
    double cost = 0;
    for (const ObjectDescription& object : scene.objects) {
        cost += std::visit([](const auto& shape) { return whitted::cost_of(shape); }, object.shape);
    }
    return cost;
}

// An object whose planes meet at so sharp an angle that the rounding of the given precision moves their edge by more
// than about this share of the tree's size would make all boxes that much wider, and stays outside the tree.
constexpr double most_blur = 0x1p-12;

double epsilon_of(Precision precision) {
    // Boxes are no better than double.
    return precision == Precision::single ? std::numeric_limits<float>::epsilon()
                                          : std::numeric_limits<double>::epsilon();
}

}  // namespace

SearchPlan plan_search(const SceneDescription& scene, Search search, Precision precision) {
    SearchPlan plan;
    const bool wants_tree =
        search == Search::bvh || (search == Search::automatic && cost_of(scene) >= least_cost_of_a_tree);
    std::vector<Box> boxes;
    std::vector<std::uint32_t> objects;
    for (std::size_t i = 0; i < scene.objects.size(); ++i) {
        std::optional<Bounds> found;
        if (wants_tree) {
            found = std::visit([](const auto& shape) { return bounds_of(shape); }, scene.objects[i].shape);
        }
        if (!found || 32 * epsilon_of(precision) * found->growth > most_blur) {
            plan.apart.push_back(static_cast<int>(i));
            continue;
        }
        boxes.push_back(found->box);
        objects.push_back(static_cast<std::uint32_t>(i));
        plan.growth = std::max(plan.growth, found->growth);
        plan.reach = std::max(plan.reach, found->reach);
        for (std::size_t k = 0; k < 3; ++k) {
            plan.reach = std::max({plan.reach, -found->box.low[k], found->box.high[k]});
        }
    }
    plan.tree = build_bvh(boxes, leaf_size);
    for (std::uint32_t& item : plan.tree.order) {
        item = objects[item];
    }
    return plan;
}

}  // namespace whitted
