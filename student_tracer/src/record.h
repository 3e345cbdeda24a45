// The rays of one pixel, for those who want to look at them.

#pragma once

#include <vector>

#include "scene.h"
#include "shapes.h"
#include "vector.h"

namespace student {

enum class Kind { primary, reflected, transmitted };

struct LightRecord {
    int light;  // of the file's lamps; -1: the ambient light, where it is counted as one
    double cosine, attenuation;
    int blocker;
    Triple diffuse, specular;
};

struct RayRecord {
    int parent = -1;  // -1: the primary ray
    Kind kind = Kind::primary;
    int depth = 0;
    double weight = 1;
    Triple origin{}, direction{};
    int object = -1, plane = -1;  // -1: nothing is hit, a sphere
    double t = 0;
    bool inside = false, total_reflection = false;
    Triple point{}, normal{}, pigment{}, local{};
    std::vector<LightRecord> lights;
    const char* reflected_dropped = nullptr;  // why it was not followed
    const char* transmitted_dropped = nullptr;
};

struct Record {
    std::vector<RayRecord> rays;

    template <typename Real>
    int add(int parent, Kind kind, int depth, double weight, const Ray<Real>& ray) {
        RayRecord& record = rays.emplace_back();
        record.parent = parent;
        record.kind = kind;
        record.depth = depth;
        record.weight = weight;
        record.origin = triple(ray.origin);
        record.direction = triple(ray.direction);
        return static_cast<int>(rays.size()) - 1;
    }

    template <typename Real>
    void hit(int index, const Hit<Real>& hit, Vector<Real> point, Vector<Real> normal, Color<Real> pigment,
             bool round) {
        RayRecord& ray = rays[std::size_t(index)];
        ray.object = hit.object;
        ray.plane = round ? -1 : hit.plane;
        ray.t = static_cast<double>(hit.t);
        ray.inside = hit.inside;
        ray.point = triple(point);
        ray.normal = triple(normal);
        ray.pigment = triple(pigment);
    }

    template <typename Real>
    void light(int index, int light, double cosine, double attenuation, int blocker, Color<Real> diffuse,
               Color<Real> specular) {
        rays[std::size_t(index)].lights.push_back(
            {light, cosine, attenuation, blocker, triple(diffuse), triple(specular)});
    }

    void drop(int index, Kind kind, bool light) {
        RayRecord& ray = rays[std::size_t(index)];
        (kind == Kind::reflected ? ray.reflected_dropped : ray.transmitted_dropped) = light ? "cutoff" : "depth";
    }
};

}  // namespace student
