#include "shapes/simplified_csg.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

namespace whitted {

namespace {

// A part of an expression: what it pushes, and the polyhedron that it is, if it is one.
struct Part {
    std::vector<int> program;
    std::optional<PolyhedronDescription> polyhedron;
};

// Not all signs of 0 are turned, so that the plane is the same number by number.
Quadruple turned(const Quadruple& plane) { return {0 - plane[0], 0 - plane[1], 0 - plane[2], 0 - plane[3]}; }

// The planes of both, if that is the polyhedron left by an operation.
std::optional<PolyhedronDescription> combined(const Part& left, int operation, const Part& right) {
    if (!left.polyhedron || !right.polyhedron) {
        return std::nullopt;
    }
    PolyhedronDescription result = *left.polyhedron;
    const std::vector<Quadruple>& planes = right.polyhedron->planes;
    if (operation == CsgDescription::intersect) {
        result.planes.insert(result.planes.end(), planes.begin(), planes.end());
    } else if (operation == CsgDescription::subtract && planes.size() == 1) {
        result.planes.push_back(turned(planes[0]));
    } else {
        return std::nullopt;
    }
    return result;
}

// Puts the leaves into the order in which the program has them: of two that are met at once the first counts.
void order_leaves(CsgDescription& csg) {
    std::vector<int> places(csg.leaves.size(), -1);
    std::vector<LeafDescription> leaves;
    for (int& step : csg.program) {
        if (step < 0) {
            continue;
        }
        int& place = places[static_cast<std::size_t>(step)];
        if (place < 0) {
            place = static_cast<int>(leaves.size());
            leaves.push_back(std::move(csg.leaves[static_cast<std::size_t>(step)]));
        }
        step = place;
    }
    csg.leaves = std::move(leaves);
}

// The result that is made, of the leaves of a csg.
class Settled {
 public:
    explicit Settled(const CsgDescription& csg) : csg_(csg), places_(csg.leaves.size(), -1) {}

    // Puts a polyhedron, or a part of one leaf, into the result, and gives its number there.
    int number_of(const Part& part) {
        if (part.polyhedron && part.program.size() > 1) {
            return add(*part.polyhedron);
        }
        const auto leaf = static_cast<std::size_t>(part.program.front());
        int& place = places_[leaf];
        if (place < 0) {
            place = add(csg_.leaves[leaf]);
        }
        return place;
    }

    CsgDescription result;

 private:
    int add(const LeafDescription& leaf) {
        result.leaves.push_back(leaf);
        return static_cast<int>(result.leaves.size()) - 1;
    }

    const CsgDescription& csg_;
    std::vector<int> places_;  // of the csg's leaves in the result, or -1
};

}  // namespace

ShapeDescription simplified(const CsgDescription& csg) {
    Settled settled(csg);
    // Parts that are no polyhedra are settled already: their programs are in the result's numbers.
    std::vector<Part> stack;
    for (const int step : csg.program) {
        if (step >= 0) {
            const auto* polyhedron = std::get_if<PolyhedronDescription>(&csg.leaves[static_cast<std::size_t>(step)]);
            Part part{{step}, polyhedron ? std::optional(*polyhedron) : std::nullopt};
            if (!polyhedron) {
                part.program = {settled.number_of(part)};
            }
            stack.push_back(std::move(part));
            continue;
        }
        Part right = std::move(stack.back());
        stack.pop_back();
        Part& left = stack.back();
        if (auto polyhedron = combined(left, step, right)) {
            left.polyhedron = std::move(polyhedron);
            left.program.insert(left.program.end(), right.program.begin(), right.program.end());
            left.program.push_back(step);
            continue;
        }
        for (Part* part : {&left, &right}) {
            if (part->polyhedron) {
                part->program = {settled.number_of(*part)};
                part->polyhedron.reset();
            }
        }
        left.program.insert(left.program.end(), right.program.begin(), right.program.end());
        left.program.push_back(step);
    }
    Part& whole = stack.back();
    if (whole.polyhedron) {
        return *whole.polyhedron;
    }
    CsgDescription& result = settled.result;
    if (whole.program.size() == 1) {
        return std::visit([](auto& leaf) { return ShapeDescription(leaf); }, result.leaves.front());
    }
    result.program = std::move(whole.program);
    order_leaves(result);
    return std::move(result);
}

}  // namespace whitted
