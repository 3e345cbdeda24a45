// The rays of one pixel, as the tracer traced them: what explains a pixel's colour.

#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "tracing/description.h"

namespace whitted {

enum class RayKind : std::uint8_t { primary, reflected, transmitted };

// What became of a ray's successor of some kind.
enum class Successor : std::uint8_t { none, traced, below_cutoff, too_deep };

// The part of one light in the colour of a point.
struct LightRecord {
    int light;
    double cosine;
    double attenuation;  // what the light's colour is divided by
    int occluder;        // an object in its way; -1: none, or the surface is turned away from it
    Triple diffuse, specular;
};

struct RayRecord {
    RayKind kind = RayKind::primary;
    int parent = -1;  // -1: none
    int depth = 0;
    double weight = 1;
    Triple origin{}, direction{};
    double time = 0;

    int object = -1, plane = -1;  // what it hits; -1: nothing, and no polyhedron
    double t = 0;
    bool inside = false;  // it meets the surface from within
    Triple point{}, normal{}, pigment{};
    std::vector<LightRecord> lights;
    bool total_reflection = false;

    Triple local{};  // its colour without those of its successors
    Successor reflected = Successor::none, transmitted = Successor::none;
};

// Parents come before their successors. Nothing here is inline, for the tracer that fills it is compiled for processors
// that others may not have; see isa.h.
class RayTree {
 public:
    RayTree();
    ~RayTree();
    RayTree(const RayTree&) = delete;
    RayTree& operator=(const RayTree&) = delete;

    // Nobody reads larger trees, and the largest that a scene asks for would not fit into memory.
    static constexpr std::size_t most_rays = std::size_t{1} << 20;

    // Adds a record and returns its index. Throws std::length_error when there are too many.
    int add();
    RayRecord& operator[](int index);
    void add_light(int index, const LightRecord& light);
    const std::vector<RayRecord>& records() const;

 private:
    std::vector<RayRecord> records_;
};

}  // namespace whitted
