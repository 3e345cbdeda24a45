// A scene as it is given, in double: plain data.

#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "deviations.h"
#include "vector.h"

namespace student {

using Quadruple = std::array<double, 4>;

struct Camera {
    Triple eye, look_at, up;
    double fovy;  // degrees
};

struct Lamp {
    Triple position, color, attenuation;
};

enum class Pattern { solid, checker, texmap };

struct Pigment {
    Pattern pattern;
    Triple first, second;       // of a solid the first
    double size;                // of a checker
    int width, height;          // of a texture
    std::vector<float> texels;  // height x width x 3
    Quadruple p0, p1;
};

struct Finish {
    double ka, kd, ks, alpha, kr, kt;
    double eta;  // n1/n2, outside over inside
    double ior;  // as the file has it
};

struct Object {
    int pigment, finish;
    bool round;
    Triple center;  // of a sphere, as its radius
    double radius;
    std::vector<Quadruple> planes;  // of a polyhedron
    bool bounded;
};

struct Scene {
    Camera camera;
    Triple ambient, background;
    std::vector<Lamp> ambient_lamp;  // the file's first light, if it is known
    std::vector<Lamp> lamps;         // the others
    std::vector<Pigment> pigments;
    std::vector<Finish> finishes;
    std::vector<Object> objects;
    double cutoff;
    int max_depth;
};

// Whether it holds what a deviation needs to show.
inline bool holds(const Scene& scene, Applies needed) {
    const auto some = [](const auto& row, auto holds) { return std::any_of(row.begin(), row.end(), holds); };
    const auto finish = [&](auto member) {
        return some(scene.objects, [&](const Object& o) { return scene.finishes[std::size_t(o.finish)].*member > 0; });
    };
    const auto pattern = [&](Pattern wanted) {
        return some(scene.objects,
                    [&](const Object& o) { return scene.pigments[std::size_t(o.pigment)].pattern == wanted; });
    };
    const bool lamps = !scene.lamps.empty();
    switch (needed) {
        case Applies::always:
            return true;
        case Applies::lamps:
            return lamps && (finish(&Finish::kd) || finish(&Finish::ks));
        case Applies::lit:
            return !scene.ambient_lamp.empty() && (finish(&Finish::kd) || finish(&Finish::ks));
        case Applies::kd:
            return lamps && finish(&Finish::kd);
        case Applies::ks:
            return lamps && finish(&Finish::ks);
        case Applies::attenuated:
            return some(scene.lamps, [](const Lamp& l) { return l.attenuation != Triple{1, 0, 0}; });
        case Applies::kr:
            return finish(&Finish::kr);
        case Applies::kt:
            return finish(&Finish::kt);
        case Applies::bounces:
            return finish(&Finish::kr) || finish(&Finish::kt);
        case Applies::glassy:
            return finish(&Finish::kr) && finish(&Finish::kt);
        case Applies::checker:
            return pattern(Pattern::checker);
        case Applies::texmap:
            return pattern(Pattern::texmap);
        case Applies::polyhedra:
            return some(scene.objects, [](const Object& o) { return !o.round; });
        case Applies::spheres:
            return some(scene.objects, [](const Object& o) { return o.round; });
    }
    return true;
}

}  // namespace student
