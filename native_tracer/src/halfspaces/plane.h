// A half-space, and the arithmetic that everything about half-spaces is computed with.
//
// Planes are read as the doubles they are, and everything is computed in long double. Three decisions allow for the
// rounding the coefficients went through when they were written or computed (a relative 2^-53 each, which moves a plane
// by up to 2^-53 of the distance from the origin, and turns it by up to 2^-53, and a few operations made more of it):
// `rounding` is 32 times that.
//   - Two planes whose angle is smaller are parallel.
//   - A face that is narrower, relative to its distance from the origin, is none: its plane only touches the body.
//   - A body that is thinner, relative to its distance from the origin, has no volume.
// Planes that touch are told from planes that exclude each other by a hair more strictly, with `few_roundings`: as
// planes of several bodies are told to be the same one.
// Nothing is compared with an absolute length, so that scaling a body, or its planes' coefficients, changes nothing.

#pragma once

#include <cmath>
#include <limits>

namespace whitted::halfspaces {

using Real = long double;

inline constexpr Real rounding = 16 * std::numeric_limits<double>::epsilon();      // 2^-48: of the coefficients
inline constexpr Real few_roundings = 4 * std::numeric_limits<double>::epsilon();  // as in converter/scene/coplanar.py
inline constexpr Real noise = 8 * std::numeric_limits<Real>::epsilon();            // of the arithmetic here

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

}  // namespace whitted::halfspaces
