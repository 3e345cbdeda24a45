// Why a pixel is not certified.

#pragma once

namespace certified {

enum class Reason : unsigned char {
    none,        // it is
    byte,        // its colour's interval holds more than one byte
    hit,         // whether a ray meets a body, or which it meets first
    plane,       // which of a body's surfaces it meets
    tile,        // on which tile of a checker a point lies
    texel,       // on which texel of an image
    shadow,      // whether a body is in the way of a light
    facing,      // whether a light is before a surface or behind it
    reflection,  // whether a ray is reflected totally
    cutoff,      // whether a ray weighs enough to be followed
    division,    // by what may be 0
    range,       // numbers beyond those of a double
    degenerate,  // what no number of digits decides
    count_
};

inline constexpr const char* reason_names[] = {"none",     "byte",   "hit",       "plane",      "tile",
                                               "texel",    "shadow", "facing",    "reflection", "cutoff",
                                               "division", "range",  "degenerate"};

struct Undecided {
    Reason reason;
};

}  // namespace certified
