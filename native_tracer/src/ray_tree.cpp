#include "ray_tree.h"

namespace whitted {

RayTree::RayTree() = default;
RayTree::~RayTree() = default;

int RayTree::add() {
    records_.emplace_back();
    return static_cast<int>(records_.size()) - 1;
}

RayRecord& RayTree::operator[](int index) { return records_[static_cast<std::size_t>(index)]; }

void RayTree::add_light(int index, const LightRecord& light) { (*this)[index].lights.push_back(light); }

const std::vector<RayRecord>& RayTree::records() const { return records_; }

}  // namespace whitted
