// The scene as the tracer has it, with all that switches make of its objects, its lights and how far rays are followed.

#pragma once

#include <iterator>
#include <vector>

#include "deviations.h"
#include "scene.h"
#include "shapes.h"
#include "vector.h"

namespace student {

template <typename Real>
class World {
 public:
    World(const Scene& described, const Switches& switches)
        : scene(described),
          on(switches),
          lamps(described.lamps),
          ambient(vector_of<Real>(described.ambient)),
          background(vector_of<Real>(described.background)),
          cutoff(static_cast<Real>(described.cutoff)),
          max_depth(described.max_depth) {
        for (const Object& object : scene.objects) {
            bodies.emplace_back(object, on);
        }
        set_lights();
        set_depth();
        epsilon = on(On::epsilon_thousandth)  ? Real(1e-3)
                  : on(On::epsilon_hundredth) ? Real(1e-2)
                  : on(On::epsilon_tenth)     ? Real(1e-1)
                  : on(On::epsilon_none)      ? Real(0)
                                              : Real(-1);
    }

    const Finish& finish_of(int object) const {
        return scene.finishes[std::size_t(scene.objects[std::size_t(object)].finish)];
    }
    const Pigment& pigment_of(int object) const {
        return scene.pigments[std::size_t(scene.objects[std::size_t(object)].pigment)];
    }

    // Where the file has a lamp, which may begin with the ambient light here.
    int number_of(std::size_t lamp) const {
        return static_cast<int>(lamp) - (on(On::ambient_is_lamp) && !scene.ambient_lamp.empty() ? 1 : 0);
    }

    Hit<Real> nearest_hit(const Ray<Real>& ray) const {
        Hit<Real> nearest;
        for (int i = 0; i < static_cast<int>(bodies.size()); ++i) {
            const Hit<Real> hit = meet(bodies[std::size_t(i)], i, ray, on);
            if (hit.object >= 0 && (hit.t < nearest.t || on(On::last_object_wins))) {
                nearest = hit;
                if (on(On::first_object_wins)) {
                    break;
                }
            }
        }
        return nearest;
    }

    const Scene& scene;
    const Switches& on;
    std::vector<Body<Real>> bodies;
    std::vector<Lamp> lamps;
    Color<Real> ambient, background;
    Real cutoff;
    int max_depth;
    Real epsilon;  // fixed distance in which hits are ignored, negative: what a ray starts on is known instead

 private:
    void set_lights() {
        if (on(On::ambient_from_lamp) && !lamps.empty()) {
            ambient = vector_of<Real>(lamps.front().color);
        }
        if (on(On::background_black)) {
            background = {0, 0, 0};
        } else if (on(On::background_white)) {
            background = {1, 1, 1};
        } else if (on(On::background_grey)) {
            background = {Real(0.5), Real(0.5), Real(0.5)};
        } else if (on(On::background_lamp) && !lamps.empty()) {
            background = vector_of<Real>(lamps.front().color);
        }
        if (on(On::first_lamp_only) && lamps.size() > 1) {
            lamps.erase(lamps.begin() + 1, lamps.end());
        } else if (on(On::last_lamp_missing) && !lamps.empty()) {
            lamps.pop_back();
        }
        if (on(On::ambient_is_lamp)) {
            lamps.insert(lamps.begin(), scene.ambient_lamp.begin(), scene.ambient_lamp.end());
        }
    }

    void set_depth() {
        constexpr On depths[] = {On::depth_0, On::depth_1, On::depth_2, On::depth_3,
                                 On::depth_4, On::depth_5, On::depth_6};
        for (int depth = 0; depth < static_cast<int>(std::size(depths)); ++depth) {
            if (on(depths[depth])) {
                max_depth = depth;
                cutoff = 0;
            }
        }
        if (on(On::cutoff_lower)) {
            cutoff /= 16;
        }
    }
};

}  // namespace student
