// Trees with many children to a node, made of binary ones.

#pragma once

#include <cstdint>

#include "search/search.h"

namespace whitted {

// A child: a node of the binary tree that is a node of the wide one, too, or an item.
struct WideChild {
    Box box;
    std::uint32_t index;  // of the node, or of the item in the tree's order
    bool is_item;
};

// The children of a node in a tree of that width. Puts them into `children`, and returns how many they are.
int collapse(const SearchPlan& plan, std::uint32_t node, int width, WideChild* children);

}  // namespace whitted
