#include "search/bvh.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

namespace whitted {

namespace {

Box no_box() {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    return {{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
}

void include(Box& box, const Box& other) {
    for (std::size_t k = 0; k < 3; ++k) {
        box.low[k] = std::min(box.low[k], other.low[k]);
        box.high[k] = std::max(box.high[k], other.high[k]);
    }
}

// Half the surface.
double area(const Box& box) {
    const double x = box.high[0] - box.low[0];
    const double y = box.high[1] - box.low[1];
    const double z = box.high[2] - box.low[2];
    return x * (y + z) + y * z;
}

class Builder {
 public:
    Builder(std::span<const Box> boxes, std::uint32_t leaf_size)
        : boxes_(boxes), leaf_size_(leaf_size), heuristic_depth_(2 * static_cast<int>(std::bit_width(boxes.size()))) {
        // Lengths are taken in a unit in which neither they nor their products overflow.
        double largest = 0;
        for (const Box& box : boxes) {
            for (std::size_t k = 0; k < 3; ++k) {
                largest = std::max({largest, std::abs(box.low[k]), std::abs(box.high[k])});
            }
        }
        const double unit = largest > 0 ? std::ldexp(1.0, std::clamp(-std::ilogb(largest) - 2, -1021, 1021)) : 1;
        items_.reserve(boxes.size());
        for (const Box& box : boxes) {
            Item item{box, {}, static_cast<std::uint32_t>(items_.size())};
            double size = std::numeric_limits<double>::min();
            for (std::size_t k = 0; k < 3; ++k) {
                const double low = item.box.low[k] *= unit;
                const double high = item.box.high[k] *= unit;
                item.keys[k] = low + high;
                size = std::max(size, high - low);
            }
            // Its logarithm, with straight lines between the powers of two.
            int power;
            item.keys[3] = 2 * std::frexp(size, &power);
            item.keys[3] += power;
            items_.push_back(item);
        }
    }

    Bvh build() {
        Bvh tree;
        if (items_.empty()) {
            return tree;
        }
        tree.nodes.reserve(2 * items_.size());
        tree.nodes.push_back({{}, 0, static_cast<std::uint32_t>(items_.size())});
        split(tree.nodes, 0, bounds_of(0, items_.size()), 0);
        tree.order.reserve(items_.size());
        for (const Item& item : items_) {
            tree.order.push_back(item.index);
        }
        for (std::size_t i = tree.nodes.size(); i-- > 0;) {
            finish(tree, tree.nodes[i]);
        }
        return tree;
    }

 private:
    struct Item {
        Box box;
        std::array<double, 4> keys;  // by which items are split: the centre, and the size
        std::uint32_t index;
    };

    struct Bounds {
        Box box = no_box();
        std::array<double, 4> low, high;  // of the keys

        Bounds() {
            low.fill(std::numeric_limits<double>::infinity());
            high.fill(-std::numeric_limits<double>::infinity());
        }
        void include(const Item& item) {
            whitted::include(box, item.box);
            for (std::size_t k = 0; k < 4; ++k) {
                low[k] = std::min(low[k], item.keys[k]);
                high[k] = std::max(high[k], item.keys[k]);
            }
        }
    };

    struct Split {
        double cost;  // area times number, over both sides
        std::size_t key = 0;
        double low = 0, factor = 0;
        std::size_t last = 0;  // bin of the first side

        std::size_t bin(const Item& item) const { return static_cast<std::size_t>((item.keys[key] - low) * factor); }
    };

    static constexpr std::size_t most_bins = 16;
    // Looking into a node, at the boxes of both its children, against looking at an item.
    static constexpr double visit_cost = 1;

    Bounds bounds_of(std::size_t first, std::size_t end) const {
        Bounds bounds;
        for (std::size_t i = first; i < end; ++i) {
            bounds.include(items_[i]);
        }
        return bounds;
    }

    void split(std::vector<BvhNode>& nodes, std::size_t index, const Bounds& bounds, int depth) {
        const std::size_t first = nodes[index].first;
        const std::size_t count = nodes[index].count;
        if (count <= 1) {
            return;
        }
        const double size = area(bounds.box);
        Split best{std::numeric_limits<double>::infinity()};
        if (depth < heuristic_depth_) {
            find_split(first, count, bounds, best);
        }
        if (count <= leaf_size_ && !(best.cost + visit_cost * size < static_cast<double>(count) * size)) {
            return;
        }
        const auto begin = items_.begin() + static_cast<std::ptrdiff_t>(first);
        const auto end = begin + static_cast<std::ptrdiff_t>(count);
        auto middle = begin + static_cast<std::ptrdiff_t>(count / 2);
        if (best.factor > 0) {
            middle = std::partition(begin, end, [&](const Item& item) { return best.bin(item) <= best.last; });
        } else {
            std::nth_element(begin, middle, end, [](const Item& a, const Item& b) { return a.index < b.index; });
        }
        const auto border = static_cast<std::size_t>(middle - items_.begin());
        const Bounds halves[] = {bounds_of(first, border), bounds_of(border, first + count)};
        const std::size_t children = nodes.size();
        nodes[index].children = static_cast<std::uint32_t>(children);
        nodes.push_back({{}, static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(border - first)});
        nodes.push_back({{}, static_cast<std::uint32_t>(border), static_cast<std::uint32_t>(first + count - border)});
        split(nodes, children, halves[0], depth + 1);
        split(nodes, children + 1, halves[1], depth + 1);
    }

    // The cheapest split between two bins; none, with a factor of 0, if all items have the same keys.
    void find_split(std::size_t first, std::size_t count, const Bounds& bounds, Split& best) const {
        const std::size_t bins = std::min(most_bins, count);
        for (std::size_t key = 0; key < 4; ++key) {
            // Below the number of bins for the last item too, whatever is rounded.
            Split split{0, key, bounds.low[key],
                        static_cast<double>(bins) * (1 - 0x1p-40) / (bounds.high[key] - bounds.low[key])};
            if (!std::isfinite(split.factor)) {
                continue;
            }
            std::array<Box, most_bins> boxes;
            std::array<std::size_t, most_bins> counts;
            std::fill_n(boxes.begin(), bins, no_box());
            std::fill_n(counts.begin(), bins, 0);
            for (std::size_t i = first; i < first + count; ++i) {
                const std::size_t bin = split.bin(items_[i]);
                include(boxes[bin], items_[i].box);
                ++counts[bin];
            }
            std::array<double, most_bins> costs;  // of a second side from a bin on
            Box side = no_box();
            std::size_t number = 0;
            for (std::size_t bin = bins - 1; bin > 0; --bin) {
                include(side, boxes[bin]);
                number += counts[bin];
                costs[bin] = area(side) * static_cast<double>(number);
            }
            side = no_box();
            number = 0;
            for (std::size_t bin = 0; bin + 1 < bins; ++bin) {
                include(side, boxes[bin]);
                number += counts[bin];
                split.cost = area(side) * static_cast<double>(number) + costs[bin + 1];
                if (split.cost < best.cost) {
                    split.last = bin;
                    best = split;
                }
            }
        }
    }

    // With its children finished: the exact box, and which child comes first.
    void finish(Bvh& tree, BvhNode& node) const {
        node.box = no_box();
        if (node.children == 0) {
            const auto items = tree.order.begin() + static_cast<std::ptrdiff_t>(node.first);
            std::sort(items, items + static_cast<std::ptrdiff_t>(node.count));
            for (std::size_t i = 0; i < node.count; ++i) {
                include(node.box, boxes_[items[static_cast<std::ptrdiff_t>(i)]]);
            }
            return;
        }
        BvhNode& a = tree.nodes[node.children];
        BvhNode& b = tree.nodes[node.children + 1];
        include(node.box, a.box);
        include(node.box, b.box);
        double most = -1;
        bool swapped = false;
        for (std::uint32_t k = 0; k < 3; ++k) {
            // Half of each, for the sum may overflow.
            const double apart =
                (0.5 * b.box.low[k] - 0.5 * a.box.low[k]) + (0.5 * b.box.high[k] - 0.5 * a.box.high[k]);
            if (std::abs(apart) > most) {
                most = std::abs(apart);
                swapped = apart < 0;
                node.axis = k;
            }
        }
        if (swapped) {
            std::swap(a, b);
        }
    }

    const std::span<const Box> boxes_;
    const std::uint32_t leaf_size_;
    const int heuristic_depth_;
    std::vector<Item> items_;
};

}  // namespace

Bvh build_bvh(std::span<const Box> boxes, std::uint32_t leaf_size) { return Builder(boxes, leaf_size).build(); }

ThreadedBvh thread_bvh(const Bvh& tree) {
    const std::size_t size = tree.nodes.size();
    ThreadedBvh threaded;
    threaded.corners.resize(8 * size * 6);
    threaded.skip.resize(8 * size);
    threaded.item.resize(8 * size);
    if (size == 0) {
        return threaded;
    }
    // Where each node comes within a block. A node with n items has 2 n - 1 nodes below it, itself counted.
    std::vector<std::uint32_t> place(size);
    for (unsigned octant = 0; octant < 8; ++octant) {
        for (std::size_t i = 0; i < size; ++i) {
            const BvhNode& node = tree.nodes[i];
            const std::size_t at = octant * size + place[i];
            const auto corner = threaded.corners.begin() + static_cast<std::ptrdiff_t>(6 * at);
            std::copy_n(node.box.high.begin(), 3, std::copy_n(node.box.low.begin(), 3, corner));
            threaded.skip[at] = place[i] + 2 * node.count - 1;
            threaded.item[at] = node.children == 0 ? tree.order[node.first] : ThreadedBvh::no_item;
            if (node.children != 0) {
                const std::size_t far_side = octant >> node.axis & 1U ? 0 : 1;
                const std::size_t near = node.children + (1 - far_side);
                place[near] = place[i] + 1;
                place[node.children + far_side] = place[i] + 2 * tree.nodes[near].count;
            }
        }
    }
    return threaded;
}

}  // namespace whitted
