#include "search/search.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <variant>

#include "search/bounds.h"
#include "shapes/csg_plan.h"

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

// Boxes of items, and what is common to all.
struct Boxes {
    std::vector<Box> boxes;
    std::vector<std::uint32_t> items;
    double growth = 1, reach = 0;

    // False if the item has to stay outside a tree.
    bool add(std::uint32_t item, const std::optional<Bounds>& bounds, double epsilon) {
        if (!bounds || 32 * epsilon * bounds->growth > most_blur) {
            return false;
        }
        boxes.push_back(bounds->box);
        items.push_back(item);
        growth = std::max(growth, bounds->growth);
        reach = std::max(reach, bounds->reach);
        for (std::size_t k = 0; k < 3; ++k) {
            reach = std::max({reach, -bounds->box.low[k], bounds->box.high[k]});
        }
        return true;
    }

    // Puts the boxes into the tree's order, if wanted.
    Bvh tree(std::uint32_t items_in_a_leaf, std::vector<Box>* in_order = nullptr) const {
        Bvh tree = build_bvh(boxes, items_in_a_leaf);
        if (in_order != nullptr) {
            in_order->reserve(boxes.size());
            for (const std::uint32_t index : tree.order) {
                in_order->push_back(boxes[index]);
            }
        }
        for (std::uint32_t& item : tree.order) {
            item = items[item];
        }
        return tree;
    }
};

}  // namespace

void add_leaf_tree(const CsgDescription& csg, int digits, CsgPlan& plan) {
    Boxes boxes;
    const double epsilon =
        digits < std::numeric_limits<double>::digits ? epsilon_of(Precision::single) : epsilon_of(Precision::double_);
    const std::vector<std::optional<Bounds>> found = leaf_bounds_of(csg);
    for (std::size_t i = 0; i < csg.leaves.size(); ++i) {
        if (!boxes.add(static_cast<std::uint32_t>(i), found[i], epsilon)) {
            plan.apart.push_back(static_cast<int>(i));
        }
    }
    plan.growth = boxes.growth;
    plan.reach = boxes.reach;
    plan.tree = boxes.tree(2);
}

SearchPlan plan_search(const SceneDescription& scene, Search search, Precision precision) {
    SearchPlan plan;
    plan.forced = search == Search::bvh;
    const bool wants_tree = plan.forced || (search == Search::automatic && cost_of(scene) >= least_cost_of_a_tree);
    Boxes boxes;
    for (std::size_t i = 0; i < scene.objects.size(); ++i) {
        std::optional<Bounds> found;
        if (wants_tree) {
            found = std::visit([](const auto& shape) { return bounds_of(shape); }, scene.objects[i].shape);
        }
        if (!boxes.add(static_cast<std::uint32_t>(i), found, epsilon_of(precision))) {
            plan.apart.push_back(static_cast<int>(i));
        }
    }
    plan.growth = boxes.growth;
    plan.reach = boxes.reach;
    plan.tree = boxes.tree(leaf_size, &plan.boxes);
    return plan;
}

}  // namespace whitted
