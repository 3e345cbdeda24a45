// A tree of boxes around bodies (Kay and Kajiya 1986), whose tests never miss a body that a ray may meet.

#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "plain.h"
#include "scene.h"

namespace certified {

class Tree {
 public:
    explicit Tree(const Scene& scene) {
        for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
            const Body& body = scene.bodies[i];
            const Box box{body.low, body.high};
            if (std::isfinite(box.low[0] + box.high[0] + box.low[1] + box.high[1] + box.low[2] + box.high[2])) {
                order_.push_back(boxes_.size());
                boxes_.push_back(box);
                bodies_.push_back(static_cast<int>(i));
            } else {
                boundless_.push_back(static_cast<int>(i));
            }
        }
        // Those around others are searched when these have been.
        const double all = boxes_.empty() ? 0 : area(hull(0, boxes_.size()));
        const auto small =
            std::partition(order_.begin(), order_.end(), [&](std::size_t i) { return 2 * area(boxes_[i]) > all; });
        large_ = static_cast<std::size_t>(small - order_.begin());
        if (large_ < order_.size()) {
            build(large_, order_.size());
        }
    }

    // Calls visit(body, near) for every body that the ray may meet before `reach()`; near: not before that distance.
    template <typename Visit, typename Reach>
    void search(const PlainRay& ray, const Visit& visit, const Reach& reach) const {
        double near;
        if (!nodes_.empty()) {
            std::array<int, 64> stack;
            std::size_t depth = 1;
            stack[0] = 0;
            while (depth > 0) {
                const Node& node = nodes_[static_cast<std::size_t>(stack[--depth])];
                if (!may_meet(ray, node.box.low, node.box.high, reach(), near)) {
                    continue;
                }
                if (node.body >= 0) {
                    visit(node.body, near);
                    continue;
                }
                const int first = node.second - node.left_size;
                const bool forward = ray.axes[node.axis].sign >= 0;
                stack[depth++] = forward ? node.second : first;
                stack[depth++] = forward ? first : node.second;
            }
        }
        for (const int body : boundless_) {
            visit(body, 0.0);
        }
        for (std::size_t i = 0; i < large_; ++i) {
            const Box& box = boxes_[order_[i]];
            if (may_meet(ray, box.low, box.high, reach(), near)) {
                visit(bodies_[order_[i]], near);
            }
        }
    }

 private:
    struct Box {
        std::array<double, 3> low, high;
    };

    struct Node {
        Box box;
        int body = -1;
        int second = 0, left_size = 0;
        std::size_t axis = 0;  // by which they are halves
    };

    // Of the boxes of some in order.
    Box hull(std::size_t first, std::size_t last) const {
        Box box = boxes_[order_[first]];
        for (std::size_t i = first + 1; i < last; ++i) {
            const Box& other = boxes_[order_[i]];
            for (std::size_t axis = 0; axis < 3; ++axis) {
                box.low[axis] = std::min(box.low[axis], other.low[axis]);
                box.high[axis] = std::max(box.high[axis], other.high[axis]);
            }
        }
        return box;
    }

    static double area(const Box& box) {
        const double x = box.high[0] - box.low[0], y = box.high[1] - box.low[1], z = box.high[2] - box.low[2];
        return x * y + y * z + z * x;
    }

    // In halves by the longest axis: few bodies are searched.
    int build(std::size_t first, std::size_t last) {
        const auto index = static_cast<int>(nodes_.size());
        nodes_.emplace_back();
        const Box box = hull(first, last);
        int body = -1, second = 0, left_size = 0;
        std::size_t axis = 0;
        if (last - first == 1) {
            body = bodies_[order_[first]];
        } else {
            for (std::size_t k = 1; k < 3; ++k) {
                axis = box.high[k] - box.low[k] > box.high[axis] - box.low[axis] ? k : axis;
            }
            const std::size_t half = (first + last) / 2;
            const auto at = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
            std::nth_element(at(first), at(half), at(last), [&](std::size_t i, std::size_t j) {
                return boxes_[i].low[axis] + boxes_[i].high[axis] < boxes_[j].low[axis] + boxes_[j].high[axis];
            });
            const int left = build(first, half);
            second = build(half, last);
            left_size = second - left;
        }
        nodes_[static_cast<std::size_t>(index)] = {box, body, second, left_size, axis};
        return index;
    }

    std::vector<Box> boxes_;
    std::vector<int> bodies_, boundless_;
    std::vector<std::size_t> order_;
    std::size_t large_ = 0;  // the first of these in order
    std::vector<Node> nodes_;
};

}  // namespace certified
