// What the caller says: a scene and how to draw it. Numbers are those of the file, and not the doubles next to them.

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace certified {

// A number within `error` of the sum of some doubles: 0.3 is the double next to it, what that misses, and so on.
struct Number {
    std::vector<double> parts;
    double error = 0;
};

using Triple = std::array<Number, 3>;

struct Light {
    Triple position, color, attenuation;
};

enum class Pattern { solid, checker, texmap };

struct Pigment {
    Pattern pattern;
    Triple first, second;  // a checker's; a solid has the first
    Number size;
    int width = 0, height = 0;
    std::vector<unsigned short> texels;  // height x width x 3, of `largest`
    int largest = 255;
    std::array<Number, 4> columns, rows;  // of the point, and 1
};

struct Finish {
    Number ka, kd, ks, alpha, kr, kt, ior;
    bool ior_is_index;  // n2/n1, and not n1/n2
};

enum class Kind { sphere, plane, quadric };

// A sphere has its centre and radius, a plane a to d, a quadric A to J. Surfaces of one plane have one `identity`, and
// so have equal spheres and quadrics: what is true of one is true of the other, whatever the roundings. `eye` and
// `lights` say what lies on it. All points of a plane across an axis have one coordinate, which lies in one known layer
// of tiles of the body's checker: it may be where two of them meet.
struct Surface {
    Kind kind;
    std::vector<Number> numbers;
    int identity;
    bool eye;
    std::vector<bool> lights;
    int axis = -1;
    std::int64_t layer = 0;
};

// A sphere, a quadric, or where all of some planes are.
struct Leaf {
    std::size_t first, count;
};

// An expression over leaves in postfix order: numbers from 0 are leaves, others operations. Of one leaf it has none.
struct Body {
    static constexpr int unite = -1, subtract = -2, intersect = -3;
    int pigment, finish;
    std::vector<std::size_t> leaves;
    std::vector<int> program;
    std::array<double, 3> low, high;  // of a box around it; infinite where there is none
};

struct Scene {
    Triple eye, look_at, up;
    Number fovy;
    Triple ambient, background;
    Number cutoff;
    int max_depth = 0;
    int width = 0, height = 0, grid = 1;
    bool corner = true, blinn = false;
    bool ties = true;  // whether numbers are of a size for which the last rung can tell a tie
    std::vector<Light> lights;
    std::vector<Pigment> pigments;
    std::vector<Finish> finishes;
    std::vector<Surface> surfaces;
    std::vector<Leaf> leaves;
    std::vector<Body> bodies;
};

}  // namespace certified
