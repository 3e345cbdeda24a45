// A quadric may have no bounds and still tell in which half-spaces it lies, of what lies in others: of a hyperboloid
// between two planes square to its axis it is known how thick it is. In its own axes, where it is the sum over i of
// b_i y_i^2 + 2 l_i y_i that is not above -k, each term lies between bounds wherever the y_i do, and so
//
//     b_i y_i^2 + 2 l_i y_i <= -k - (the least of the other terms)
//
// bounds y_i where b_i is positive, or 0 and l_i is not. The half-spaces that follow bound what the other bodies are
// told of, and so in turns, until little changes. Davis, "Constraint Propagation with Interval Labels", Artificial
// Intelligence 32(3), 1987.
//
// All bounds are functions of the distance d by which surfaces are moved outward, above the true ones for all d from 0,
// and linear in the end: the square root of D + D' d + D" d^2 is at most sqrt(D) + max(D' / (2 sqrt(D)), sqrt(D")) d.
// That includes all that is rounded, which counts for surfaces that are moved by some epsilon of the largest
// coordinate.

#include "search/common_bounds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <variant>

#include "shapes/canonical_form.h"

namespace whitted {

namespace {

using Real = long double;
using Found = std::optional<Bounds>;

constexpr Real infinity = std::numeric_limits<Real>::infinity();

// An upper bound of a number, value + first d + second d^2; infinite if there is none.
struct Growing {
    Real value, first = 0, second = 0;
};

// Where a coordinate ends, and by how much of d that moves outward; infinite if it does not.
struct End {
    Real at, growth;
};

CanonicalForm form_of(const SphereDescription& sphere) {
    CanonicalForm form{};
    for (std::size_t k = 0; k < 3; ++k) {
        form.axes[k][k] = form.bend[k] = 1;
        form.center[k] = sphere.center[k];
    }
    form.constant = -Real(sphere.radius) * sphere.radius;
    return form;
}

// The most of -(bend y^2 + 2 linear y) between two ends.
Growing most_between(Real bend, Real linear, const End& low, const End& high) {
    const auto value_at = [&](const End& end) {
        const Real value = -(bend * end.at + 2 * linear) * end.at;
        const Real slope = 2 * std::abs(bend * end.at + linear);
        return Growing{value, slope * end.growth, std::max(-bend, Real(0)) * end.growth * end.growth};
    };
    if (bend > 0) {
        const Real top = -linear / bend;
        return low.at > top ? value_at(low) : high.at < top ? value_at(high) : Growing{-linear * top};
    }
    if (bend == 0) {
        return linear == 0 ? Growing{0} : value_at(linear > 0 ? low : high);
    }
    const Growing one = value_at(low);
    const Growing other = value_at(high);
    return {std::max(one.value, other.value), std::max(one.first, other.first), std::max(one.second, other.second)};
}

// How far a coordinate of a quadric goes, in both directions, if bend y^2 + 2 linear y is at most `most`, which was
// rounded by no more than `error`.
std::pair<End, End> ends_of(Real bend, Real linear, const Growing& most, Real error) {
    std::pair<End, End> ends{{-infinity, 0}, {infinity, 0}};
    if (bend > 0) {
        const Real middle = -linear / bend;
        Real width2 = (most.value + error) / bend + (1 + 0x1p-46L) * middle * middle;
        const Real first = most.first / bend;
        // Of what is thin because it all but misses, the ends move fast: it is made thicker.
        constexpr Real most_growth = 64;
        width2 = std::max(width2, first * first / (4 * most_growth * most_growth));
        if (width2 > 0 && width2 < infinity) {
            const Real width = std::sqrt(width2);
            const Real growth = std::max(first / (2 * width), std::sqrt(most.second / bend));
            ends = {{middle - width, growth}, {middle + width, growth}};
        }
    } else if (bend == 0 && linear != 0 && most.second == 0) {
        const End end{(most.value + error) / (2 * linear), most.first / (2 * std::abs(linear))};
        (linear > 0 ? ends.second : ends.first) = end;
    }
    return ends;
}

class Propagation {
 public:
    explicit Propagation(const Common& common) : half_spaces_(common.half_spaces) {
        for (const Bounds& bounds : common.boxes) {
            add_box(bounds);
        }
        for (const LeafDescription* leaf : common.leaves) {
            if (const auto* polyhedron = std::get_if<PolyhedronDescription>(leaf)) {
                for (const Quadruple& plane : polyhedron->planes) {
                    half_spaces_.push_back(half_space_of(plane));
                }
                continue;
            }
            const auto* sphere = std::get_if<SphereDescription>(leaf);
            forms_.push_back(sphere ? form_of(*sphere) : canonical_form(std::get<QuadricDescription>(*leaf)));
            if (const Found own = std::visit([](const auto& shape) { return bounds_of(shape); }, *leaf)) {
                add_box(*own);
            }
        }
        for (const CanonicalForm& form : forms_) {
            for (const Real center : form.center) {
                reach_ = std::max(reach_, static_cast<double>(std::abs(center)));
            }
        }
    }

    Found bounds() {
        Found result = narrowed();
        if (!result && !forms_.empty()) {
            result = bounds_within_cube();
        }
        if (!result) {
            return result;
        }
        result->reach = std::max(result->reach, reach_);
        double size = result->reach;
        for (std::size_t k = 0; k < 3; ++k) {
            size = std::max({size, -result->box.low[k], result->box.high[k]});
        }
        const double slack = 0x1p-42 * result->growth * size;
        for (std::size_t k = 0; k < 3; ++k) {
            result->box.low[k] -= slack;
            result->box.high[k] += slack;
            if (!std::isfinite(result->box.low[k]) || !std::isfinite(result->box.high[k])) {
                return std::nullopt;
            }
        }
        return result;
    }

 private:
    void add_box(const Bounds& bounds) {
        reach_ = std::max(reach_, bounds.reach);
        for (std::size_t k = 0; k < 3; ++k) {
            HalfSpace low{{}, -bounds.box.low[k], bounds.growth};
            HalfSpace high{{}, bounds.box.high[k], bounds.growth};
            low.normal[k] = -1;
            high.normal[k] = 1;
            half_spaces_.insert(half_spaces_.end(), {low, high});
        }
    }

    Found narrowed() {
        constexpr int most_rounds = 6;
        bool narrows = true;
        for (int round = 0; round < most_rounds && narrows; ++round) {
            narrows = false;
            for (const CanonicalForm& form : forms_) {
                narrows = narrow(form) || narrows;
            }
        }
        return bounds_of(half_spaces_);
    }

    // Bounds may depend on one another: a cylinder of rounded coefficients is a thin cone far away, and goes on between
    // two planes that are not quite square to it as far as it is thick. Then, a large cube is put around the origin.
    // What lies in it is found in a box that is smaller; and so it is, with everything that is there, if the cube is
    // made larger by any s, and surfaces are moved by s / cube_growth: the box grows by less than that. So nothing lies
    // outside of the cube.
    Found bounds_within_cube() {
        double scale = reach_;
        for (const HalfSpace& half_space : half_spaces_) {
            scale = std::max(scale, std::abs(half_space.height));
        }
        constexpr double cube_growth = 0x1p12;
        const double size = 0x1p16 * scale;
        add_box({{{-size, -size, -size}, {size, size, size}}, cube_growth, scale});
        const Found result = narrowed();
        if (!result || !(result->growth < cube_growth)) {
            return std::nullopt;
        }
        for (std::size_t k = 0; k < 3; ++k) {
            if (!(result->box.low[k] > -size && result->box.high[k] < size)) {
                return std::nullopt;
            }
        }
        return result;
    }

    // Adds the half-spaces that follow from a quadric. False if they change little.
    bool narrow(const CanonicalForm& form) {
        std::array<std::array<double, 3>, 3> axes;
        std::array<Real, 3> middles;
        std::array<End, 3> low, high;
        for (std::size_t i = 0; i < 3; ++i) {
            std::array<double, 3> back;
            middles[i] = 0;
            for (std::size_t k = 0; k < 3; ++k) {
                axes[i][k] = static_cast<double>(form.axes[k][i]);
                back[k] = -axes[i][k];
                middles[i] += form.axes[k][i] * form.center[k];
            }
            const std::optional<Support> above = support_of(half_spaces_, axes[i]);
            const std::optional<Support> below = support_of(half_spaces_, back);
            high[i] = above ? End{above->height - middles[i], above->growth} : End{infinity, 0};
            low[i] = below ? End{-below->height - middles[i], below->growth} : End{-infinity, 0};
        }
        bool narrows = false;
        for (std::size_t i = 0; i < 3; ++i) {
            // A point off by d is no farther than that from one of the quadric.
            Growing most{-form.constant};
            Real terms = std::abs(form.constant);
            for (std::size_t j = 0; j < 3; ++j) {
                if (j != i) {
                    const Growing term = most_between(form.bend[j], form.linear[j], {low[j].at, low[j].growth + 1},
                                                      {high[j].at, high[j].growth + 1});
                    most = {most.value + term.value, most.first + term.first, most.second + term.second};
                    terms += std::abs(term.value);
                }
            }
            if (!std::isfinite(terms) || !std::isfinite(most.first) || !std::isfinite(most.second)) {
                continue;
            }
            const auto [first, last] = ends_of(form.bend[i], form.linear[i], most, 0x1p-46L * terms);
            // Much less than the width, or half the distance that is known from the middle.
            constexpr Real much = 1 / Real(64);
            const Real least = much * std::min(high[i].at - low[i].at, last.at - first.at);
            const auto add = [&](double sign, const End& end) {
                HalfSpace half_space{axes[i], static_cast<double>(sign * (middles[i] + end.at)),
                                     static_cast<double>(end.growth + 1)};
                for (double& component : half_space.normal) {
                    component *= sign;
                }
                if (std::isfinite(half_space.height)) {
                    half_spaces_.push_back(half_space);
                    narrows = true;
                }
            };
            if (last.at < high[i].at && !(high[i].at - last.at < least)) {
                add(1, last);
            }
            if (first.at > low[i].at && !(first.at - low[i].at < least)) {
                add(-1, first);
            }
        }
        return narrows;
    }

    std::vector<CanonicalForm> forms_;
    std::vector<HalfSpace> half_spaces_;
    double reach_ = 0;
};

}  // namespace

Found intersected(const Found& a, const Found& b) {
    if (!a || !b) {
        return a ? a : b;
    }
    // How much a computation is off is the same as for the shapes that the box is made of.
    Bounds result{{}, std::max(a->growth, b->growth), std::max(a->reach, b->reach)};
    for (std::size_t k = 0; k < 3; ++k) {
        result.box.low[k] = std::max(a->box.low[k], b->box.low[k]);
        result.box.high[k] = std::min(a->box.high[k], b->box.high[k]);
        if (result.box.low[k] > result.box.high[k]) {
            return a;  // there is nothing in it, which a box cannot say
        }
    }
    return result;
}

Found bounds_of(const Common& common) {
    Found result;
    for (const LeafDescription* leaf : common.leaves) {
        result = intersected(result, std::visit([](const auto& shape) { return bounds_of(shape); }, *leaf));
    }
    for (const Bounds& bounds : common.boxes) {
        result = intersected(result, bounds);
    }
    const std::size_t count = common.leaves.size() + common.half_spaces.size() + common.boxes.size();
    return count == 1 ? result : intersected(result, Propagation(common).bounds());
}

}  // namespace whitted
