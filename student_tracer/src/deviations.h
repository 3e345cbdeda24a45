// The table of deviations, and a set of them.

#pragma once

#include <bitset>
#include <cstddef>
#include <iterator>

namespace student {

// What a scene has to hold for a deviation to show.
enum class Applies {
    always,
    lamps,
    lit,  // lamps and something that answers them
    kd,
    ks,
    attenuated,  // a lamp whose attenuation is not 1 0 0
    kr,
    kt,
    bounces,  // kr or kt
    glassy,   // kt, and kr in some finish
    checker,
    texmap,
    polyhedra,
    spheres,
};

struct Deviation {
    const char *name, *part, *group;
    Applies applies;
    const char *sentence, *hint;
};

inline constexpr Deviation deviations[] = {
#define DEVIATION(name, part, group, applies, sentence, hint) {#name, #part, group, Applies::applies, sentence, hint},
#include "deviations.def"
#undef DEVIATION
};

inline constexpr std::size_t deviation_count = std::size(deviations);

// By name, in the order of the table.
enum class On {
#define DEVIATION(name, part, group, applies, sentence, hint) name,
#include "deviations.def"
#undef DEVIATION
};

// Those that a tracer has.
class Switches {
 public:
    bool operator()(On deviation) const { return bits_[static_cast<std::size_t>(deviation)]; }
    void set(std::size_t index) { bits_.set(index); }

 private:
    std::bitset<deviation_count> bits_;
};

}  // namespace student
