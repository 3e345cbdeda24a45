// The face polygons of an intersection of half-spaces.
//
// A face polygon is a huge square on plane k, cut by all other half-spaces, one after the other (de Berg, Cheong, van
// Kreveld and Overmars, "Computational Geometry", 3rd ed., 2008, ch. 4; Sutherland and Hodgman, "Reentrant Polygon
// Clipping", CACM 17(1), 1974). It is kept as edges, each an interval on the line where plane k meets another plane.
// Cutting shortens the intervals and adds one; every end is computed from three planes, never from an end that was
// computed before. Quadratic in the number of planes.
//
// Planes are read as the doubles they are, and everything is computed in long double. Three decisions allow for the
// rounding the coefficients went through when they were written or computed (a relative 2^-53 each, which moves a plane
// by up to 2^-53 of the distance from the origin, and turns it by up to 2^-53, and a few operations made more of it):
// `rounding` is 32 times that.
//   - Two planes whose angle is smaller are parallel.
//   - A face that is narrower, relative to its distance from the origin, is none: its plane only touches the body.
//   - A body that is thinner, relative to its distance from the origin, has no volume.
// Nothing is compared with an absolute length, so that scaling a body, or its planes' coefficients, changes nothing.

#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace whitted::halfspaces {

using Real = long double;

inline constexpr Real rounding = 16 * std::numeric_limits<double>::epsilon();  // 2^-48: of the coefficients
inline constexpr Real noise = 8 * std::numeric_limits<Real>::epsilon();        // of the arithmetic here

struct Vec {
    Real x = 0, y = 0, z = 0;

    friend Vec operator+(const Vec& a, const Vec& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
    friend Vec operator-(const Vec& a, const Vec& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
    friend Vec operator*(Real s, const Vec& a) { return {s * a.x, s * a.y, s * a.z}; }
};

inline Real dot(const Vec& a, const Vec& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec cross(const Vec& a, const Vec& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Real length(const Vec& a) { return std::sqrt(dot(a, a)); }

// The half-space dot(normal, p) + offset <= 0; the normal, of unit length, points out.
struct Plane {
    Vec normal;
    Real offset = 0;

    Plane(Real a, Real b, Real c, Real d) {
        const Real norm = length({a, b, c});
        normal = {a / norm, b / norm, c / norm};
        offset = d / norm;
    }
    Real distance(const Vec& p) const { return dot(normal, p) + offset; }  // positive outside
    Vec foot() const { return -offset * normal; }                          // the point nearest the origin
};

// Part of the line where a face's plane meets another one, in the face's own coordinates: the points
// -c (a, b) + t (-b, a), low <= t <= high. The face is where a x + b y + c <= 0, to the left of the direction (-b, a);
// (a, b) is a unit vector.
struct Edge {
    int neighbor = -1;  // the other plane; -1: the huge square's border
    Real sine = 1;      // of the angle between the two planes
    Real a = 0, b = 0, c = 0;
    Real low = 0, high = 0;
    Real begin_x = 0, begin_y = 0;  // the point at t = low
    Real turn = 0;                  // ascends with the angle of the direction

    void begin_at(Real t) {
        low = t;
        begin_x = x(t);
        begin_y = y(t);
    }
    Real x(Real t) const { return -c * a - t * b; }
    Real y(Real t) const { return -c * b + t * a; }
    Real nearest() const { return std::clamp(Real(0), low, high); }  // where it is nearest the face's origin
};

// What is left of one plane when others have cut it.
class Face {
 public:
    // `far` is half the size of the square to begin with.
    Face(const std::vector<Plane>& planes, int self, Real far);

    std::size_t index() const { return static_cast<std::size_t>(self_); }
    bool empty() const { return edges_.empty(); }
    Real area() const { return area_; }                        // after finish()
    const Vec& centroid() const { return centroid_; }          // likewise
    const std::vector<Edge>& edges() const { return edges_; }  // after finish() counterclockwise, seen from outside

    // The point of an edge in space.
    Vec at(const Edge& edge, Real t) const { return foot_ + edge.x(t) * u_ + edge.y(t) * v_; }

    // Whether nothing is left of the square's border.
    bool bounded() const {
        return std::all_of(edges_.begin(), edges_.end(), [](const Edge& edge) { return edge.neighbor >= 0; });
    }

    // Keep what lies in the half-space of plane `other`.
    void cut_by(int other);

    // The same face, to be cut by more planes: `planes` starts with those known so far.
    Face continued(const std::vector<Plane>& planes) const {
        Face face = *this;
        face.planes_ = &planes;
        return face;
    }

    // To be called after the last cut.
    void finish();

    // Whether a finished face is so narrow that the roundings of the planes may have made it.
    bool narrow() const;

    // The vertices of a finished face; where it has none, its points nearest the origin.
    template <typename Visit>
    void for_each_anchor(Visit visit) const;

 private:
    void settle_parallel(const Plane& cut, int other);
    bool misses(Real a, Real b, Real c, Real touch) const;
    void cut_by(Edge fresh, Real touch);
    void find_ball();

    const std::vector<Plane>* planes_;
    int self_;
    Plane plane_;
    Vec foot_, u_, v_;  // origin and axes of the face's coordinates; u, v and the plane's normal are right-handed
    Vec center_;        // of a ball around the face
    Real radius_ = 0;   // of that ball, and a little more
    Real area_ = 0;
    Vec centroid_;
    std::vector<Edge> edges_;
};

// ---- Cutting one face -----------------------------------------------------------------------------------------------

inline Face::Face(const std::vector<Plane>& planes, int self, Real far)
    : planes_(&planes), self_(self), plane_(planes[static_cast<std::size_t>(self)]), foot_(plane_.foot()) {
    // The axis across which the normal is longest: for a normal along an axis, u and v are exact.
    const Vec& n = plane_.normal;
    const Real x = std::abs(n.x);
    const Real y = std::abs(n.y);
    const Real z = std::abs(n.z);
    u_ = cross(x <= y && x <= z ? Vec{1, 0, 0} : y <= z ? Vec{0, 1, 0} : Vec{0, 0, 1}, n);
    u_ = (1 / length(u_)) * u_;
    v_ = cross(n, u_);
    edges_.resize(4);
    for (std::size_t i = 0; i < 4; ++i) {
        edges_[i].a = i == 0 ? 1 : i == 2 ? -1 : 0;
        edges_[i].b = i == 1 ? 1 : i == 3 ? -1 : 0;
        edges_[i].c = -far;
        edges_[i].high = far;
        edges_[i].begin_at(-far);
    }
    find_ball();
}

// A plane that is parallel to this one. Of planes that coincide the one with the lowest index has the face.
inline void Face::settle_parallel(const Plane& cut, int other) {
    const Real doubt = rounding * std::max(std::abs(plane_.offset), std::abs(cut.offset));
    const bool same_side = dot(plane_.normal, cut.normal) > 0;
    const Real height = same_side ? cut.offset - plane_.offset : cut.offset + plane_.offset;
    const bool coincide = std::abs(height) <= doubt;
    if (same_side && coincide ? other < self_ : height >= -doubt) {
        edges_.clear();
    }
}

// Whether the whole face lies where a x + b y + c <= 0, but for noise.
inline bool Face::misses(Real a, Real b, Real c, Real touch) const {
    return std::all_of(edges_.begin(), edges_.end(), [&](const Edge& edge) {
        return a * edge.begin_x + b * edge.begin_y + c <=
               touch + noise * (std::abs(edge.begin_x) + std::abs(edge.begin_y));
    });
}

inline void Face::cut_by(int other) {
    const Plane& cut = (*planes_)[static_cast<std::size_t>(other)];
    if (edges_.empty() || other == self_ || cut.distance(center_) < -radius_) {
        return;
    }
    Edge fresh;
    fresh.neighbor = other;
    fresh.a = dot(cut.normal, u_);
    fresh.b = dot(cut.normal, v_);
    fresh.c = cut.distance(foot_);
    const Real sine2 = fresh.a * fresh.a + fresh.b * fresh.b;
    if (sine2 <= rounding * rounding) {
        settle_parallel(cut, other);
        return;
    }
    const Real touch = noise * (std::abs(plane_.offset) + std::abs(cut.offset));
    if (misses(fresh.a, fresh.b, fresh.c, touch)) {
        return;
    }
    fresh.sine = std::sqrt(sine2);
    const Real scale = 1 / fresh.sine;
    fresh.a *= scale;
    fresh.b *= scale;
    fresh.c *= scale;
    cut_by(fresh, touch);
}

// Cut along a line, on which no end is known yet; a `touch` is as good as none.
inline void Face::cut_by(Edge fresh, Real touch) {
    const auto sine_between = [&](const Edge& edge) { return fresh.b * edge.a - fresh.a * edge.b; };
    const auto cosine_between = [&](const Edge& edge) { return fresh.a * edge.a + fresh.b * edge.b; };
    const auto parallel = [&](Real sine, const Edge& edge) {
        return std::abs(sine) * std::min(fresh.sine, edge.sine) <= noise;
    };
    // Of parallel lines on the same side the inner one counts, between lines on opposite sides something has to be
    // left. One decision is made for both lines, and before anything is changed.
    for (Edge& edge : edges_) {
        if (!parallel(sine_between(edge), edge)) {
            continue;
        }
        const Real t = edge.nearest();
        const Real height = fresh.a * edge.x(t) + fresh.b * edge.y(t) + fresh.c;
        if (cosine_between(edge) < 0) {
            if (height > 0) {
                edges_.clear();
                return;
            }
        } else if (height * fresh.sine <= touch + noise * (std::abs(edge.c) + std::abs(t))) {
            return;
        } else {
            edge.high = edge.low;
        }
    }
    fresh.low = -std::numeric_limits<Real>::infinity();
    fresh.high = std::numeric_limits<Real>::infinity();
    for (Edge& edge : edges_) {
        const Real sine = sine_between(edge);
        if (parallel(sine, edge)) {
            continue;
        }
        const Real cosine = cosine_between(edge);
        const Real reciprocal = 1 / sine;  // divisions take most of the time
        const Real edge_t = (edge.c * cosine - fresh.c) * reciprocal;
        const Real fresh_t = (edge.c - fresh.c * cosine) * reciprocal;
        if (sine > 0) {
            edge.high = std::min(edge.high, edge_t);
            fresh.low = std::max(fresh.low, fresh_t);
        } else {
            if (edge_t > edge.low) {
                edge.begin_at(edge_t);
            }
            fresh.high = std::min(fresh.high, fresh_t);
        }
    }
    std::erase_if(edges_, [](const Edge& edge) { return !(edge.low < edge.high); });
    if (fresh.low < fresh.high) {
        fresh.begin_at(fresh.low);
        edges_.push_back(fresh);
    }
    // Of a strip that is narrow for its length, the short edges may be lost in rounding. Other faces with less than
    // three edges are the noise of something without a width.
    const auto strip = [](const Edge& e, const Edge& f) {
        return e.a * f.a + e.b * f.b < 0 && std::abs(e.a * f.b - e.b * f.a) < 0x1p-20L;
    };
    if (edges_.size() >= 3 || (edges_.size() == 2 && strip(edges_[0], edges_[1]))) {
        find_ball();
    } else {
        edges_.clear();
    }
}

inline void Face::find_ball() {
    Real x = 0;
    Real y = 0;
    for (const Edge& edge : edges_) {
        x += edge.begin_x;
        y += edge.begin_y;
    }
    const Real scale = 1 / static_cast<Real>(edges_.size());
    x *= scale;
    y *= scale;
    Real radius2 = 0;
    for (const Edge& edge : edges_) {
        const Real dx = edge.begin_x - x;
        const Real dy = edge.begin_y - y;
        radius2 = std::max(radius2, dx * dx + dy * dy);
    }
    center_ = foot_ + x * u_ + y * v_;
    // A little more, so that no plane that coincides with this one is seen to be away from it.
    const Real reach = std::abs(center_.x) + std::abs(center_.y) + std::abs(center_.z);
    radius_ = (1 + 4 * rounding) * std::sqrt(radius2) + 4 * rounding * reach;
}

// ---- Measures of one face -------------------------------------------------------------------------------------------

inline void Face::finish() {
    if (edges_.empty()) {
        return;
    }
    for (Edge& edge : edges_) {
        const Real quarter = edge.b / (std::abs(edge.a) + std::abs(edge.b));
        edge.turn = edge.a >= 0 ? 1 + quarter : 3 - quarter;
    }
    std::sort(edges_.begin(), edges_.end(), [](const Edge& a, const Edge& b) { return a.turn < b.turn; });

    // The fan of triangles about the first corner.
    const Real x0 = edges_[0].begin_x;
    const Real y0 = edges_[0].begin_y;
    Real x = 0;
    Real y = 0;
    area_ = 0;
    for (std::size_t i = 1; i + 1 < edges_.size(); ++i) {
        const Real x1 = edges_[i].begin_x - x0;
        const Real y1 = edges_[i].begin_y - y0;
        const Real x2 = edges_[i + 1].begin_x - x0;
        const Real y2 = edges_[i + 1].begin_y - y0;
        const Real triangle = (x1 * y2 - y1 * x2) / 2;
        area_ += triangle;
        x += triangle / 3 * (x1 + x2);
        y += triangle / 3 * (y1 + y2);
    }
    centroid_ = foot_ + (area_ > 0 ? x0 + x / area_ : x0) * u_ + (area_ > 0 ? y0 + y / area_ : y0) * v_;
}

template <typename Visit>
void Face::for_each_anchor(Visit visit) const {
    bool any = false;
    const Edge* before = &edges_.back();
    for (const Edge& edge : edges_) {
        if (edge.neighbor >= 0 && before->neighbor >= 0) {
            visit(at(edge, edge.low));
            any = true;
        }
        before = &edge;
    }
    if (any) {
        return;
    }
    for (const Edge& edge : edges_) {
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
    for (const Edge& edge : edges_) {
        reach = std::max(reach, length(at(edge, edge.low)));
        perimeter += edge.high - edge.low;
    }
    // For a polygon around a circle, the left side is the circle's radius.
    return 2 * area_ / perimeter <= rounding * reach;
}

}  // namespace whitted::halfspaces
