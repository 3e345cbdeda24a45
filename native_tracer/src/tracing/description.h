// What the caller says: a scene and how to draw it, in plain doubles, before it is prepared for any precision.

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <variant>
#include <vector>

namespace whitted {

using Triple = std::array<double, 3>;
using Quadruple = std::array<double, 4>;

// ---- Scene --------------------------------------------------------------------------------------------------------

struct CameraDescription {
    Triple eye{0, 0, 0};
    Triple look_at{0, 0, -1};
    Triple up{0, 1, 0};
    double fovy = 90;     // degrees, the full vertical angle
    double aperture = 0;  // radius of the lens; 0: a pinhole
    double focal = 1;     // distance, along the view direction, of what is in focus
};

struct LightDescription {
    Triple position;
    Triple color;
    Triple attenuation;  // a, b, c of 1 / (a + b d + c d^2)
    double radius = 0;   // of a disc that faces the point being lit
};

struct SolidDescription {
    Triple color;
};

struct CheckerDescription {
    Triple first, second;
    double size;
};

struct TexmapDescription {
    int width, height;
    std::vector<float> texels;  // height x width x 3
    Quadruple p0, p1;
};

using PigmentDescription = std::variant<SolidDescription, CheckerDescription, TexmapDescription>;

struct FinishDescription {
    double ka, kd, ks, alpha, kr, kt;
    double eta;       // n1/n2, outside over inside
    double cone = 0;  // degrees, half the angle of the cone in which mirrored and transmitted rays are spread
};

struct SphereDescription {
    Triple center;
    double radius;
};

struct PolyhedronDescription {
    std::vector<Quadruple> planes;  // a, b, c, d of a x + b y + c z + d <= 0
};

struct QuadricDescription {
    // A to J of A x^2 + B y^2 + C z^2 + D x y + E x z + F y z + G x + H y + I z + J <= 0
    std::array<double, 10> coefficients;
};

using LeafDescription = std::variant<SphereDescription, PolyhedronDescription, QuadricDescription>;

// Leaves, and a Boolean expression over them in postfix order: a leaf's number pushes it, an operation takes the last
// two.
struct CsgDescription {
    static constexpr int unite = -1, subtract = -2, intersect = -3;  // other numbers are leaves
    std::vector<LeafDescription> leaves;
    std::vector<int> program;
};

inline constexpr std::size_t most_csg_leaves = 64;
inline constexpr std::size_t deepest_csg_stack = 64;  // of an expression that is worked out

using BodyDescription = std::variant<SphereDescription, PolyhedronDescription, QuadricDescription, CsgDescription>;

// A body that at time u, from 0 to 1, stands at its place plus u times its displacement.
struct MovingDescription {
    BodyDescription body;
    Triple displacement;
};

using ShapeDescription =
    std::variant<SphereDescription, PolyhedronDescription, QuadricDescription, CsgDescription, MovingDescription>;

struct ObjectDescription {
    int pigment, finish;
    ShapeDescription shape;
};

struct SceneDescription {
    CameraDescription camera;
    Triple ambient{0, 0, 0};
    Triple background{0, 0, 0};
    std::vector<LightDescription> lights;
    std::vector<PigmentDescription> pigments;
    std::vector<FinishDescription> finishes;
    std::vector<ObjectDescription> objects;
};

// ---- How to draw it -----------------------------------------------------------------------------------------------

enum class Precision { single, double_, extended };  // float, double, long double

// How the objects are searched: one by one, or by a tree over their boxes; by default whichever is faster.
enum class Search { automatic, brute, bvh };

// The part of a picture that is drawn: the column and row of its first pixel, and its columns. Tiles, and what is kept
// for each pixel, are the part's own.
struct PicturePart {
    int left, top, width;
};

struct RenderSettings {
    int width, height;  // of the whole picture
    PicturePart part;
    int grid = 1;  // grid x grid rays a pixel
    std::uint32_t seed = 0;
    bool independent = false;  // a pixel's points, rather than stratified
    bool corner = true;
    bool blinn = false;
    double cutoff = 0;
    int max_depth = 0;
    Precision precision = Precision::double_;
    Search search = Search::automatic;
};

// ---- What comes out besides the picture ---------------------------------------------------------------------------

struct RayCounts {
    std::uint64_t primary = 0, reflected = 0, transmitted = 0, shadow = 0;
    std::uint64_t pixels_too_deep = 0;  // in which the depth limit dropped a ray that the cut-off would have kept
    int deepest = 0;
};

}  // namespace whitted
