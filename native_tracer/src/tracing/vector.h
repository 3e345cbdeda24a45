// Vectors and colours of three real numbers, or of three groups of lanes.

#pragma once

#include <cmath>

#include "tracing/isa.h"
#include "tracing/lanes.h"

namespace whitted::WHITTED_ISA {

template <typename T>
struct Vector {
    T x, y, z;

    Vector() = default;
    Vector(T x_, T y_, T z_) : x(x_), y(y_), z(z_) {}
    // The same vector in every lane, or in another precision.
    template <typename U>
    explicit Vector(const Vector<U>& v) : x(static_cast<T>(v.x)), y(static_cast<T>(v.y)), z(static_cast<T>(v.z)) {}

    friend Vector operator+(const Vector& a, const Vector& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
    friend Vector operator-(const Vector& a, const Vector& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
    friend Vector operator*(const Vector& a, const Vector& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
    friend Vector operator*(const T& s, const Vector& a) { return {s * a.x, s * a.y, s * a.z}; }
    friend Vector operator*(const Vector& a, const T& s) { return {a.x * s, a.y * s, a.z * s}; }
    friend Vector operator/(const Vector& a, const T& s) { return {a.x / s, a.y / s, a.z / s}; }
    friend Vector operator-(const Vector& a) { return {-a.x, -a.y, -a.z}; }
    Vector& operator+=(const Vector& other) { return *this = *this + other; }
};

// Red, green and blue, linear. The product of two colours is taken channel by channel.
template <typename T>
using Color = Vector<T>;

template <typename T>
T dot(const Vector<T>& a, const Vector<T>& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <typename T>
Vector<T> cross(const Vector<T>& a, const Vector<T>& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

template <typename T>
T length(const Vector<T>& a) {
    using std::sqrt;
    return sqrt(dot(a, a));
}

template <typename T>
Vector<T> normalize(const Vector<T>& a) {
    return a * (T(1) / length(a));
}

template <typename Real>
Vector<Lanes<Real>> select(Mask<Real> mask, const Vector<Lanes<Real>>& a, const Vector<Lanes<Real>>& b) {
    return {select(mask, a.x, b.x), select(mask, a.y, b.y), select(mask, a.z, b.z)};
}

template <typename Real>
Vector<Lanes<Real>> absolute(const Vector<Lanes<Real>>& a) {
    return {abs(a.x), abs(a.y), abs(a.z)};
}

// Largest magnitude of a coordinate.
template <typename Real>
Lanes<Real> max_norm(const Vector<Lanes<Real>>& a) {
    return max(max(abs(a.x), abs(a.y)), abs(a.z));
}

template <typename Real>
Vector<Real> lane_of(const Vector<Lanes<Real>>& v, int lane) {
    return {v.x[lane], v.y[lane], v.z[lane]};
}

// Lane i is value_of(i).
template <typename Real, typename ValueOf>
Vector<Lanes<Real>> gather(ValueOf value_of) {
    Vector<Real> values[lane_count<Real>];
    for (int lane = 0; lane < lane_count<Real>; ++lane) {
        values[lane] = value_of(lane);
    }
    return {Lanes<Real>::gather([&](int lane) { return values[lane].x; }),
            Lanes<Real>::gather([&](int lane) { return values[lane].y; }),
            Lanes<Real>::gather([&](int lane) { return values[lane].z; })};
}

}  // namespace whitted::WHITTED_ISA
