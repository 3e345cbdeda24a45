// The face polygons of an intersection of half-spaces.
//
// A face polygon is plane k cut by all other half-spaces, one after the other (de Berg, Cheong, van Kreveld and
// Overmars, "Computational Geometry", 3rd ed., 2008, ch. 4; Sutherland and Hodgman, "Reentrant Polygon Clipping", CACM
// 17(1), 1974). It is kept as edges, each an interval on the line where plane k meets another plane. Cutting shortens
// the intervals and adds one. Ends may stay infinite, so that no border has to be put around what has none, and every
// end is computed from three planes, never from an end that was computed before. Quadratic in the number of planes.
//
// Planes are read as the doubles they are, and everything is computed in long double. Three decisions allow for the
// rounding the coefficients went through when they were written or computed (a relative 2^-53 each, which moves a plane
// by up to 2^-53 of the distance from the origin, and turns it by up to 2^-53, and a few operations made more of it):
// `rounding` is 32 times that.
//   - Two planes whose angle is smaller are parallel. (An edge and a plane count as parallel a little earlier.)
//   - A face that is narrower, relative to its distance from the origin, is none: its plane only touches the body.
//   - A body that is thinner, relative to its distance from the origin, has no volume.
// Nothing is compared with an absolute length, so that scaling a body, or its planes' coefficients, changes nothing.

#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

namespace whitted::halfspaces {

using Real = long double;

inline constexpr Real infinity = std::numeric_limits<Real>::infinity();
inline constexpr Real rounding = 16 * std::numeric_limits<double>::epsilon();  // 2^-48: of the coefficients
inline constexpr Real parallel = 32 * rounding;  // so that nothing is so long as to be narrow or thin for that
inline constexpr Real noise = 8 * std::numeric_limits<Real>::epsilon();  // of the arithmetic here

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
    int neighbor = -1;
    Real sine = 0;  // of the angle between the two planes
    Real a = 0, b = 0, c = 0;
    Real low = -infinity, high = infinity;
    Real begin_x = 0, begin_y = 0;  // the point at t = low, or where that is infinite, at the anchor
    Real turn = 0;                  // ascends with the angle of the direction

    void begin_at(Real t) {
        low = t;
        begin_x = x(t);
        begin_y = y(t);
    }
    bool has_begin() const { return low > -infinity; }
    bool has_end() const { return high < infinity; }
    Real x(Real t) const { return -c * a - t * b; }
    Real y(Real t) const { return -c * b + t * a; }
    // Some parameter of the edge: of an end, if there is one.
    Real anchor() const { return has_begin() ? low : has_end() ? high : 0; }
};

// What is left of one plane when others have cut it.
class Face {
 public:
    Face(const std::vector<Plane>& planes, int self);

    bool empty() const { return empty_; }
    bool finite() const { return finite_; }
    Real area() const { return area_; }                        // of a finite face, after finish()
    const Vec& centroid() const { return centroid_; }          // likewise
    const std::vector<Edge>& edges() const { return edges_; }  // counterclockwise, if the face is finite and finished

    // The point of an edge in space.
    Vec at(const Edge& edge, Real t) const { return in_space(edge.x(t), edge.y(t)); }

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

    // Points of the face: its vertices, or where it has none, those nearest the origin.
    template <typename Visit>
    void for_each_anchor(Visit visit) const;

 private:
    Vec in_space(Real x, Real y) const { return foot_ + x * u_ + y * v_; }
    void settle_parallel(const Plane& cut, int other);
    bool ball_misses(const Plane& cut) const;
    bool misses(Real a, Real b, Real c, Real touch) const;
    void find_ball();
    void clear() {
        edges_.clear();
        empty_ = true;
    }

    const std::vector<Plane>* planes_;
    int self_;
    Plane plane_;
    Vec foot_, u_, v_;  // origin and axes of the face's coordinates; u, v and the plane's normal are right-handed
    bool empty_ = false;
    bool finite_ = false;
    // A ball around the corners, and the two directions in which an infinite face goes on from there.
    Vec center_;
    Real radius_ = infinity;
    Vec away_[2];
    Real reach_ = 0;  // how far from the origin the corners are, at most
    Real area_ = 0;
    Vec centroid_;
    std::vector<Edge> edges_;
};

// ---- Cutting one face -----------------------------------------------------------------------------------------------

inline Face::Face(const std::vector<Plane>& planes, int self)
    : planes_(&planes), self_(self), plane_(planes[static_cast<std::size_t>(self)]), foot_(plane_.foot()) {
    // The axis across which the normal is longest: for a normal along an axis, u and v are exact.
    const Vec& n = plane_.normal;
    const Real x = std::abs(n.x);
    const Real y = std::abs(n.y);
    const Real z = std::abs(n.z);
    u_ = cross(x <= y && x <= z ? Vec{1, 0, 0} : y <= z ? Vec{0, 1, 0} : Vec{0, 0, 1}, n);
    u_ = (1 / length(u_)) * u_;
    v_ = cross(n, u_);
    edges_.reserve(8);
}

// A plane that is parallel to this one. Of planes that coincide the one with the lowest index has the face.
inline void Face::settle_parallel(const Plane& cut, int other) {
    const Real doubt = rounding * std::max(std::abs(plane_.offset), std::abs(cut.offset));
    const bool same_side = dot(plane_.normal, cut.normal) > 0;
    const Real height = same_side ? cut.offset - plane_.offset : cut.offset + plane_.offset;
    const bool coincide = std::abs(height) <= doubt;
    if (same_side && coincide ? other < self_ : height >= -doubt) {
        clear();
    }
}

// Whether the whole face is inside the half-space of `cut`, and clearly so.
inline bool Face::ball_misses(const Plane& cut) const {
    return cut.distance(center_) < -radius_ &&
           (finite_ || (dot(cut.normal, away_[0]) <= parallel && dot(cut.normal, away_[1]) <= parallel));
}

// Whether the whole face lies where a x + b y + c <= touch.
inline bool Face::misses(Real a, Real b, Real c, Real touch) const {
    return finite_ && std::all_of(edges_.begin(), edges_.end(),
                                  [&](const Edge& edge) { return a * edge.begin_x + b * edge.begin_y + c <= touch; });
}

// Whether two lines in a face are parallel, but for the roundings of the planes that made them: given the sine of their
// angle, and the smaller of those planes' sines to the face. The direction of a line is known to `rounding` over its
// plane's sine. Where that is not small, a plane being nearly the face's own, lines that are taken for parallel might
// meet nearby: there the coefficients are believed.
inline bool lines_are_parallel(Real sine, Real plane_sine) {
    constexpr Real small = 0x1p-16L;
    return sine == 0 || (plane_sine * small >= parallel && std::abs(sine) * plane_sine <= parallel);
}

inline void Face::cut_by(int other) {
    const Plane& cut = (*planes_)[static_cast<std::size_t>(other)];
    if (empty_ || other == self_ || ball_misses(cut)) {
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
    const Real touch = noise * (reach_ + std::abs(plane_.offset) + std::abs(cut.offset));
    if (misses(fresh.a, fresh.b, fresh.c, touch)) {
        return;
    }
    fresh.sine = std::sqrt(sine2);
    const Real scale = 1 / fresh.sine;
    fresh.a *= scale;
    fresh.b *= scale;
    fresh.c *= scale;
    const auto sine_between = [&](const Edge& edge) { return fresh.b * edge.a - fresh.a * edge.b; };
    const auto cosine_between = [&](const Edge& edge) { return fresh.a * edge.a + fresh.b * edge.b; };
    const auto is_parallel = [&](const Edge& edge, Real sine) {
        return lines_are_parallel(sine, std::min(edge.sine, fresh.sine));
    };
    // Of parallel lines on the same side the inner one counts, between lines on opposite sides something has to be
    // left. One decision is made for both lines, and before anything is changed.
    for (Edge& edge : edges_) {
        if (!is_parallel(edge, sine_between(edge))) {
            continue;
        }
        const Real t = edge.anchor();
        const Real height = fresh.a * edge.x(t) + fresh.b * edge.y(t) + fresh.c;
        if (cosine_between(edge) < 0) {
            if (height > 0) {
                clear();
                return;
            }
        } else if (height * fresh.sine <= touch) {
            return;
        } else {
            edge.high = -infinity;
        }
    }
    for (Edge& edge : edges_) {
        const Real sine = sine_between(edge);
        if (!is_parallel(edge, sine)) {
            const Real cosine = cosine_between(edge);
            const Real edge_t = (edge.c * cosine - fresh.c) / sine;
            const Real fresh_t = (edge.c - fresh.c * cosine) / sine;
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
    }
    std::erase_if(edges_, [](const Edge& edge) { return !(edge.low < edge.high); });
    if (fresh.low < fresh.high) {
        fresh.begin_at(fresh.low);
        edges_.push_back(fresh);
    }
    // Edges go around in a ring, or from infinity to infinity, or are two parallel lines. Where some are missing, those
    // left over are the noise of a face without a width.
    const auto begins = std::count_if(edges_.begin(), edges_.end(), [](const Edge& e) { return e.has_begin(); });
    const auto ends = std::count_if(edges_.begin(), edges_.end(), [](const Edge& e) { return e.has_end(); });
    const auto count = static_cast<std::ptrdiff_t>(edges_.size());
    finite_ = begins == count && ends == count;
    const bool whole = finite_ ? count >= 3 : begins == ends && (begins == count - 1 || (begins == 0 && count == 2));
    if (!whole) {
        clear();
    } else {
        find_ball();
    }
}

inline void Face::find_ball() {
    if (edges_.size() < 2) {
        return;  // a half-plane, which is more than its edge and two directions
    }
    std::size_t directions = 0;
    Real x = 0;
    Real y = 0;
    for (Edge& edge : edges_) {
        if (!edge.has_begin()) {
            const Real t = edge.anchor();
            edge.begin_x = edge.x(t);
            edge.begin_y = edge.y(t);
            away_[directions++ % 2] = edge.b * u_ - edge.a * v_;
        }
        if (!edge.has_end()) {
            away_[directions++ % 2] = edge.a * v_ - edge.b * u_;
        }
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
    center_ = in_space(x, y);
    reach_ = std::abs(center_.x) + std::abs(center_.y) + std::abs(center_.z) + std::sqrt(radius2);
    radius_ = std::sqrt(radius2) + 4 * rounding * reach_;  // so that no plane that coincides with this one misses it
}

// ---- Measures of one face -------------------------------------------------------------------------------------------

inline void Face::finish() {
    if (!finite_ || empty_) {
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
    Real moment_x = 0;
    Real moment_y = 0;
    area_ = 0;
    for (std::size_t i = 1; i + 1 < edges_.size(); ++i) {
        const Real x1 = edges_[i].begin_x - x0;
        const Real y1 = edges_[i].begin_y - y0;
        const Real x2 = edges_[i + 1].begin_x - x0;
        const Real y2 = edges_[i + 1].begin_y - y0;
        const Real triangle = (x1 * y2 - y1 * x2) / 2;
        area_ += triangle;
        moment_x += triangle / 3 * (x1 + x2);
        moment_y += triangle / 3 * (y1 + y2);
    }
    centroid_ = area_ > 0 ? in_space(x0 + moment_x / area_, y0 + moment_y / area_) : in_space(x0, y0);
}

template <typename Visit>
void Face::for_each_anchor(Visit visit) const {
    if (edges_.empty()) {
        visit(foot_);
    }
    for (const Edge& edge : edges_) {
        visit(at(edge, edge.anchor()));
        if (!finite_ && edge.has_end()) {
            visit(at(edge, edge.high));
        }
    }
}

inline bool Face::narrow() const {
    Real reach = 0;
    for_each_anchor([&](const Vec& p) { reach = std::max(reach, length(p)); });
    if (finite_) {
        // For a polygon around a circle this is the circle's radius.
        Real perimeter = 0;
        for (const Edge& edge : edges_) {
            perimeter += edge.high - edge.low;
        }
        return 2 * area_ <= rounding * reach * perimeter;
    }
    // What goes on without end is narrow between two parallel edges only.
    for (const Edge& e : edges_) {
        for (const Edge& f : edges_) {
            const bool in_step = lines_are_parallel(f.b * e.a - f.a * e.b, std::min(e.sine, f.sine));
            const Real t = e.anchor();
            if (in_step && e.a * f.a + e.b * f.b < 0 && -(f.a * e.x(t) + f.b * e.y(t) + f.c) <= rounding * reach) {
                return true;
            }
        }
    }
    return false;
}

}  // namespace whitted::halfspaces
