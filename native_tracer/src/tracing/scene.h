// A scene, prepared for one precision, and the two questions rays ask of it: what is hit first, and whether anything
// is in the way.

#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include "search/search.h"
#include "shapes/contact.h"
#include "shapes/crossing.h"
#include "shapes/shapes.h"
#include "tracing/camera.h"
#include "tracing/description.h"
#include "tracing/pigment.h"
#include "tracing/rounding.h"
#include "tracing/tree.h"

namespace whitted::WHITTED_ISA {

template <typename Real>
struct Light {
    using L = Lanes<Real>;
    Vector<Real> position;
    Color<Real> color;
    Real a, b, c;  // dimmed by 1 / (a + b d + c d^2) at distance d
    Real radius;   // of a disc that faces the point being lit
    Real error;    // how far the position's sums with others may be off
    View<Real> view;
    std::vector<Contact<Real>> contacts;  // of a light that is a point
    std::vector<Real> outside{};          // of each polyhedron or csg: how far the light surely lies outside

    bool is_point() const { return radius == 0; }

    // Whether rays that lead to the light start within a polyhedron or a csg that it lies outside of: they cross its
    // surface, wherever that may be. Only where no rounding can matter: some plane, of the body or of the box around
    // it, is crossed far from the light, and steeply.
    Mask<Real> is_outside_of_own(const Rays<Real>& rays, L distance, Mask<Real> wanted) const {
        const Mask<Real> within = rays.inside & wanted;  // the others may start on nothing
        const L height = L::gather(
            [&](int lane) { return within[lane] ? outside[static_cast<std::size_t>(rays.object[lane])] : Real(0); });
        return height > L(Real(0x1p-10)) * distance;
    }

    // Whether rays that lead to the light cross an object at the surface that the light lies on.
    Mask<Real> lies_at(const Crossing<Real>& crossing, const Vector<L>& direction) const {
        Mask<Real> result = Mask<Real>::none();
        for (const Contact<Real>& contact : contacts) {
            result |= contact.is_at(crossing, direction);
        }
        return result;
    }

    // Whether the light lies in the plane of these primitives, and so shines along them.
    Mask<Real> grazes(Indices<Real> primitive) const {
        Mask<Real> result = Mask<Real>::none();
        for (const Contact<Real>& contact : contacts) {
            if (contact.flat) {
                result |= primitive == Indices<Real>(contact.primitive);
            }
        }
        return result;
    }
};

template <typename Real>
struct Finish {
    Real ka, kd, ks, alpha, kr, kt;
    Real eta;      // n1/n2, outside over inside
    Real versine;  // 1 - cos of half the angle of the cone in which rays are spread
};

template <typename Real>
struct Object {
    Finish<Real> finish;
    const Pigment<Real>* pigment;
    int first_primitive;
    ShapeIndex shape;
    bool moves = false;
};

template <typename Real>
struct Hits {
    Lanes<Real> t = std::numeric_limits<Real>::infinity();
    Indices<Real> object = -1;  // -1: nothing is hit
    Indices<Real> primitive = -1;
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

// The nearest of the crossings that it is told of, in each lane.
template <typename Real>
struct Nearest {
    Hits<Real> hits;
    Lanes<Real> limit;                                           // nothing beyond matters
    Lanes<Real> second = std::numeric_limits<Real>::infinity();  // distance of the next one
    Mask<Real> close = Mask<Real>::none();                       // there may be a tie

    [[gnu::always_inline]] bool meet(Indices<Real> object, const Crossing<Real>& crossing) {
        const Mask<Real> nearer = (crossing.t < hits.t) | ((crossing.t <= hits.t) & (object < hits.object));
        second = min(second, max(crossing.t, hits.t));
        hits.t = select(nearer, crossing.t, hits.t);
        hits.object = select(nearer, object, hits.object);
        hits.primitive = select(nearer, crossing.primitive, hits.primitive);
        hits.inside = select(nearer, crossing.inside, hits.inside);
        limit = min(hits.t, limit);
        return true;
    }
};

// What is in the way of rays to a light.
template <typename Real>
struct Blocking {
    Mask<Real> open;    // nothing is
    Lanes<Real> limit;  // nothing beyond matters
    Indices<Real> blocker = -1;
    Mask<Real> close = Mask<Real>::none();  // there may be a tie

    [[gnu::always_inline]] bool meet(Indices<Real> object, Mask<Real> crossing, Mask<Real> near) {
        const Mask<Real> blocked = open & crossing;
        blocker = select(blocked, object, blocker);
        if (any(blocked & near)) [[unlikely]] {
            close |= blocked & near;
        }
        open &= ~blocked;
        limit = select(open, limit, Lanes<Real>(Real(-1)));
        return any(open);
    }
};

template <typename Real>
struct Scene {
    Color<Real> ambient, background;
    bool sampled = false;  // something is random
    bool moves = false;    // rays have a time
    bool spreads = false;  // some finish spreads rays
    View<Real> eye_view;
    EyeContact<Real> eye_contact;  // of a camera without a lens
    std::vector<Light<Real>> lights;
    std::vector<Pigment<Real>> pigments;
    std::vector<Object<Real>> objects;
    // Those outside the tree come first, the rest in the order of its leaves.
    Shapes<Real> shapes;
    typename Shapes<Real>::Ranges apart;
    Tree<Real> tree;

    Scene(const SceneDescription& description, const SearchPlan& plan);
    Scene(const Scene&) = delete;  // objects point to pigments

    // The nearest hit of each ray; of objects at the same distance, the first of the file; for the rays in `wanted`,
    // which start where `view` was made from, if it is given.
    Hits<Real> nearest_hit(const Rays<Real>& rays, Mask<Real> wanted, const View<Real>* view) const {
        Nearest<Real> nearest;
        nearest.limit = select(wanted, nearest.hits.t, Lanes<Real>(Real(-1)));
        const auto may_hit = [&](const auto& sight) { return sight.may_be_hit(rays.direction); };
        for_each_crossing<Ties::found>(
            rays, nearest.limit, nearest.close, view, may_hit,
            [&](const auto& shape, const Crossing<Real>& crossing) { return nearest.meet(shape.object(), crossing); },
            [&](const BoxTest<Real>& test, Walks<Real>& walks) {
                nearest = nearest_hit_alone(rays, test, walks, nearest);
            });
        Hits<Real>& hits = nearest.hits;
        Mask<Real>& close = nearest.close;
        const Lanes<Real> range = Lanes<Real>(most_blur<Real>) * (hits.t + rays.reach);
        close |= (nearest.second - hits.t <= range) | (hits.t < range);
        close &= wanted;
        if (decides_ties<Real> && any(close)) [[unlikely]] {
            const Hits<Real> settled = nearest_hit_by_rules(rays, close);
            hits.t = select(close, settled.t, hits.t);
            hits.object = select(close, settled.object, hits.object);
            hits.primitive = select(close, settled.primitive, hits.primitive);
            hits.inside = select(close, settled.inside, hits.inside);
        }
        return hits;
    }

    // An object that is in the way of each ray before `distance`, or -1: nothing is; for the rays in `wanted`.
    Indices<Real> blocker(const Rays<Real>& rays, const Light<Real>& light, Lanes<Real> distance,
                          Mask<Real> wanted) const {
        Indices<Real> own = -1;
        if (any(rays.inside & wanted)) {
            const Mask<Real> leaving = light.is_outside_of_own(rays, distance, wanted);
            own = select(leaving, rays.object, own);
            wanted &= ~leaving;
            if (!any(wanted)) {
                return own;
            }
        }
        Blocking<Real> blocking = find_blocker<Ties::found_in_the_way>(rays, light, distance, wanted, &light.view);
        Indices<Real>& blocker = blocking.blocker;
        const Mask<Real> close = blocking.close & wanted;
        if (decides_ties<Real> && any(close)) [[unlikely]] {
            blocker = select(close, blocker_by_rules(rays, light, distance, close), blocker);
        }
        return select(wanted, blocker, own);
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
        const auto anything = [](const auto&) { return true; };
        const auto nobody = [](const BoxTest<Real>&, Walks<Real>&) {};
        Lanes<Real> nearest = infinity;
        Lanes<Real> error = Real(0);
        Lanes<Real> limit = select(wanted, infinity, nowhere);
        for_each_crossing<Ties::decided>(
            rays, limit, close, nullptr, anything,
            [&](const auto& shape, const Crossing<Real>& crossing) {
                const Lanes<Real> its_error = distance_errors(shape, rays, crossing);
                const Mask<Real> same = (crossing.t <= nearest) & (its_error > error);
                error = select((crossing.t < nearest) | same, its_error, error);
                nearest = min(crossing.t, nearest);
                limit = min(nearest, limit);
                return true;
            },
            nobody);
        Hits<Real> hits;
        limit = select(wanted, nearest + Lanes<Real>(most_blur<Real>) * (nearest + rays.reach), nowhere);
        for_each_crossing<Ties::decided>(
            rays, limit, close, nullptr, anything,
            [&](const auto& shape, const Crossing<Real>& crossing) {
                const Indices<Real> object = shape.object();
                const Mask<Real> ties =
                    (crossing.t < infinity) & (crossing.t - nearest <= error + distance_errors(shape, rays, crossing));
                const Mask<Real> first = ties & ((hits.object < Indices<Real>(0)) | (object < hits.object));
                hits.t = select(first, crossing.t, hits.t);
                hits.object = select(first, object, hits.object);
                hits.primitive = select(first, crossing.primitive, hits.primitive);
                hits.inside = select(first, crossing.inside, hits.inside);
                return true;
            },
            nobody);
        hits.primitive = Indices<Real>::gather([&](int lane) {
            if (!wanted[lane] || hits.object[lane] < 0) {
                return hits.primitive[lane];
            }
            const Object<Real>& object = objects[static_cast<std::size_t>(hits.object[lane])];
            return shapes.visit(object.shape, [&](const auto& shape) {
                return shape.primitive_met(at_rest(shape, rays), lane, hits.primitive[lane], hits.t[lane],
                                           hits.inside[lane]);
            });
        });
        return hits;
    }

    [[gnu::noinline]] Indices<Real> blocker_by_rules(const Rays<Real>& rays, const Light<Real>& light,
                                                     Lanes<Real> distance, Mask<Real> wanted) const {
        return find_blocker<Ties::decided>(rays, light, distance, wanted, nullptr).blocker;
    }

    template <Ties ties>
    [[gnu::always_inline]] Blocking<Real> find_blocker(const Rays<Real>& rays, const Light<Real>& light,
                                                       Lanes<Real> distance, Mask<Real> wanted,
                                                       const View<Real>* view) const {
        Blocking<Real> blocking;
        blocking.open = wanted;
        // Crossings beyond it do not matter.
        blocking.limit = select(wanted, distance, Lanes<Real>(Real(-1)));
        const auto may_block = [&](const auto& sight) { return sight.may_block(rays, distance, blocking.open); };
        const Lanes<Real> range = Lanes<Real>(most_blur<Real>) * rays.reach;
        for_each_crossing<ties>(
            rays, blocking.limit, blocking.close, view, may_block,
            [&](const auto& shape, const Crossing<Real>& crossing) {
                return blocking.meet(shape.object(), (crossing.t < distance) & ~light.lies_at(crossing, rays.direction),
                                     crossing.t < range);
            },
            [&](const BoxTest<Real>& test, Walks<Real>& walks) {
                blocking = blocker_alone(rays, light, distance, test, walks, blocking);
            });
        return blocking;
    }

    // ---- Rays that have left their group ----------------------------------------------------------------------------

    [[gnu::noinline]] Nearest<Real> nearest_hit_alone(const Rays<Real>& rays, const BoxTest<Real>& test,
                                                      Walks<Real>& walks, Nearest<Real> nearest) const {
        for_each_crossing_alone<Ties::found>(
            rays, nearest.limit, nearest.close, test, walks,
            [&](const auto& shape, const Crossing<Real>& crossing) { return nearest.meet(shape.object(), crossing); });
        return nearest;
    }

    [[gnu::noinline]] Blocking<Real> blocker_alone(const Rays<Real>& rays, const Light<Real>& light,
                                                   const Lanes<Real>& distance, const BoxTest<Real>& test,
                                                   Walks<Real>& walks, Blocking<Real> blocking) const {
        const Lanes<Real> range = Lanes<Real>(most_blur<Real>) * rays.reach;
        for_each_crossing_alone<Ties::found_in_the_way>(
            rays, blocking.limit, blocking.close, test, walks, [&](const auto& shape, const Crossing<Real>& crossing) {
                return blocking.meet(shape.object(), (crossing.t < distance) & ~light.lies_at(crossing, rays.direction),
                                     crossing.t < range);
            });
        return blocking;
    }

    // What for_each_crossing() does, for what is left to walks: spheres are met one to a lane.
    template <Ties ties, typename Visit>
    [[gnu::always_inline]] void for_each_crossing_alone(const Rays<Real>& rays, const Lanes<Real>& limit,
                                                        Mask<Real>& close, const BoxTest<Real>& test,
                                                        Walks<Real>& walks, Visit visit) const {
        constexpr std::size_t spheres = 0;
        const auto cross = [&](const auto& shape, Mask<Real> here) {
            Crossing<Real> crossing;
            Mask<Real> may_tie = Mask<Real>::none();
            const Lanes<Real> its_limit = select(here, limit, Lanes<Real>(Real(-1)));
            const bool crosses =
                shape.template intersect<ties == Ties::found>(at_rest(shape, rays), its_limit, crossing, may_tie);
            close |= may_tie & here;  // of a ray along a plane, it may be all that is known
            if (!crosses) {
                return true;
            }
            crossing.t = select(here, crossing.t, Lanes<Real>(std::numeric_limits<Real>::infinity()));
            return visit(shape, crossing);
        };
        const auto meet = [&](unsigned lanes, const int* met) {
            unsigned balls = 0;
            for (unsigned left = lanes; left != 0; left &= left - 1) {
                const int lane = std::countr_zero(left);
                balls |= (WideTree<Real>::shape_at(met[lane]).kind == spheres ? 1U : 0U) << lane;
            }
            if (balls != 0) {
                const auto ball = gather_balls<Real>(balls, [&](int lane) -> const auto& {
                    return shapes.template at<Sphere<Real>>(WideTree<Real>::shape_at(met[lane])).ball();
                });
                Crossing<Real> crossing;
                if (ball.intersect(rays, crossing) && !visit(ball, crossing)) {
                    return false;
                }
            }
            // Each other shape for all that have come to it.
            for (unsigned left = lanes & ~balls; left != 0;) {
                const int shape = met[std::countr_zero(left)];
                const auto has_met = [&](int lane) { return (left >> lane & 1U) != 0 && met[lane] == shape; };
                const Mask<Real> here = Mask<Real>::gather(has_met);
                const auto cross_here = [&](const auto& its) { return cross(its, here); };
                if (!shapes.visit(WideTree<Real>::shape_at(shape), cross_here)) {
                    return false;
                }
                left &= ~here.bits();
            }
            return true;
        };
        tree.wide().walk(test, walks, limit, meet, [&](ShapeIndex shape) {
            if (shape.kind == spheres) {
                __builtin_prefetch(&shapes.template at<Sphere<Real>>(shape));
            }
        });
    }

    // How far the distances of crossings may be off.
    template <typename Shape>
    static Lanes<Real> distance_errors(const Shape& shape, const Rays<Real>& world_rays,
                                       const Crossing<Real>& crossing) {
        const Rays<Real>& rays = at_rest(shape, world_rays);
        return Lanes<Real>::gather([&](int lane) {
            const Real t = crossing.t[lane];
            if (!std::isfinite(t)) {
                return Real(0);
            }
            // No number where the point is rounded to a sphere's centre.
            const Real error = distance_error(shape, rays, lane, crossing.primitive[lane], t);
            const Real most = most_blur<Real> * (t + rays.reach[lane]);
            return error <= most ? error : most;
        });
    }

    // Calls visit(shape, crossing) for the shapes that some ray crosses before `limit`, and maybe others, until it
    // returns false: the one place that knows how the shapes are searched. visit may lower `limit`. Shapes outside the
    // tree are passed over where may_hit(sight) is false, if there is a view. Ties between a shape's primitives are
    // decided, or the rays that have some are added to `close`; and then none leaves its group. Else go_on(test, walks)
    // is to do the same for what those that have left may cross.
    template <Ties ties, typename MayHit, typename Visit, typename GoOn>
    [[gnu::always_inline]] void for_each_crossing(const Rays<Real>& rays, const Lanes<Real>& limit, Mask<Real>& close,
                                                  const View<Real>* view, MayHit may_hit, Visit visit,
                                                  GoOn go_on) const {
        const auto cross = [&](const auto& shape) __attribute__((always_inline)) {
            Crossing<Real> crossing;  // of its own, so that it stays in registers but for calls that need it elsewhere
            const Rays<Real>& resting = at_rest(shape, rays);
            bool crosses;
            if constexpr (ties == Ties::decided) {
                crosses = shape.intersect_by_rules(resting, crossing);
            } else {
                crosses = shape.template intersect<ties == Ties::found>(resting, limit, crossing, close);
            }
            return !crosses || visit(shape, crossing);
        };
        const auto cross_if_in_sight = [&](const auto& shape, const auto& sight)
                                           __attribute__((always_inline)) { return !may_hit(sight) || cross(shape); };
        if (!(view ? shapes.for_each(apart, *view, cross_if_in_sight) : shapes.for_each(apart, cross)) ||
            tree.empty()) {
            return;
        }
        const BoxTest<Real> test = tree.test(rays);
        Walks<Real> walks;
        const bool unfinished = tree.template for_each_leaf<ties != Ties::decided>(
            rays, test, limit, walks, [&](const typename Tree<Real>::Leaf& leaf) __attribute__((always_inline)) {
                return shapes.for_each(leaf, cross);
            });
        if (unfinished && walks.lanes() != 0) {
            go_on(test, walks);
        }
    }

    void add_objects(const SceneDescription& description);
    void add_shapes(const SceneDescription& description, const SearchPlan& plan);
    void add_eye(const SceneDescription& description);
    void add_light(const SceneDescription& description, const LightDescription& light);
    std::vector<Contact<Real>> contacts_of(const SceneDescription& description, const Triple& point) const;
};

// ---- Preparation --------------------------------------------------------------------------------------------------

template <typename Real>
Scene<Real>::Scene(const SceneDescription& description, const SearchPlan& plan)
    : ambient(vector_of<Real>(description.ambient)), background(vector_of<Real>(description.background)), tree(plan) {
    for (const PigmentDescription& pigment : description.pigments) {
        pigments.push_back(pigment_of<Real>(pigment));
    }
    add_objects(description);
    add_shapes(description, plan);
    sampled |= moves;
    add_eye(description);
    for (const LightDescription& light : description.lights) {
        add_light(description, light);
    }
}

template <typename Real>
void Scene<Real>::add_objects(const SceneDescription& description) {
    const auto real = [](double value) { return static_cast<Real>(value); };
    objects.reserve(description.objects.size());
    int primitive = 0;
    for (const ObjectDescription& object : description.objects) {
        const FinishDescription& f = description.finishes[static_cast<std::size_t>(object.finish)];
        const double sine = std::sin(f.cone * std::numbers::pi / 360);
        objects.push_back({{real(f.ka), real(f.kd), real(f.ks), real(f.alpha), real(f.kr), real(f.kt), real(f.eta),
                            real(2 * sine * sine)},
                           &pigments[static_cast<std::size_t>(object.pigment)],
                           primitive,
                           {}});
        primitive += Shapes<Real>::primitive_count(object.shape);
        spreads |= f.cone > 0;
    }
    sampled |= spreads;
}

// Primitives are numbered in the order of the file, shapes are kept in that of the search.
template <typename Real>
void Scene<Real>::add_shapes(const SceneDescription& description, const SearchPlan& plan) {
    const auto add = [&](int number) {
        const auto index = static_cast<std::size_t>(number);
        Object<Real>& object = objects[index];
        const ShapeDescription& shape = description.objects[index].shape;
        object.shape = shapes.add(shape, number, object.first_primitive);
        object.moves = std::get_if<MovingDescription>(&shape) != nullptr;
        moves |= object.moves;
    };
    for (const int object : plan.apart) {
        add(object);
    }
    apart = shapes.added_behind({});
    typename Shapes<Real>::Ranges last = apart;
    for (std::size_t i = 0; i < plan.tree.nodes.size(); ++i) {
        const BvhNode& node = plan.tree.nodes[i];
        if (node.children == 0) {
            for (std::size_t k = node.first; k < node.first + node.count; ++k) {
                add(static_cast<int>(plan.tree.order[k]));
            }
            last = shapes.added_behind(last);
            tree.put_leaf(i, last);
        }
    }
    tree.finish(plan, [&](std::uint32_t item) { return objects[item].shape; });
}

template <typename Real>
void Scene<Real>::add_eye(const SceneDescription& description) {
    const Triple& eye = description.camera.eye;
    eye_view = shapes.view_from(apart, vector_of<Real>(eye), static_cast<Real>(description.camera.aperture));
    if (description.camera.aperture > 0) {
        sampled = true;
        return;
    }
    for (const Contact<Real>& contact : contacts_of(description, eye)) {
        if (eye_contact.object < 0 && contact.on_body) {
            eye_contact.object = contact.object;
            eye_contact.primitive = contact.primitive;
            eye_contact.body = contact.body;
            eye_contact.curvature = contact.curvature;
            eye_contact.turn = contact.turn;
        }
        if (contact.body >= 0 && contact.body == eye_contact.body) {
            eye_contact.outward.push_back(contact.outward);
        }
    }
}

template <typename Real>
void Scene<Real>::add_light(const SceneDescription& description, const LightDescription& light) {
    const Vector<Real> position = vector_of<Real>(light.position);
    const Color<Real> fading = vector_of<Real>(light.attenuation);
    const bool point = light.radius == 0;
    lights.push_back(
        {position, vector_of<Real>(light.color), fading.x, fading.y, fading.z, static_cast<Real>(light.radius),
         8 * tie_epsilon<Real> * std::max({std::abs(position.x), std::abs(position.y), std::abs(position.z)}),
         shapes.view_from(apart, position, static_cast<Real>(light.radius)),
         point ? contacts_of(description, light.position) : std::vector<Contact<Real>>{}});
    for (const Object<Real>& object : objects) {
        lights.back().outside.push_back(shapes.visit(object.shape, [&](const auto& shape) {
            if constexpr (requires { shape.distance_outside(position); }) {
                return shape.distance_outside(position) - lights.back().radius;
            } else {
                return Real(0);
            }
        }));
    }
    sampled |= !point;
}

template <typename Real>
std::vector<Contact<Real>> Scene<Real>::contacts_of(const SceneDescription& description, const Triple& point) const {
    std::vector<Contact<Real>> contacts;
    for (std::size_t i = 0; i < objects.size(); ++i) {
        shapes.visit(objects[i].shape, description.objects[i].shape, [&](const auto& shape, const auto& described) {
            shape.for_each_contact(described, point,
                                   [&](const Contact<Real>& contact) { contacts.push_back(contact); });
        });
    }
    return contacts;
}

}  // namespace whitted::WHITTED_ISA
