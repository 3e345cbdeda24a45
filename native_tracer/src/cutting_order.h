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

#include "halfspace_faces.h"
#include "plane_tree.h"

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
        std::size_t begin = std::min(first_round, order_.size());
        while (begin < order_.size()) {
            const std::size_t end = std::min(growth * begin, order_.size());
            const std::span<const int> numbers(order_.data() + begin, end - begin);
            rounds_.emplace_back(planes, numbers, static_cast<int>(begin), unit, leaf_size);
            begin = end;
        }
    }

    // All planes, most of them after their neighbours: cut in this order, faces find at hand what they are cut by.
    std::vector<int> by_neighborhood() const {
        std::vector<int> numbers(order_.begin(), end_of_first_round());
        for (const PlaneTree& round : rounds_) {
            round.for_each([&](int place) { numbers.push_back(number_at(place)); });
        }
        return numbers;
    }

    // Cut a face by all planes. A huge face counts as missed by planes that take less of it than the noise of its far
    // corners; so it is cut once more by those that affect what is left.
    void cut(Face& face) const {
        std::vector<int> places;
        for (int turn = 0; turn < 2; ++turn) {
            std::for_each(order_.begin(), end_of_first_round(), [&](int k) { face.cut_by(k); });
            for (const PlaneTree& round : rounds_) {
                cut(face, round, places);
            }
        }
    }

 private:
    static constexpr std::size_t first_round = 64;
    static constexpr std::size_t growth = 4;

    std::vector<int>::const_iterator end_of_first_round() const {
        return order_.begin() + static_cast<std::ptrdiff_t>(std::min(first_round, order_.size()));
    }
    void cut(Face& face, const PlaneTree& round, std::vector<int>& places) const {
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
    int number_at(int place) const { return order_[static_cast<std::size_t>(place)]; }

    std::vector<int> order_;
    std::vector<PlaneTree> rounds_;
};

}  // namespace whitted::halfspaces
