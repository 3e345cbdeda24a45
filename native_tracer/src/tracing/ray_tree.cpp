#include "tracing/ray_tree.h"

#include <stdexcept>
#include <string>

namespace whitted {

RayTree::RayTree() = default;
RayTree::~RayTree() = default;

int RayTree::add() {
    if (records_.size() == most_rays) {
        throw std::length_error("this pixel's tree has more than " + std::to_string(most_rays) +
                                " rays; a larger cutoff or a smaller max_depth makes it shorter");
    }
    records_.emplace_back();
    return static_cast<int>(records_.size()) - 1;
}

RayRecord& RayTree::operator[](int index) { return records_[static_cast<std::size_t>(index)]; }

void RayTree::add_light(int index, const LightRecord& light) { (*this)[index].lights.push_back(light); }

const std::vector<RayRecord>& RayTree::records() const { return records_; }

}  // namespace whitted
