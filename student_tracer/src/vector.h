// Vectors and colours of three numbers, and triples of doubles, in which they are given and recorded.

#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace student {

template <typename Real>
struct Vector {
    Real x = 0, y = 0, z = 0;

    friend Vector operator+(Vector a, Vector b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
    friend Vector operator-(Vector a, Vector b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
    friend Vector operator*(Vector a, Vector b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
    friend Vector operator*(Real s, Vector a) { return {s * a.x, s * a.y, s * a.z}; }
    friend Vector operator/(Vector a, Real s) { return {a.x / s, a.y / s, a.z / s}; }
    friend Vector operator-(Vector a) { return {-a.x, -a.y, -a.z}; }
    Vector& operator+=(Vector other) { return *this = *this + other; }
};

template <typename Real>
using Color = Vector<Real>;

using Triple = std::array<double, 3>;

template <typename Real>
Vector<Real> vector_of(const Triple& v) {
    return {static_cast<Real>(v[0]), static_cast<Real>(v[1]), static_cast<Real>(v[2])};
}

template <typename Real>
Triple triple(Vector<Real> v) {
    return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

template <typename Real>
Real dot(Vector<Real> a, Vector<Real> b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <typename Real>
Vector<Real> cross(Vector<Real> a, Vector<Real> b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

template <typename Real>
Real length(Vector<Real> a) {
    return std::sqrt(dot(a, a));
}

template <typename Real>
Vector<Real> normalize(Vector<Real> a) {
    return a / length(a);
}

// Largest magnitude of a coordinate.
template <typename Real>
Real reach(Vector<Real> a) {
    return std::max({std::abs(a.x), std::abs(a.y), std::abs(a.z)});
}

template <typename Real>
Color<Real> clamped(Color<Real> c) {
    const auto channel = [](Real v) { return std::clamp(v, Real(0), Real(1)); };
    return {channel(c.x), channel(c.y), channel(c.z)};
}

}  // namespace student
