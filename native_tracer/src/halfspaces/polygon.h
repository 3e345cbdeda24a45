// Convex polygons that half-planes are cut off from, one after the other (Sutherland and Hodgman, "Reentrant Polygon
// Clipping", CACM 17(1), 1974).
//
// A polygon is kept as edges, each an interval on a line. Cutting shortens the intervals and adds one; every end is
// computed from two lines, never from an end that was computed before. The edges are ordered by their directions, so
// that of many the few that a line meets are found by a search, as tangents are (O'Rourke, "Computational Geometry in
// C", 2nd ed., 1998, section 7.9).

#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <map>
#include <vector>

#include "halfspaces/plane.h"

namespace whitted::halfspaces {

// The half-plane a x + b y + c <= 0.
struct HalfPlane {
    Real a = 0, b = 0, c = 0;

    Real height(Real x, Real y) const { return a * x + b * y + c; }  // above its border, times the length of (a, b)
};

// Part of a half-plane's border: the points -c (a, b) + t (-b, a), low <= t <= high. The half-plane is to the left of
// the direction (-b, a); (a, b) is a unit vector.
struct Edge : HalfPlane {
    int neighbor = -1;  // what is beyond, the number of a plane; -1: the square's border
    Real sine = 1;      // of the angle between the polygon's plane and that one
    Real low = 0, high = 0;
    Real begin_x = 0, begin_y = 0;  // the point at t = low

    void begin_at(Real t) {
        low = t;
        begin_x = x(t);
        begin_y = y(t);
    }
    Real x(Real t) const { return -c * a - t * b; }
    Real y(Real t) const { return -c * b + t * a; }
    Real nearest() const { return std::clamp(Real(0), low, high); }  // where it is nearest the origin
};

struct Corner {
    Real x = 0, y = 0;
};

class Polygon {
 public:
    // By `turn_of` each: counterclockwise.
    using Edges = std::multimap<Real, Edge>;

    // A square around the origin, `far` half its size.
    explicit Polygon(Real far);

    bool empty() const { return edges_.empty(); }
    const Edges& edges() const { return edges_; }
    // A circle around the corners.
    const Corner& center() const { return center_; }
    Real radius() const { return std::sqrt(radius2_); }

    // Whether all of it lies in a half-plane, but for noise; a `touch` is as good as none. (a, b) may have any length.
    bool misses(const HalfPlane& half_plane, Real touch) const;

    // Keep what lies in the half-plane of an edge, on which no end is known yet.
    void cut_by(Edge fresh, Real touch);

    void clear() { edges_.clear(); }

    bool has_few_edges() const { return edges_.size() <= few; }

    // A few points around it: its corners, or if it has many edges those of an octagon.
    std::vector<Corner> outline() const;

 private:
    using Iterator = Edges::iterator;
    using ConstIterator = Edges::const_iterator;

    // Neighbouring edges, counterclockwise; the first edge of all follows the last one.
    struct Run {
        Iterator first;
        std::size_t count;
    };

    // With more edges than that, those at hand are searched for.
    static constexpr std::size_t few = 32;

    // Ascends with the angle of the direction (-b, a).
    static Real turn_of(Real a, Real b) {
        const Real quarter = b / (std::abs(a) + std::abs(b));
        return a >= 0 ? 1 + quarter : 3 - quarter;
    }
    ConstIterator after(ConstIterator edge) const { return ++edge == edges_.end() ? edges_.begin() : edge; }
    ConstIterator before(ConstIterator edge) const { return std::prev(edge == edges_.begin() ? edges_.end() : edge); }
    Iterator after(Iterator edge) { return ++edge == edges_.end() ? edges_.begin() : edge; }
    Iterator before(Iterator edge) { return std::prev(edge == edges_.begin() ? edges_.end() : edge); }
    bool in_circle(const Edge& edge) const {
        const Real x = edge.begin_x - center_.x;
        const Real y = edge.begin_y - center_.y;
        return x * x + y * y <= radius2_;
    }
    static Real sine_between(const Edge& fresh, const Edge& edge) { return fresh.b * edge.a - fresh.a * edge.b; }
    static Real cosine_between(const Edge& fresh, const Edge& edge) { return fresh.a * edge.a + fresh.b * edge.b; }
    static bool parallel(const Edge& fresh, const Edge& edge) {
        return std::abs(sine_between(fresh, edge)) * std::min(fresh.sine, edge.sine) <= noise;
    }
    Run edges_near(const Edge& fresh);
    bool settle_parallels(const Run& run, const Edge& fresh, Real touch);
    void shorten(const Run& run, Edge& fresh);
    void drop_empty(const Run& run);
    bool insert(Edge fresh);
    bool is_noise() const;
    void find_circle();

    Edges edges_;
    Corner center_;
    Real radius2_ = 0;
};

inline Polygon::Polygon(Real far) {
    for (int i = 0; i < 4; ++i) {
        Edge edge;
        edge.a = i == 0 ? 1 : i == 2 ? -1 : 0;
        edge.b = i == 1 ? 1 : i == 3 ? -1 : 0;
        edge.c = -far;
        edge.high = far;
        edge.begin_at(-far);
        edges_.emplace(turn_of(edge.a, edge.b), edge);
    }
    find_circle();
}

inline bool Polygon::misses(const HalfPlane& half_plane, Real touch) const {
    const auto inside = [&](const Edge& edge) {
        return half_plane.height(edge.begin_x, edge.begin_y) <=
               touch + noise * (std::abs(edge.begin_x) + std::abs(edge.begin_y));
    };
    if (has_few_edges()) {
        return std::all_of(edges_.begin(), edges_.end(), [&](const auto& item) { return inside(item.second); });
    }
    // The corner that lies farthest out. Noise may make it one of its neighbours.
    ConstIterator outermost = edges_.upper_bound(turn_of(half_plane.a, half_plane.b));
    outermost = outermost == edges_.end() ? edges_.begin() : outermost;
    return inside(outermost->second) && inside(before(outermost)->second) && inside(after(outermost)->second);
}

// The edges of which something may be cut off, and some more.
inline Polygon::Run Polygon::edges_near(const Edge& fresh) {
    if (has_few_edges()) {
        return {edges_.begin(), edges_.size()};
    }
    const auto begins_well_inside = [&](Iterator edge) {
        const Real x = edge->second.begin_x;
        const Real y = edge->second.begin_y;
        return fresh.height(x, y) < -16 * noise * (std::abs(x) + std::abs(y) + std::abs(fresh.c));
    };
    // From the corner that lies farthest out, both ways.
    Iterator last = edges_.upper_bound(turn_of(fresh.a, fresh.b));
    last = last == edges_.end() ? edges_.begin() : last;
    Run run{before(last), 2};
    while (run.count < edges_.size() && !begins_well_inside(after(last))) {
        last = after(last);
        ++run.count;
    }
    while (run.count < edges_.size() && !begins_well_inside(run.first)) {
        run.first = before(run.first);
        ++run.count;
    }
    // Noise may have the line meet the next ones.
    if (run.count + 2 <= edges_.size()) {
        run.first = before(run.first);
        run.count += 2;
    }
    return run;
}

inline void Polygon::cut_by(Edge fresh, Real touch) {
    const Run run = edges_near(fresh);
    if (!settle_parallels(run, fresh, touch)) {
        return;
    }
    shorten(run, fresh);
    drop_empty(run);
    const bool in_same_circle = fresh.low < fresh.high && insert(fresh);
    if (is_noise()) {
        edges_.clear();
    } else if (has_few_edges() || !in_same_circle) {
        find_circle();
    }
}

// Of parallel lines on the same side the inner one counts, between lines on opposite sides something has to be left.
// One decision is made for both lines, and before anything is changed. False if nothing is left to be cut.
inline bool Polygon::settle_parallels(const Run& run, const Edge& fresh, Real touch) {
    Iterator place = run.first;
    for (std::size_t i = 0; i < run.count; ++i, place = after(place)) {
        Edge& edge = place->second;
        if (!parallel(fresh, edge)) {
            continue;
        }
        const Real t = edge.nearest();
        const Real height = fresh.height(edge.x(t), edge.y(t));
        if (cosine_between(fresh, edge) < 0) {
            if (height > 0) {
                edges_.clear();
                return false;
            }
        } else if (height * fresh.sine <= touch + noise * (std::abs(edge.c) + std::abs(t))) {
            return false;
        } else {
            edge.high = edge.low;
        }
    }
    return true;
}

// Where edges and the fresh one end at one another.
inline void Polygon::shorten(const Run& run, Edge& fresh) {
    fresh.low = -std::numeric_limits<Real>::infinity();
    fresh.high = std::numeric_limits<Real>::infinity();
    Iterator place = run.first;
    for (std::size_t i = 0; i < run.count; ++i, place = after(place)) {
        Edge& edge = place->second;
        if (parallel(fresh, edge)) {
            continue;
        }
        const Real sine = sine_between(fresh, edge);
        const Real cosine = cosine_between(fresh, edge);
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
}

inline void Polygon::drop_empty(const Run& run) {
    Iterator place = run.first;
    for (std::size_t i = 0; i < run.count; ++i) {
        const Iterator next = after(place);
        if (!(place->second.low < place->second.high)) {
            edges_.erase(place);
        }
        place = next;
    }
}

// Whether the circle around the corners still holds them.
inline bool Polygon::insert(Edge fresh) {
    fresh.begin_at(fresh.low);
    const Iterator inserted = edges_.emplace(turn_of(fresh.a, fresh.b), fresh);
    return in_circle(fresh) && in_circle(after(inserted)->second);
}

// Of a strip that is narrow for its length, the short edges may be lost in rounding. Other polygons with less than
// three edges are the noise of something without a width.
inline bool Polygon::is_noise() const {
    const auto strip = [](const Edge& e, const Edge& f) {
        return e.a * f.a + e.b * f.b < 0 && std::abs(e.a * f.b - e.b * f.a) < 0x1p-20L;
    };
    return edges_.size() < 3 && !(edges_.size() == 2 && strip(edges_.begin()->second, edges_.rbegin()->second));
}

inline void Polygon::find_circle() {
    center_ = {};
    for (const auto& [turn, edge] : edges_) {
        center_.x += edge.begin_x;
        center_.y += edge.begin_y;
    }
    const Real scale = 1 / static_cast<Real>(edges_.size());
    center_.x *= scale;
    center_.y *= scale;
    radius2_ = 0;
    for (const auto& [turn, edge] : edges_) {
        const Real dx = edge.begin_x - center_.x;
        const Real dy = edge.begin_y - center_.y;
        radius2_ = std::max(radius2_, dx * dx + dy * dy);
    }
}

inline std::vector<Corner> Polygon::outline() const {
    std::vector<Corner> corners;
    if (has_few_edges()) {
        for (const auto& [turn, edge] : edges_) {
            corners.push_back({edge.begin_x, edge.begin_y});
        }
        return corners;
    }
    // One side of the octagon faces the corner that is farthest from the middle: the polygon may be long and narrow.
    Corner longest{1, 0};
    Real most = 0;
    for (const auto& [turn, edge] : edges_) {
        const Corner arm{edge.begin_x - center_.x, edge.begin_y - center_.y};
        const Real square = arm.x * arm.x + arm.y * arm.y;
        if (square > most) {
            most = square;
            longest = arm;
        }
    }
    const Real half = std::sqrt(Real(0.5));
    const Real scale = most > 0 ? 1 / std::sqrt(most) : 1;
    Corner direction{scale * longest.x, scale * longest.y};
    Corner directions[8];
    Real reaches[8];
    for (std::size_t i = 0; i < 8; ++i) {
        directions[i] = direction;
        reaches[i] = 0;
        for (const auto& [turn, edge] : edges_) {
            reaches[i] = std::max(reaches[i],
                                  direction.x * (edge.begin_x - center_.x) + direction.y * (edge.begin_y - center_.y));
        }
        reaches[i] += 4 * noise * (std::sqrt(most) + std::abs(center_.x) + std::abs(center_.y));
        direction = {half * (direction.x - direction.y), half * (direction.x + direction.y)};
    }
    for (std::size_t i = 0; i < 8; ++i) {
        // Where this side ends: sideways of its direction, which is at 45 degrees to the next one.
        const Real along = reaches[(i + 1) % 8] / half - reaches[i];
        corners.push_back({center_.x + reaches[i] * directions[i].x - along * directions[i].y,
                           center_.y + reaches[i] * directions[i].y + along * directions[i].x});
    }
    return corners;
}

}  // namespace whitted::halfspaces
