// The face polygons of an intersection of half-spaces.
//
// A face polygon is a huge square on plane k, cut by all other half-spaces, one after the other (de Berg, Cheong, van
// Kreveld and Overmars, "Computational Geometry", 3rd ed., 2008, ch. 4). Every corner is computed from three planes.
// halfspaces/plane.h says what allowance is made for rounding.

#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "halfspaces/plane.h"
#include "halfspaces/polygon.h"

namespace whitted::halfspaces {

// Where a face is, for a search of the planes that may cut it.
struct Outline {
    struct Point {
        Vec position;
        Real size;  // of the numbers that it was computed from
    };
    Point center;  // of a ball around the face
    Real radius;
    Vec u, v;                   // the axes of the face's plane
    std::vector<Point> points;  // the face is in their convex hull
    bool own_corners;           // they are the corners of the face
};

// What is left of one plane when others have cut it.
class Face {
 public:
    // `far` is half the size of the square to begin with.
    Face(const std::vector<Plane>& planes, int self, Real far);

    std::size_t index() const { return static_cast<std::size_t>(self_); }
    bool empty() const { return polygon_.empty(); }
    Real area() const { return area_; }                               // after finish()
    const Vec& centroid() const { return centroid_; }                 // likewise
    const Polygon::Edges& edges() const { return polygon_.edges(); }  // counterclockwise, seen from outside

    // The point of an edge in space.
    Vec at(const Edge& edge, Real t) const { return at(edge.x(t), edge.y(t)); }

    // Whether nothing is left of the square's border.
    bool bounded() const {
        return std::all_of(edges().begin(), edges().end(), [](const auto& item) { return item.second.neighbor >= 0; });
    }

    // Whether plane `other` is the same but for roundings, facing either way.
    bool coincides_with(int other) const;

    // Whether anything of it lies outside of the half-space of plane `other`, or does not count beside it.
    bool affected_by(int other) const;

    // Keep what lies in the half-space of plane `other`.
    void cut_by(int other);

    // The same face, to be cut by more planes: `planes` starts with those known so far.
    Face continued(const std::vector<Plane>& planes) const {
        Face face = *this;
        face.planes_ = &planes;
        return face;
    }

    // Of a face that is not empty.
    Outline outline() const;

    // To be called after the last cut.
    void finish();

    // Whether a finished face is so narrow that the roundings of the planes may have made it.
    bool narrow() const;

    // The vertices of a face; where it has none, its points nearest the origin.
    template <typename Visit>
    void for_each_anchor(Visit visit) const;

 private:
    const Plane& plane(int k) const { return (*planes_)[static_cast<std::size_t>(k)]; }
    Vec at(Real x, Real y) const { return foot_ + x * u_ + y * v_; }
    HalfPlane trace_of(const Plane& cut) const;
    Real touch_of(const Plane& cut) const;
    bool faces_as(const Plane& other) const { return dot(plane_.normal, other.normal) > 0; }
    Real height_of_parallel(const Plane& other) const;
    Real doubt_beside(const Plane& other) const;
    bool loses_to_parallel(const Plane& cut, int other) const;
    void find_ball();

    const std::vector<Plane>* planes_;
    int self_;
    Plane plane_;
    Vec foot_, u_, v_;  // origin and axes of the polygon's coordinates; u, v and the plane's normal are right-handed
    Polygon polygon_;
    Vec center_;       // of a ball around the face
    Real radius_ = 0;  // of that ball, and a little more
    Real area_ = 0;
    Vec centroid_;
};

// ---- Cutting one face -----------------------------------------------------------------------------------------------

inline Face::Face(const std::vector<Plane>& planes, int self, Real far)
    : planes_(&planes), self_(self), plane_(plane(self)), foot_(plane_.foot()), polygon_(far) {
    // The axis across which the normal is longest: for a normal along an axis, u and v are exact.
    const Vec& n = plane_.normal;
    const Real x = std::abs(n.x);
    const Real y = std::abs(n.y);
    const Real z = std::abs(n.z);
    u_ = cross(x <= y && x <= z ? Vec{1, 0, 0} : y <= z ? Vec{0, 1, 0} : Vec{0, 0, 1}, n);
    u_ = (1 / length(u_)) * u_;
    v_ = cross(n, u_);
    find_ball();
}

// What a half-space is in the polygon's plane. The length of (a, b) is the sine of the angle between the planes.
inline HalfPlane Face::trace_of(const Plane& cut) const {
    return {dot(cut.normal, u_), dot(cut.normal, v_), cut.distance(foot_)};
}

inline bool nearly_parallel(const HalfPlane& trace) {
    return trace.a * trace.a + trace.b * trace.b <= rounding * rounding;
}

// What a plane may take of this one for nothing but noise.
inline Real Face::touch_of(const Plane& cut) const { return noise * (std::abs(plane_.offset) + std::abs(cut.offset)); }

// How far this plane lies outside of a parallel one's half-space.
inline Real Face::height_of_parallel(const Plane& other) const {
    return faces_as(other) ? other.offset - plane_.offset : other.offset + plane_.offset;
}

// By how much roundings may have moved this plane and a parallel one.
inline Real Face::doubt_beside(const Plane& other) const {
    return rounding * std::max(std::abs(plane_.offset), std::abs(other.offset));
}

inline bool Face::coincides_with(int other) const {
    const Plane& same = plane(other);
    return nearly_parallel(trace_of(same)) && std::abs(height_of_parallel(same)) <= doubt_beside(same);
}

// Whether a plane that is parallel to this one leaves nothing of it. Of planes that coincide the one with the lowest
// index has the face.
inline bool Face::loses_to_parallel(const Plane& cut, int other) const {
    return faces_as(cut) && coincides_with(other) ? other < self_ : height_of_parallel(cut) >= -doubt_beside(cut);
}

inline bool Face::affected_by(int other) const {
    const Plane& cut = plane(other);
    if (empty() || other == self_ || cut.distance(center_) < -radius_) {
        return false;
    }
    const HalfPlane trace = trace_of(cut);
    return nearly_parallel(trace) ? loses_to_parallel(cut, other) : !polygon_.misses(trace, touch_of(cut));
}

inline void Face::cut_by(int other) {
    if (!affected_by(other)) {
        return;
    }
    const Plane& cut = plane(other);
    const HalfPlane trace = trace_of(cut);
    if (nearly_parallel(trace)) {
        polygon_.clear();
        return;
    }
    Edge fresh;
    fresh.neighbor = other;
    fresh.sine = std::sqrt(trace.a * trace.a + trace.b * trace.b);
    const Real scale = 1 / fresh.sine;
    fresh.a = scale * trace.a;
    fresh.b = scale * trace.b;
    fresh.c = scale * trace.c;
    polygon_.cut_by(fresh, touch_of(cut));
    find_ball();
}

inline void Face::find_ball() {
    center_ = at(polygon_.center().x, polygon_.center().y);
    // A little more, so that no plane that coincides with this one is seen to be away from it.
    const Real reach = std::abs(center_.x) + std::abs(center_.y) + std::abs(center_.z);
    radius_ = (1 + 4 * rounding) * polygon_.radius() + 4 * rounding * reach;
}

inline Outline Face::outline() const {
    const auto point = [&](const Corner& corner) {
        return Outline::Point{at(corner.x, corner.y),
                              std::abs(plane_.offset) + std::abs(corner.x) + std::abs(corner.y)};
    };
    Outline outline{point(polygon_.center()), radius_, u_, v_, {}, polygon_.has_few_edges()};
    for (const Corner& corner : polygon_.outline()) {
        outline.points.push_back(point(corner));
    }
    return outline;
}

// ---- Measures of one face -------------------------------------------------------------------------------------------

inline void Face::finish() {
    if (empty()) {
        return;
    }
    // The fan of triangles about the first corner.
    const Edge& first = edges().begin()->second;
    const Real x0 = first.begin_x;
    const Real y0 = first.begin_y;
    Real x = 0;
    Real y = 0;
    area_ = 0;
    const Edge* before = &first;
    for (const auto& [turn, edge] : edges()) {
        const Real x1 = before->begin_x - x0;
        const Real y1 = before->begin_y - y0;
        const Real x2 = edge.begin_x - x0;
        const Real y2 = edge.begin_y - y0;
        const Real triangle = (x1 * y2 - y1 * x2) / 2;
        area_ += triangle;
        x += triangle / 3 * (x1 + x2);
        y += triangle / 3 * (y1 + y2);
        before = &edge;
    }
    centroid_ = area_ > 0 ? at(x0 + x / area_, y0 + y / area_) : at(x0, y0);
}

template <typename Visit>
void Face::for_each_anchor(Visit visit) const {
    bool any = false;
    const Edge* before = &edges().rbegin()->second;
    for (const auto& [turn, edge] : edges()) {
        if (edge.neighbor >= 0 && before->neighbor >= 0) {
            visit(at(edge, edge.low));
            any = true;
        }
        before = &edge;
    }
    if (any) {
        return;
    }
    for (const auto& [turn, edge] : edges()) {
        if (edge.neighbor >= 0) {
            visit(at(edge, edge.nearest()));
            any = true;
        }
    }
    if (!any) {
        visit(foot_);
    }
}

inline bool Face::narrow() const {
    Real reach = 0;
    Real perimeter = 0;
    for (const auto& [turn, edge] : edges()) {
        reach = std::max(reach, length(at(edge, edge.low)));
        perimeter += edge.high - edge.low;
    }
    // For a polygon around a circle, the left side is the circle's radius.
    return 2 * area_ / perimeter <= rounding * reach;
}

}  // namespace whitted::halfspaces
