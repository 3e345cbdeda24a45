#include <algorithm>
#include <cstddef>
#include <variant>
#include <vector>

#include "search/bounds.h"
#include "search/common_bounds.h"

namespace whitted {

namespace {

using Found = std::optional<Bounds>;

Found united(const Found& a, const Found& b) {
    if (!a || !b) {
        return std::nullopt;
    }
    Bounds result{{}, std::max(a->growth, b->growth), std::max(a->reach, b->reach)};
    for (std::size_t k = 0; k < 3; ++k) {
        result.box.low[k] = std::min(a->box.low[k], b->box.low[k]);
        result.box.high[k] = std::max(a->box.high[k], b->box.high[k]);
    }
    return result;
}

// The boxes around the parts of an expression.
class Parts {
 public:
    explicit Parts(const CsgDescription& csg) : csg_(csg), leaf_bounds_(csg.leaves.size()) {
        std::vector<std::size_t> stack;
        for (const int step : csg.program) {
            Node node{step, 0, 0};
            if (step < 0) {
                node.right = stack.back();
                stack.pop_back();
                node.left = stack.back();
                stack.pop_back();
            }
            stack.push_back(nodes_.size());
            nodes_.push_back(node);
        }
        used_.resize(csg.leaves.size());
    }

    Found bounds() { return bounds_of_node(nodes_.size() - 1); }

    std::vector<Found> leaf_bounds() {
        bound_leaves_within(nodes_.size() - 1, std::nullopt);
        return leaf_bounds_;
    }

 private:
    // A leaf, or an operation and its operands.
    struct Node {
        int step;
        std::size_t left, right;
        bool is_known = false;
        Found bounds{};
    };

    const LeafDescription* leaf_of(const Node& node) const {
        return node.step < 0 ? nullptr : &csg_.leaves[static_cast<std::size_t>(node.step)];
    }

    const PolyhedronDescription* half_space_at(std::size_t index) const {
        const LeafDescription* leaf = leaf_of(nodes_[index]);
        const auto* polyhedron = leaf == nullptr ? nullptr : std::get_if<PolyhedronDescription>(leaf);
        return polyhedron != nullptr && polyhedron->planes.size() == 1 ? polyhedron : nullptr;
    }

    // Adds what holds all of a part, whichever of the leaves subtracted from it are there, but for half-spaces.
    void add_to(Common& common, std::size_t index) {
        const Node& node = nodes_[index];
        if (const LeafDescription* leaf = leaf_of(node)) {
            common.leaves.push_back(leaf);
        } else if (node.step == CsgDescription::unite) {
            if (const Found either = united(bounds_of_node(node.left), bounds_of_node(node.right))) {
                common.boxes.push_back(*either);
            }
        } else {
            add_to(common, node.left);
            if (node.step == CsgDescription::intersect) {
                add_to(common, node.right);
            } else if (const PolyhedronDescription* cut_off = half_space_at(node.right)) {
                HalfSpace half_space = half_space_of(cut_off->planes[0]);
                half_space.height = -half_space.height;
                for (double& component : half_space.normal) {
                    component = -component;
                }
                common.half_spaces.push_back(half_space);
            }
        }
    }

    Found bounds_of_node(std::size_t index) {
        if (!nodes_[index].is_known) {
            Common common;
            add_to(common, index);
            nodes_[index].bounds = bounds_of(common);
            nodes_[index].is_known = true;
        }
        return nodes_[index].bounds;
    }

    // A part makes no difference outside `context`. Outside the box around it, it is empty, also without leaves that a
    // ray misses in the boxes found here: those make it larger only if they are subtracted, and on what the box comes
    // from that has no influence. Half-spaces that are subtracted have, and so must always be there: they have no box.
    void bound_leaves_within(std::size_t index, const Found& context) {
        bound_operands_within(index, intersected(bounds_of_node(index), context));
    }

    // The same of a part of which nothing that makes a difference lies outside `context`.
    void bound_operands_within(std::size_t index, const Found& context) {
        const Node& node = nodes_[index];
        if (node.step >= 0) {
            add_use(static_cast<std::size_t>(node.step), context);
        } else if (node.step == CsgDescription::unite) {
            bound_leaves_within(node.left, context);
            bound_leaves_within(node.right, context);
        } else {
            bound_operands_within(node.left, context);
            if (node.step == CsgDescription::intersect) {
                bound_operands_within(node.right, context);
            } else {
                bound_leaves_within(node.right, half_space_at(node.right) ? std::nullopt : context);
            }
        }
    }

    void add_use(std::size_t leaf, const Found& context) {
        Common common{{&csg_.leaves[leaf]}, {}, {}};
        if (context) {
            common.boxes.push_back(*context);
        }
        const Found here = bounds_of(common);
        leaf_bounds_[leaf] = used_[leaf] ? united(leaf_bounds_[leaf], here) : here;
        used_[leaf] = true;
    }

    const CsgDescription& csg_;
    std::vector<Node> nodes_;  // operands before their operation
    std::vector<Found> leaf_bounds_;
    std::vector<bool> used_;
};

}  // namespace

Found bounds_of(const CsgDescription& csg) { return Parts(csg).bounds(); }

std::vector<Found> leaf_bounds_of(const CsgDescription& csg) { return Parts(csg).leaf_bounds(); }

double cost_of(const CsgDescription& csg) {
    double cost = 0;
    for (const LeafDescription& leaf : csg.leaves) {
        cost += 2 * std::visit([](const auto& primitive) { return cost_of(primitive); }, leaf);
    }
    return cost;
}

}  // namespace whitted
