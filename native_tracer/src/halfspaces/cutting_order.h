// The order in which a face is cut by planes, and which of them can be left out.
//
// In a random order the first few planes cut a face down to about its size, and most of the rest miss it (de Berg et
// al., "Computational Geometry", 3rd ed., 2008, section 4.4). So planes come in rounds, each much larger than those
// before it together: of a round only those planes cut that affect the face as it is when the round begins, which a
// tree over the round's planes finds. A face of a body with n faces is thus had in a time that grows as log n.

#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "halfspaces/faces.h"
#include "halfspaces/plane_tree.h"

namespace whitted::halfspaces {

// The numbers 0 to count - 1 in an order that looks random, the same in every run.
inline std::vector<int> shuffled(std::size_t count) {
    std::vector<int> order(count);
    std::size_t random = 1;
    for (std::size_t i = 0; i < count; ++i) {
        random = (random * 1103515245 + 12345) % 2147483648U;
        const std::size_t j = random / 8 % (i + 1);
        order[i] = order[j];
        order[j] = static_cast<int>(i);
    }
    return order;
}

class CuttingOrder {
 public:
    static constexpr std::size_t usual_leaf_size = 8;

    // Trees end where `leaf_size` planes are left, which are tried one by one. That changes no face.
    CuttingOrder(const std::vector<Plane>& planes, std::size_t leaf_size) : order_(shuffled(planes.size())) {
        Real height = 0;
        for (const Plane& plane : planes) {
            height = std::max(height, std::abs(plane.offset));
        }
        const Real unit = height > 0 ? std::ldexp(Real(1), std::ilogb(height)) : 1;
        const auto add_round = [&](std::size_t begin, std::size_t end) {
            const std::span<const int> numbers(order_.data() + begin, end - begin);
            rounds_.emplace_back(planes, numbers, static_cast<int>(begin), unit, leaf_size);
        };
        for (std::size_t begin = first_round; begin < order_.size(); begin *= growth) {
            add_round(begin, std::min(growth * begin, order_.size()));
        }
        if (order_.size() > first_round) {
            add_round(0, order_.size());
        }
    }

    // All planes, neighbours after one another: cut in this order, faces find at hand what they are cut by.
    std::vector<int> by_neighborhood() const {
        if (rounds_.empty()) {
            return order_;
        }
        std::vector<int> numbers;
        numbers.reserve(order_.size());
        rounds_.back().for_each([&](int place) { numbers.push_back(number_at(place)); });
        return numbers;
    }

    // Cut a face by all planes. A huge face counts as missed by planes that take less of it than the noise of its far
    // corners; so the last round is one of all planes again.
    void cut(Face& face) const {
        cut_by_first(face);
        if (rounds_.empty()) {
            cut_by_first(face);
        }
        std::vector<int> places;
        for (const PlaneTree& round : rounds_) {
            if (face.empty()) {
                return;
            }
            places.clear();
            round.for_each_near(face.outline(), [&](int place) {
                if (face.affected_by(number_at(place))) {
                    places.push_back(place);
                }
            });
            std::sort(places.begin(), places.end());
            for (const int place : places) {
                face.cut_by(number_at(place));
            }
        }
    }

 private:
    // So few planes are tried one after another more quickly.
    static constexpr std::size_t first_round = 64;
    static constexpr std::size_t growth = 4;

    void cut_by_first(Face& face) const {
        for (std::size_t i = 0; i < std::min(first_round, order_.size()); ++i) {
            face.cut_by(order_[i]);
        }
    }
    int number_at(int place) const { return order_[static_cast<std::size_t>(place)]; }

    std::vector<int> order_;
    std::vector<PlaneTree> rounds_;
};

}  // namespace whitted::halfspaces
