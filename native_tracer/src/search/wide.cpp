#include "search/wide.h"

#include <cstddef>

namespace whitted {

namespace {

// Half the surface.
double area(const Box& box) {
    const double x = box.high[0] - box.low[0];
    const double y = box.high[1] - box.low[1];
    const double z = box.high[2] - box.low[2];
    return x * (y + z) + y * z;
}

}  // namespace

// A node with no more items than there is room for has all of them. Others begin with their two children in the binary
// tree, and while there is room the largest with too many items is replaced by its own two.
int collapse(const SearchPlan& plan, std::uint32_t node, int width, WideChild* children) {
    const std::vector<BvhNode>& nodes = plan.tree.nodes;
    const auto most = static_cast<std::uint32_t>(width);
    const auto child_of = [&](std::uint32_t index) {
        const BvhNode& child = nodes[index];
        return child.count == 1 ? WideChild{child.box, child.first, true} : WideChild{child.box, index, false};
    };
    int count = 0;
    if (nodes[node].count <= most || nodes[node].children == 0) {
        for (; count < static_cast<int>(nodes[node].count); ++count) {
            const std::uint32_t item = nodes[node].first + static_cast<std::uint32_t>(count);
            children[count] = {plan.boxes[item], item, true};
        }
        return count;
    }
    const auto put_children_of = [&](std::uint32_t parent, int first, int second) {
        children[first] = child_of(nodes[parent].children);
        children[second] = child_of(nodes[parent].children + 1);
    };
    put_children_of(node, 0, 1);
    for (count = 2; count < width; ++count) {
        int largest = -1;
        double size = -1;
        for (int i = 0; i < count; ++i) {
            if (!children[i].is_item && nodes[children[i].index].count > most && area(children[i].box) > size) {
                size = area(children[i].box);
                largest = i;
            }
        }
        if (largest < 0) {
            break;
        }
        put_children_of(children[largest].index, largest, count);
    }
    return count;
}

}  // namespace whitted
