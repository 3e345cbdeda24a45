// A scene, prepared for one precision, and the two questions rays ask of it: what is hit first, and whether anything
// is in the way.

#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <variant>
#include <vector>

#include "camera.h"
#include "description.h"
#include "incidence.h"
#include "pigment.h"
#include "rounding.h"
#include "search.h"
#include "surface.h"
#include "tree.h"

namespace whitted::WHITTED_ISA {

// The spheres outside the tree, as seen from one point.
template <typename Real>
using View = std::vector<Sight<Real>>;

// A patch that a point lies on, the eye or a light.
template <typename Real>
struct Contact {
    int object, patch;
    Vector<Real> outward;  // the surface's unit normal there
    bool round;
};

template <typename Real>
struct Light {
    using L = Lanes<Real>;
    Vector<Real> position;
    Color<Real> color;
    Real a, b, c;  // dimmed by 1 / (a + b d + c d^2) at distance d
    View<Real> view;
    std::vector<Contact<Real>> contacts;

    // Whether rays that lead to the light cross an object there, at its surface that the light lies on, and no sooner:
    // a plane wherever they do, a sphere where they reach the light from within, or from without by its near side.
    Mask<Real> lies_at(const Crossing<Real>& crossing, const Vector<L>& direction) const {
        Mask<Real> result = Mask<Real>::none();
        for (const Contact<Real>& contact : contacts) {
            const Mask<Real> arrives = crossing.inside | (dot(Vector<L>(contact.outward), direction) < L(Real(0)));
            result |= (crossing.patch == Indices<Real>(contact.patch)) & arrives;
        }
        return result;
    }

    // Whether the light lies in the plane of these patches, and so shines along them.
    Mask<Real> grazes(Indices<Real> patch) const {
        Mask<Real> result = Mask<Real>::none();
        for (const Contact<Real>& contact : contacts) {
            if (!contact.round) {
                result |= patch == Indices<Real>(contact.patch);
            }
        }
        return result;
    }
};

// What rays from the eye start on, as rays that leave a surface do. Of several objects that the eye lies on it is the
// first.
template <typename Real>
struct EyeContact {
    int object = -1, patch = -1;
    std::vector<Vector<Real>> outward;  // of all the object's patches that the eye lies on
    Real curvature = 0;

    // Rays along a plane, too, for a body is closed; not those that touch a sphere. Eye and directions may be off.
    Mask<Real> leads_inside(const Vector<Lanes<Real>>& direction, Real eye_error, Real spread) const {
        const Real bound = curvature > 0 ? -(spread + curvature * eye_error) : spread;
        Mask<Real> result = outward.empty() ? Mask<Real>::none() : ~Mask<Real>::none();
        for (const Vector<Real>& normal : outward) {
            result &= dot(Vector<Lanes<Real>>(normal), direction) < Lanes<Real>(bound);
        }
        return result;
    }
};

template <typename Real>
struct Finish {
    Real ka, kd, ks, alpha, kr, kt;
    Real eta;  // n1/n2, outside over inside
};

template <typename Real>
struct Object {
    Finish<Real> finish;
    const Pigment<Real>* pigment;
    int first_patch;
};

template <typename Real>
struct Hits {
    Lanes<Real> t = std::numeric_limits<Real>::infinity();
    Indices<Real> object = -1;  // -1: nothing is hit
    Indices<Real> patch = -1;
    Mask<Real> inside = Mask<Real>::none();
};

// The surface that rays have hit.
template <typename Real>
struct Surface {
    using L = Lanes<Real>;
    Mask<Real> hit;
    Vector<L> point, outward, normal;  // `normal` is turned toward the viewer
    L error;                           // a bound of `point`'s rounding error, for t_min
    L lean;                            // how far the normal may be off
    Color<L> pigment;
    L ka, kd, ks, alpha, kr, kt, eta;
};

// Puts the lanes of `other` that the mask names into `surface`.
template <typename Real>
void merge(Mask<Real> mask, const Surface<Real>& other, Surface<Real>& surface) {
    const auto put = [&](auto member) { surface.*member = select(mask, other.*member, surface.*member); };
    using S = Surface<Real>;
    put(&S::point);
    put(&S::outward);
    put(&S::normal);
    put(&S::error);
    put(&S::pigment);
    for (const auto member : {&S::lean, &S::ka, &S::kd, &S::ks, &S::alpha, &S::kr, &S::kt, &S::eta}) {
        put(member);
    }
}

template <typename Real>
struct Scene {
    Color<Real> ambient, background;
    View<Real> eye_view;
    EyeContact<Real> eye_contact;
    std::vector<Light<Real>> lights;
    std::vector<Pigment<Real>> pigments;
    std::vector<Object<Real>> objects;
    std::vector<Patch<Real>> patches;
    // Those outside the tree come first, the rest in the order of its leaves.
    std::vector<Sphere<Real>> spheres;
    std::vector<Polyhedron<Real>> polyhedra;
    Tree<Real> tree;
    int spheres_apart, polyhedra_apart;

    Scene(const SceneDescription& description, const SearchPlan& plan);
    Scene(const Scene&) = delete;  // objects point to pigments

    // The nearest hit of each ray; of objects at the same distance, the first of the file; for the rays in `wanted`,
    // which start where `view` was made from, if it is given.
    Hits<Real> nearest_hit(const Rays<Real>& rays, Mask<Real> wanted, const View<Real>* view) const {
        Hits<Real> hits;
        Lanes<Real> limit = select(wanted, hits.t, Lanes<Real>(Real(-1)));
        Lanes<Real> second = hits.t;
        Mask<Real> close = Mask<Real>::none();
        const auto may_hit = [&](int sphere) {
            return !view || any((*view)[static_cast<std::size_t>(sphere)].may_be_hit(rays.direction));
        };
        for_each_crossing<Ties::found>(
            rays, limit, close, may_hit, [&](Indices<Real> object, const Crossing<Real>& crossing) {
                const Mask<Real> nearer = (crossing.t < hits.t) | ((crossing.t <= hits.t) & (object < hits.object));
                second = min(second, max(crossing.t, hits.t));
                hits.t = select(nearer, crossing.t, hits.t);
                hits.object = select(nearer, object, hits.object);
                hits.patch = select(nearer, crossing.patch, hits.patch);
                hits.inside = select(nearer, crossing.inside, hits.inside);
                limit = min(hits.t, limit);
                return true;
            });
        const Lanes<Real> range = Lanes<Real>(most_blur<Real>) * (hits.t + rays.reach);
        close |= (second - hits.t <= range) | (hits.t < range);
        close &= wanted;
        if (any(close)) [[unlikely]] {
            const Hits<Real> settled = nearest_hit_by_rules(rays, close);
            hits.t = select(close, settled.t, hits.t);
            hits.object = select(close, settled.object, hits.object);
            hits.patch = select(close, settled.patch, hits.patch);
            hits.inside = select(close, settled.inside, hits.inside);
        }
        return hits;
    }

    // An object that is in the way of each ray before `distance`, or -1: nothing is; for the rays in `wanted`.
    Indices<Real> blocker(const Rays<Real>& rays, const Light<Real>& light, Lanes<Real> distance,
                          Mask<Real> wanted) const {
        Mask<Real> close = Mask<Real>::none();
        const auto may_hit = [&](int sphere, Mask<Real> open) {
            return any(open & light.view[static_cast<std::size_t>(sphere)].may_block(rays, distance));
        };
        Indices<Real> blocker = find_blocker<Ties::found_in_the_way>(rays, light, distance, wanted, close, may_hit);
        close &= wanted;
        if (any(close)) [[unlikely]] {
            blocker = select(close, blocker_by_rules(rays, light, distance, close), blocker);
        }
        return blocker;
    }

 private:
    // What becomes of rays that meet two things at once, but for rounding errors.
    enum class Ties { found, found_in_the_way, decided };

    // The first object of the file among those that tie with the nearest: the order in which they are visited does not
    // matter, also where one ties with two that do not tie with one another.
    [[gnu::noinline]] Hits<Real> nearest_hit_by_rules(const Rays<Real>& rays, Mask<Real> wanted) const {
        const Lanes<Real> nowhere = Real(-1);
        const Lanes<Real> infinity = std::numeric_limits<Real>::infinity();
        Mask<Real> close = wanted;
        const auto any_sphere = [](int) { return true; };
        Lanes<Real> nearest = infinity;
        Lanes<Real> error = Real(0);
        Lanes<Real> limit = select(wanted, infinity, nowhere);
        for_each_crossing<Ties::decided>(rays, limit, close, any_sphere,
                                         [&](Indices<Real>, const Crossing<Real>& crossing) {
                                             const Lanes<Real> its_error = distance_errors(rays, crossing);
                                             const Mask<Real> same = (crossing.t <= nearest) & (its_error > error);
                                             error = select((crossing.t < nearest) | same, its_error, error);
                                             nearest = min(crossing.t, nearest);
                                             limit = min(nearest, limit);
                                             return true;
                                         });
        Hits<Real> hits;
        limit = select(wanted, nearest + Lanes<Real>(most_blur<Real>) * (nearest + rays.reach), nowhere);
        for_each_crossing<Ties::decided>(
            rays, limit, close, any_sphere, [&](Indices<Real> object, const Crossing<Real>& crossing) {
                const Mask<Real> ties =
                    (crossing.t < infinity) & (crossing.t - nearest <= error + distance_errors(rays, crossing));
                const Mask<Real> first = ties & ((hits.object < Indices<Real>(0)) | (object < hits.object));
                hits.t = select(first, crossing.t, hits.t);
                hits.object = select(first, object, hits.object);
                hits.patch = select(first, crossing.patch, hits.patch);
                hits.inside = select(first, crossing.inside, hits.inside);
                return true;
            });
        hits.patch = Indices<Real>::gather([&](int lane) {
            return wanted[lane] && hits.object[lane] >= 0 ? piece_met(rays, hits, lane) : hits.patch[lane];
        });
        return hits;
    }

    // The first of a body's patches that a ray meets where it has hit the body, at an edge or elsewhere.
    int piece_met(const Rays<Real>& rays, const Hits<Real>& hits, int lane) const {
        const int hit = hits.patch[lane];
        const Real t = hits.t[lane];
        const Vector<Real> direction = lane_of(rays.direction, lane);
        const Vector<Real> p = lane_of(rays.origin, lane) + t * direction;
        const Real t_error = distance_error(rays, lane, hit, t);
        const bool starts_here = rays.object[lane] == hits.object[lane];
        for (int k = objects[static_cast<std::size_t>(hits.object[lane])].first_patch; k < hit; ++k) {
            const Patch<Real>& plane = patches[static_cast<std::size_t>(k)];
            const Real slope = dot(plane.anchor, direction);
            const Real error = blur(rays, lane, plane, t) + t_error * std::abs(slope);
            const bool meets = hits.inside[lane] ? slope > rays.spread[lane] : slope < -rays.spread[lane];
            if (meets && std::abs(dot(plane.anchor, p) + plane.size) <= error &&
                !(starts_here && rays.patch[lane] == k)) {
                return k;
            }
        }
        return hit;
    }

    [[gnu::noinline]] Indices<Real> blocker_by_rules(const Rays<Real>& rays, const Light<Real>& light,
                                                     Lanes<Real> distance, Mask<Real> wanted) const {
        Mask<Real> close = wanted;
        return find_blocker<Ties::decided>(rays, light, distance, wanted, close, [](int, Mask<Real>) { return true; });
    }

    template <Ties ties, typename MayHit>
    [[gnu::always_inline]] Indices<Real> find_blocker(const Rays<Real>& rays, const Light<Real>& light,
                                                      Lanes<Real> distance, Mask<Real> wanted, Mask<Real>& close,
                                                      MayHit may_hit) const {
        Indices<Real> blocker = -1;
        Mask<Real> open = wanted;
        // Crossings beyond it do not matter.
        const Lanes<Real> nowhere = Real(-1);
        Lanes<Real> limit = select(open, distance, nowhere);
        const auto may_block = [&](int sphere) { return may_hit(sphere, open); };
        const Lanes<Real> range = Lanes<Real>(most_blur<Real>) * rays.reach;
        for_each_crossing<ties>(
            rays, limit, close, may_block, [&](Indices<Real> object, const Crossing<Real>& crossing) {
                const Mask<Real> blocked = open & (crossing.t < distance) & ~light.lies_at(crossing, rays.direction);
                blocker = select(blocked, object, blocker);
                if (any(blocked & (crossing.t < range))) [[unlikely]] {
                    close |= blocked & (crossing.t < range);
                }
                open &= ~blocked;
                limit = select(open, limit, nowhere);
                return any(open);
            });
        return blocker;
    }

    // How far the distances of crossings may be off.
    Lanes<Real> distance_errors(const Rays<Real>& rays, const Crossing<Real>& crossing) const {
        return Lanes<Real>::gather([&](int lane) {
            const Real t = crossing.t[lane];
            return std::isfinite(t) ? std::min(distance_error(rays, lane, crossing.patch[lane], t),
                                               most_blur<Real> * (t + rays.reach[lane]))
                                    : Real(0);
        });
    }

    // How far a ray's distance to a patch may be off.
    Real distance_error(const Rays<Real>& rays, int lane, int index, Real t) const {
        const Patch<Real>& patch = patches[static_cast<std::size_t>(index)];
        const Vector<Real> direction = lane_of(rays.direction, lane);
        const Vector<Real> outward =
            patch.round ? normalize(lane_of(rays.origin, lane) + t * direction - patch.anchor) : patch.anchor;
        return blur(rays, lane, patch, t) / std::abs(dot(outward, direction));
    }

    // How far a ray and a patch may be off from one another, at distance t.
    static Real blur(const Rays<Real>& rays, int lane, const Patch<Real>& patch, Real t) {
        return rays.t_min[lane] + patch.error_at(rays.reach)[lane] + std::abs(t) * rays.spread[lane];
    }

    // Calls visit(object, crossing) for the objects that some ray crosses before `limit`, and maybe others, until it
    // returns false: the one place that knows how the objects are searched. visit may lower `limit`. Spheres outside
    // the tree are passed over where may_hit(sphere) is false. Ties with a polyhedron's planes are decided, or the rays
    // that have some are added to `close`.
    template <Ties ties, typename MayHit, typename Visit>
    [[gnu::always_inline]] void for_each_crossing(const Rays<Real>& rays, const Lanes<Real>& limit, Mask<Real>& close,
                                                  MayHit may_hit, Visit visit) const {
        Crossing<Real> crossing;
        const auto cross_sphere = [&](int sphere) __attribute__((always_inline)) {
            const Sphere<Real>& s = spheres[static_cast<std::size_t>(sphere)];
            if (!find_crossing(s, rays, crossing)) {
                return true;
            }
            if constexpr (ties == Ties::decided) {
                decide_start(s, rays, crossing);
            }
            return visit(s.object, crossing);
        };
        const auto cross_polyhedra = [&](int polyhedron, int end) __attribute__((always_inline)) {
            for (; polyhedron < end; ++polyhedron) {
                const Polyhedron<Real>& p = polyhedra[static_cast<std::size_t>(polyhedron)];
                bool crosses = true;
                if constexpr (ties == Ties::decided) {
                    crossing = find_crossing_by_rules(p, patches.data(), rays);
                } else {
                    crosses = find_crossing<ties == Ties::found>(p, patches.data(), rays, crossing, close);
                }
                if (crosses && !visit(p.object, crossing)) {
                    return false;
                }
            }
            return true;
        };
        for (int sphere = 0; sphere < spheres_apart; ++sphere) {
            if (may_hit(sphere) && !cross_sphere(sphere)) {
                return;
            }
        }
        if (!cross_polyhedra(0, polyhedra_apart)) {
            return;
        }
        tree.for_each_leaf(rays, limit, [&](const TreeNode<Real>& leaf) {
            for (int sphere = leaf.first_sphere; sphere < leaf.end_sphere; ++sphere) {
                if (!cross_sphere(sphere)) {
                    return false;
                }
            }
            return cross_polyhedra(leaf.first_polyhedron, leaf.end_polyhedron);
        });
    }

    void add_shape(const SceneDescription& description, int object);
    std::vector<Contact<Real>> contacts_of(const SceneDescription& description, const Triple& point) const;
};

// ---- Preparation --------------------------------------------------------------------------------------------------

template <typename Real>
Patch<Real> plane_of(const Quadruple& plane) {
    // A normal may have any length: its square must neither overflow nor vanish, in float too.
    const int exponent = std::ilogb(std::max({std::abs(plane[0]), std::abs(plane[1]), std::abs(plane[2])}));
    const auto scaled = [&](std::size_t i) { return std::scalbn(plane[i], -exponent); };
    const Vector<Real> normal = vector_of<Real>({scaled(0), scaled(1), scaled(2)});
    const Real offset = static_cast<Real>(scaled(3)) / length(normal);
    const bool along_axis = (normal.x != 0) + (normal.y != 0) + (normal.z != 0) == 1;
    const Real slack = 4 * tie_epsilon<Real>;
    if (along_axis) {
        return {normal / length(normal), offset, false, input_error(offset), 0};
    }
    return {normal / length(normal), offset, false, slack * std::abs(offset), slack};
}

template <typename Real>
Patch<Real> sphere_of(const SphereDescription& sphere) {
    const Vector<Real> center = vector_of<Real>(sphere.center);
    const Real radius = static_cast<Real>(sphere.radius);
    const Real error = input_error(radius) + input_error_of_point<Real>(sphere.center);
    return {center, radius, true, error, 0, 1 / radius};
}

template <typename Real>
Scene<Real>::Scene(const SceneDescription& description, const SearchPlan& plan)
    : ambient(vector_of<Real>(description.ambient)), background(vector_of<Real>(description.background)), tree(plan) {
    const auto real = [](double value) { return static_cast<Real>(value); };
    for (const LightDescription& light : description.lights) {
        lights.push_back({vector_of<Real>(light.position),
                          vector_of<Real>(light.color),
                          real(light.attenuation[0]),
                          real(light.attenuation[1]),
                          real(light.attenuation[2]),
                          {},
                          {}});
    }
    for (const PigmentDescription& pigment : description.pigments) {
        pigments.push_back(pigment_of<Real>(pigment));
    }
    objects.reserve(description.objects.size());
    for (const ObjectDescription& object : description.objects) {
        const FinishDescription& f = description.finishes[static_cast<std::size_t>(object.finish)];
        objects.push_back({{real(f.ka), real(f.kd), real(f.ks), real(f.alpha), real(f.kr), real(f.kt), real(f.eta)},
                           &pigments[static_cast<std::size_t>(object.pigment)],
                           static_cast<int>(patches.size())});
        if (const auto* sphere = std::get_if<SphereDescription>(&object.shape)) {
            patches.push_back(sphere_of<Real>(*sphere));
        } else {
            for (const Quadruple& plane : std::get_if<PolyhedronDescription>(&object.shape)->planes) {
                patches.push_back(plane_of<Real>(plane));
            }
        }
    }

    for (const int object : plan.apart) {
        add_shape(description, object);
    }
    spheres_apart = static_cast<int>(spheres.size());
    polyhedra_apart = static_cast<int>(polyhedra.size());
    for (std::size_t i = 0; i < plan.tree.nodes.size(); ++i) {
        const BvhNode& node = plan.tree.nodes[i];
        if (node.children == 0) {
            tree[i].first_sphere = static_cast<int>(spheres.size());
            tree[i].first_polyhedron = static_cast<int>(polyhedra.size());
            for (std::size_t k = node.first; k < node.first + node.count; ++k) {
                add_shape(description, static_cast<int>(plan.tree.order[k]));
            }
            tree[i].end_sphere = static_cast<int>(spheres.size());
            tree[i].end_polyhedron = static_cast<int>(polyhedra.size());
        }
    }
    const auto view_from = [&](const Vector<Real>& point) {
        View<Real> view;
        for (int sphere = 0; sphere < spheres_apart; ++sphere) {
            view.emplace_back(spheres[static_cast<std::size_t>(sphere)], point);
        }
        return view;
    };
    eye_view = view_from(vector_of<Real>(description.camera.eye));
    for (const Contact<Real>& contact : contacts_of(description, description.camera.eye)) {
        // The eye may also lie in a face's plane beside the face.
        const auto* polyhedron =
            std::get_if<PolyhedronDescription>(&description.objects[static_cast<std::size_t>(contact.object)].shape);
        if (eye_contact.object < 0 && (!polyhedron || lies_within(polyhedron->planes, description.camera.eye))) {
            eye_contact.object = contact.object;
            eye_contact.patch = contact.patch;
            eye_contact.curvature = patches[static_cast<std::size_t>(contact.patch)].curvature;
        }
        if (contact.object == eye_contact.object) {
            eye_contact.outward.push_back(contact.outward);
        }
    }
    for (std::size_t i = 0; i < lights.size(); ++i) {
        lights[i].view = view_from(lights[i].position);
        lights[i].contacts = contacts_of(description, description.lights[i].position);
    }
}

template <typename Real>
std::vector<Contact<Real>> Scene<Real>::contacts_of(const SceneDescription& description, const Triple& point) const {
    std::vector<Contact<Real>> contacts;
    for (std::size_t i = 0; i < objects.size(); ++i) {
        const int object = static_cast<int>(i);
        int patch = objects[i].first_patch;
        const auto& shape = description.objects[i].shape;
        if (const auto* sphere = std::get_if<SphereDescription>(&shape)) {
            if (lies_on(*sphere, point)) {
                const Vector<Real> arm = vector_of<Real>(in_range(direction(sphere->center, point)));
                contacts.push_back({object, patch, normalize(arm), true});
            }
        } else {
            for (const Quadruple& plane : std::get_if<PolyhedronDescription>(&shape)->planes) {
                if (lies_on(plane, point)) {
                    contacts.push_back({object, patch, patches[static_cast<std::size_t>(patch)].anchor, false});
                }
                ++patch;
            }
        }
    }
    return contacts;
}

template <typename Real>
void Scene<Real>::add_shape(const SceneDescription& description, int object) {
    const int patch = objects[static_cast<std::size_t>(object)].first_patch;
    const auto& shape = description.objects[static_cast<std::size_t>(object)].shape;
    if (const auto* polyhedron = std::get_if<PolyhedronDescription>(&shape)) {
        polyhedra.push_back({patch, static_cast<int>(polyhedron->planes.size()), object});
    } else {
        const Patch<Real>& sphere = patches[static_cast<std::size_t>(patch)];
        spheres.emplace_back(sphere, object, patch);
    }
}

}  // namespace whitted::WHITTED_ISA
