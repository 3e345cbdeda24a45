// A search for the planes that a face may be cut by: a hierarchy of boxes over planes, as points (normal, offset).
//
// How far a corner p lies outside of a plane, dot(normal, p) + offset, is a linear function of that point: a box of
// planes bounds it. The boxes lie along the principal axes of their planes (Gottschalk, Lin and Manocha, "OBBTree",
// SIGGRAPH 1996): planes through one point, or along one direction, lie in a subspace, and a box that does not would
// take them for any planes. Each box is split at the median along its longest side.
//
// What a search leaves out does not affect the face by the word of Face::affected_by(), the noise of both considered.
// Most is clear in double precision; what is not is computed once more.

#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "halfspaces/faces.h"
#include "halfspaces/principal_axes.h"

namespace whitted::halfspaces {

class PlaneTree {
 public:
    // Over the planes `numbers`, each with the place that searches know it by, from `first_place` on. Lengths are taken
    // in a `unit`, a power of two, so that double precision has numbers for them.
    PlaneTree(const std::vector<Plane>& planes, std::span<const int> numbers, int first_place, Real unit,
              std::size_t leaf_size);

    // Calls visit(place) for all planes, neighbours after one another.
    template <typename Visit>
    void for_each(Visit visit) const {
        for (const Item& item : items_) {
            visit(item.place);
        }
    }

    // Calls visit(place) for every plane that may affect a face with this outline, and for some more.
    template <typename Visit>
    void for_each_near(const Outline& outline, Visit visit) const;

 private:
    template <typename Value>
    using Quadruple = std::array<Value, 4>;
    struct Item {
        Quadruple<Real> point;  // the normal and the offset
        int place;
    };
    template <typename Value>
    struct Box {
        Quadruple<Value> center;
        SquareMatrix<Value, 4> axes;  // orthogonal unit vectors, as columns
        Quadruple<Value> half_sides;  // along the axes
        Value error;                  // of products with what is in it, from the centre, relative to the factors
    };
    struct ExactBox : Box<Real> {
        Quadruple<Real> reach;  // of the planes from the centre, in each coordinate
    };
    struct Node {
        Box<double> box;
        double offset, least_offset;  // the largest and the smallest, without their signs
        std::size_t first, count;
        std::size_t children = 0;  // the first of two neighbours; 0: it is a leaf
    };
    // What planes are multiplied with.
    struct Factors {
        explicit Factors(const Quadruple<Real>& point);

        Quadruple<Real> exact;
        Quadruple<double> rough;
        double sum;  // of the absolute numbers
    };
    struct Query;

    static constexpr int most_depth = 64;  // of a tree split at medians

    template <typename Value>
    static Value product(const Quadruple<Value>& a, const Quadruple<Value>& b) {
        return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
    }
    template <typename Value>
    static Quadruple<Value> along(const SquareMatrix<Value, 4>& axes, const Quadruple<Value>& point);
    template <typename Value>
    static Quadruple<Value> from_center(const Box<Value>& box, const Quadruple<Value>& point);
    template <typename Value>
    static Value beside_center(const Box<Value>& box, const Quadruple<Value>& factors);
    void split(std::size_t index, std::size_t leaf_size);
    void add_node(std::size_t first, std::size_t count);
    Real most(std::size_t node, const Factors& factors) const;
    bool may_affect(std::size_t node, const Query& query) const;
    static bool may_affect(const Item& item, const Query& query);

    Real unit_;
    std::vector<Item> items_;
    std::vector<Node> nodes_;
    std::vector<ExactBox> exact_boxes_;  // of the nodes; seldom needed
};

// An outline in the tree's unit.
struct PlaneTree::Query {
    struct Point {
        Factors factors;
        double size;
    };
    Point center;
    double radius;
    std::array<Factors, 4> sideways;  // the directions in the face's plane, to and fro
    std::vector<Point> points;
    bool own_corners;
};

// ---- Building -------------------------------------------------------------------------------------------------------

inline PlaneTree::PlaneTree(const std::vector<Plane>& planes, std::span<const int> numbers, int first_place, Real unit,
                            std::size_t leaf_size)
    : unit_(unit) {
    items_.reserve(numbers.size());
    for (const int k : numbers) {
        const Plane& plane = planes[static_cast<std::size_t>(k)];
        items_.push_back({{plane.normal.x, plane.normal.y, plane.normal.z, plane.offset / unit_}, first_place++});
    }
    add_node(0, items_.size());
    split(0, leaf_size);
}

inline void PlaneTree::split(std::size_t index, std::size_t leaf_size) {
    const Node node = nodes_[index];
    if (node.count <= leaf_size) {
        return;
    }
    const Box<Real> box = exact_boxes_[index];
    const Quadruple<Real>& sides = box.half_sides;
    const auto longest = static_cast<std::size_t>(std::max_element(sides.begin(), sides.end()) - sides.begin());
    const auto along_longest = [&](const Item& item) { return from_center(box, item.point)[longest]; };
    const std::size_t half = node.count / 2;
    const auto begin = items_.begin() + static_cast<std::ptrdiff_t>(node.first);
    std::nth_element(begin, begin + static_cast<std::ptrdiff_t>(half), begin + static_cast<std::ptrdiff_t>(node.count),
                     [&](const Item& a, const Item& b) { return along_longest(a) < along_longest(b); });
    const std::size_t children = nodes_.size();
    nodes_[index].children = children;
    add_node(node.first, half);
    add_node(node.first + half, node.count - half);
    split(children, leaf_size);
    split(children + 1, leaf_size);
}

template <typename Value>
PlaneTree::Quadruple<Value> PlaneTree::along(const SquareMatrix<Value, 4>& axes, const Quadruple<Value>& point) {
    Quadruple<Value> result{};
    for (std::size_t k = 0; k < 4; ++k) {
        for (std::size_t i = 0; i < 4; ++i) {
            result[i] += axes[k][i] * point[k];
        }
    }
    return result;
}

// Where a point is, from a box's centre, along its axes.
template <typename Value>
PlaneTree::Quadruple<Value> PlaneTree::from_center(const Box<Value>& box, const Quadruple<Value>& point) {
    const Quadruple<Value>& center = box.center;
    return along(box.axes, {point[0] - center[0], point[1] - center[1], point[2] - center[2], point[3] - center[3]});
}

inline void PlaneTree::add_node(std::size_t first, std::size_t count) {
    const std::span<const Item> items(items_.data() + first, count);
    Node& node = nodes_.emplace_back();
    ExactBox& box = exact_boxes_.emplace_back();
    node.first = first;
    node.count = count;
    node.least_offset = std::numeric_limits<double>::infinity();
    for (const Item& item : items) {
        const auto offset = static_cast<double>(std::abs(item.point[3]));
        node.offset = std::max(node.offset, offset);
        node.least_offset = std::min(node.least_offset, offset);
        for (std::size_t k = 0; k < 4; ++k) {
            box.center[k] += item.point[k] / static_cast<Real>(count);
        }
    }
    SquareMatrix<Real, 4> covariance{};
    for (const Item& item : items) {
        for (std::size_t i = 0; i < 4; ++i) {
            for (std::size_t k = 0; k < 4; ++k) {
                covariance[i][k] += (item.point[i] - box.center[i]) * (item.point[k] - box.center[k]);
            }
        }
    }
    box.axes = principal_axes(covariance);
    Quadruple<Real> low{};
    Quadruple<Real> high{};
    for (const Item& item : items) {
        const Quadruple<Real> place = from_center(box, item.point);
        for (std::size_t i = 0; i < 4; ++i) {
            low[i] = std::min(low[i], place[i]);
            high[i] = std::max(high[i], place[i]);
        }
    }
    // From the centre of mass to that of the box.
    for (std::size_t k = 0; k < 4; ++k) {
        for (std::size_t i = 0; i < 4; ++i) {
            box.center[k] += box.axes[k][i] * (low[i] + high[i]) / 2;
        }
    }
    for (const Item& item : items) {
        const Quadruple<Real> place = from_center(box, item.point);
        for (std::size_t i = 0; i < 4; ++i) {
            box.half_sides[i] = std::max(box.half_sides[i], std::abs(place[i]));
            box.reach[i] = std::max(box.reach[i], std::abs(item.point[i] - box.center[i]));
        }
    }
    const Real farthest = length({box.reach[0], box.reach[1], box.reach[2]}) + box.reach[3];
    // Axes are orthogonal unit vectors but for the noise of some thirty rotations, or the rounding of each number.
    box.error = 16 * noise * farthest;
    for (std::size_t k = 0; k < 4; ++k) {
        node.box.center[k] = static_cast<double>(box.center[k]);
        node.box.half_sides[k] = static_cast<double>(box.half_sides[k]);
        std::copy(box.axes[k].begin(), box.axes[k].end(), node.box.axes[k].begin());
    }
    // Here the centre's rounding counts, too.
    node.box.error =
        std::numeric_limits<double>::epsilon() * (64 * static_cast<double>(farthest) + 8 * std::max(1.0, node.offset)) +
        std::numeric_limits<double>::min();
}

// ---- Searching ------------------------------------------------------------------------------------------------------

inline PlaneTree::Factors::Factors(const Quadruple<Real>& point) : exact(point), sum(0) {
    for (std::size_t i = 0; i < 4; ++i) {
        rough[i] = static_cast<double>(point[i]);
        sum += std::abs(rough[i]);
    }
}

// By how much a product of factors and something in a box may be larger than with the box's centre, but for the error.
template <typename Value>
Value PlaneTree::beside_center(const Box<Value>& box, const Quadruple<Value>& factors) {
    const Quadruple<Value> shares = along(box.axes, factors);
    Value sum = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        sum += box.half_sides[i] * std::abs(shares[i]);
    }
    return sum;
}

// No less than the largest product of the planes with some factors.
inline Real PlaneTree::most(std::size_t node, const Factors& factors) const {
    const Box<double>& box = nodes_[node].box;
    const double error = box.error * factors.sum;
    const double rough = product(box.center, factors.rough) + beside_center(box, factors.rough) + error;
    if (rough <= 0 || rough > 2 * error) {
        return rough;
    }
    const ExactBox& exact = exact_boxes_[node];
    // Where planes meet in a point, or in a line along an axis, they may do so exactly.
    Real exactly_beside = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        exactly_beside += exact.reach[i] * std::abs(factors.exact[i]);
    }
    return product(exact.center, factors.exact) +
           std::min(beside_center(exact, factors.exact) + exact.error * factors.sum, exactly_beside);
}

inline bool PlaneTree::may_affect(std::size_t index, const Query& query) const {
    const Node& node = nodes_[index];
    if (most(index, query.center.factors) < -query.radius - rounding * (query.center.size + node.offset)) {
        return false;
    }
    // For Face::affected_by(), a corner is outside if it is farther out than 16 roundings of its size and the offset.
    // Of these up to 6 and 2 may be its own, 3 and 0 those of the corner in space, 4 and 4 those of most(). Around a
    // face there may be points of a larger size than its corners.
    constexpr Real half_ulp = noise / 16;
    const Real share = query.own_corners ? 3 : -16;
    bool far_below = true;  // even where what is parallel within roundings counts
    for (const Query::Point& point : query.points) {
        const Real height = most(index, point.factors);
        if (height > half_ulp * (share * point.size + 14 * node.least_offset - 4 * node.offset)) {
            return true;
        }
        far_below = far_below && height < -2 * rounding * (point.size + node.offset);
    }
    // Otherwise it takes planes that are parallel to the face.
    return !far_below && std::all_of(query.sideways.begin(), query.sideways.end(),
                                     [&](const Factors& direction) { return most(index, direction) >= -2 * rounding; });
}

inline bool PlaneTree::may_affect(const Item& item, const Query& query) {
    const Quadruple<double> plane{static_cast<double>(item.point[0]), static_cast<double>(item.point[1]),
                                  static_cast<double>(item.point[2]), static_cast<double>(item.point[3])};
    return std::any_of(query.points.begin(), query.points.end(), [&](const Query::Point& point) {
        return product(plane, point.factors.rough) >=
               -4 * static_cast<double>(rounding) * (point.size + std::abs(plane[3]));
    });
}

template <typename Visit>
void PlaneTree::for_each_near(const Outline& outline, Visit visit) const {
    if (nodes_[0].children == 0) {
        for_each(visit);
        return;
    }
    const auto scaled = [&](const Outline::Point& point) {
        const Vec p = (1 / unit_) * point.position;
        return Query::Point{Factors({p.x, p.y, p.z, 1}), static_cast<double>(point.size / unit_)};
    };
    const auto direction = [](const Vec& v, Real sign) { return Factors({sign * v.x, sign * v.y, sign * v.z, 0}); };
    Query query{scaled(outline.center),
                static_cast<double>(outline.radius / unit_),
                {direction(outline.u, 1), direction(outline.u, -1), direction(outline.v, 1), direction(outline.v, -1)},
                {},
                outline.own_corners};
    for (const Outline::Point& point : outline.points) {
        query.points.push_back(scaled(point));
    }
    std::size_t waiting[most_depth];
    std::size_t count = 1;
    waiting[0] = 0;
    while (count > 0) {
        const Node& node = nodes_[waiting[--count]];
        if (node.children == 0) {
            for (std::size_t i = node.first; i < node.first + node.count; ++i) {
                if (may_affect(items_[i], query)) {
                    visit(items_[i].place);
                }
            }
            continue;
        }
        for (const std::size_t child : {node.children, node.children + 1}) {
            if (may_affect(child, query)) {
                waiting[count++] = child;
            }
        }
    }
}

}  // namespace whitted::halfspaces
