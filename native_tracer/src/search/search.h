// How the objects of a scene are searched for those that a ray crosses: all of them one by one, or, where they are
// many, by a tree over their boxes.

#pragma once

#include <vector>

#include "search/bvh.h"
#include "tracing/description.h"

namespace whitted {

struct SearchPlan {
    bool forced = false;  // a tree was asked for: all is done that a search by trees can do, also where it does not pay
    Bvh tree;             // its items are indices of objects
    std::vector<Box> boxes;  // of its items, in the tree's order
    std::vector<int> apart;  // objects outside it, which every ray is tested against; ascending
    // A computation that is wrong by a distance d somewhere on an object in the tree is right somewhere in its box
    // widened by growth times d.
    double growth = 1;
    double reach = 0;  // no coordinate in the tree is larger, nor any plane that bounds its objects farther away
};

// Adds a tree over the boxes to its plan in which a csg's leaves matter; for numbers with so many digits.
struct CsgPlan;
void add_leaf_tree(const CsgDescription& csg, int digits, CsgPlan& plan);

SearchPlan plan_search(const SceneDescription& scene, Search search, Precision precision);

}  // namespace whitted
