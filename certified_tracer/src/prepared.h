// A scene in intervals of one kind.

#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "double_interval.h"
#include "elementary.h"
#include "scene.h"

namespace certified {

template <typename I>
struct Vector {
    I x, y, z;

    friend Vector operator+(const Vector& a, const Vector& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
    friend Vector operator-(const Vector& a, const Vector& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
    friend Vector operator-(const Vector& a) { return {-a.x, -a.y, -a.z}; }
    friend Vector operator*(const I& s, const Vector& a) { return {s * a.x, s * a.y, s * a.z}; }
    friend I dot(const Vector& a, const Vector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
    friend I length2(const Vector& a) { return square(a.x) + square(a.y) + square(a.z); }
    friend Vector cross(const Vector& a, const Vector& b) {
        return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    }
    friend Vector normalized(const Vector& a) {
        const I length = sqrt(length2(a));
        return {a.x / length, a.y / length, a.z / length};
    }
};

template <typename End>
Interval<End> enclosed(const Number& number) {
    using I = Interval<End>;
    I sum(number.parts.front());
    for (std::size_t i = 1; i < number.parts.size(); ++i) {
        sum += I(number.parts[i]);
    }
    return number.error == 0 ? sum : sum + up_to(I(number.error));
}

template <typename End>
Vector<Interval<End>> enclosed(const Triple& triple) {
    return {enclosed<End>(triple[0]), enclosed<End>(triple[1]), enclosed<End>(triple[2])};
}

template <typename End>
struct PreparedScene {
    using I = Interval<End>;
    using V = Vector<I>;

    struct PreparedLight {
        V position, color;
        I a, b, c;
    };

    struct PreparedSurface {
        Kind kind;
        int identity;
        bool eye;
        const std::vector<bool>* lights;
        V vector;                   // a sphere's centre, a plane's unit normal
        I number;                   // a sphere's radius, a plane's offset to that normal
        std::array<I, 10> numbers;  // a quadric's
    };

    struct PreparedPigment {
        V first, second;
        I size;
        V columns, rows;
        I column, row;
    };

    struct PreparedFinish {
        I ka, kd, ks, alpha, kr, kt, eta;  // eta: n1/n2
        bool lit, reflects, transmits;
    };

    explicit PreparedScene(const Scene& described) : scene(described) {
        eye = enclosed<End>(scene.eye);
        const V forward = normalized(enclosed<End>(scene.look_at) - eye);
        const V across = normalized(cross(forward, enclosed<End>(scene.up)));
        // By wider numbers: it is the first of all, and its width is in every pixel.
        const Interval<Wide<4>> wide = tangent_of_half(enclosed<Wide<4>>(scene.fovy));
        I tangent;
        if constexpr (std::is_same_v<End, double>) {
            tangent = I::between(wide.low_double(), wide.high_double());
        } else {
            tangent = tangent_of_half(enclosed<End>(scene.fovy));
        }
        view = forward;
        right = tangent * across;
        up = tangent * cross(across, forward);
        ambient = enclosed<End>(scene.ambient);
        background = enclosed<End>(scene.background);
        cutoff = enclosed<End>(scene.cutoff);
        for (const Light& light : scene.lights) {
            lights.push_back({enclosed<End>(light.position), enclosed<End>(light.color),
                              enclosed<End>(light.attenuation[0]), enclosed<End>(light.attenuation[1]),
                              enclosed<End>(light.attenuation[2])});
        }
        for (const Surface& surface : scene.surfaces) {
            surfaces.push_back(prepared(surface));
        }
        for (const Pigment& p : scene.pigments) {
            PreparedPigment result{
                enclosed<End>(p.first), enclosed<End>(p.second), enclosed<End>(p.size), {}, {}, 0, 0};
            if (p.pattern == Pattern::texmap) {
                const I width = p.width, height = p.height;
                const auto scaled = [](const std::array<Number, 4>& numbers, const I& scale) {
                    return scale * enclosed<End>(Triple{numbers[0], numbers[1], numbers[2]});
                };
                result.columns = scaled(p.columns, width);
                result.rows = scaled(p.rows, height);
                result.column = width * enclosed<End>(p.columns[3]);
                result.row = height * enclosed<End>(p.rows[3]);
            }
            pigments.push_back(result);
        }
        for (const Finish& f : scene.finishes) {
            const I ior = enclosed<End>(f.ior), kd = enclosed<End>(f.kd), ks = enclosed<End>(f.ks);
            const I kr = enclosed<End>(f.kr), kt = enclosed<End>(f.kt);
            finishes.push_back({enclosed<End>(f.ka), kd, ks, enclosed<End>(f.alpha), kr, kt,
                                kt.is_zero()     ? I(1)
                                : f.ior_is_index ? I(1) / ior
                                                 : ior,
                                !kd.is_zero() || !ks.is_zero(), !kr.is_zero(), !kt.is_zero()});
        }
    }

    const Scene& scene;
    V eye, view, right, up, ambient, background;
    I cutoff;
    std::vector<PreparedLight> lights;
    std::vector<PreparedSurface> surfaces;
    std::vector<PreparedPigment> pigments;
    std::vector<PreparedFinish> finishes;

 private:
    static PreparedSurface prepared(const Surface& surface) {
        PreparedSurface result{surface.kind, surface.identity, surface.eye, &surface.lights, {}, 0, {}};
        const auto number = [&](std::size_t i) { return enclosed<End>(surface.numbers[i]); };
        switch (surface.kind) {
            case Kind::sphere:
                result.vector = {number(0), number(1), number(2)};
                result.number = number(3);
                break;
            case Kind::plane: {
                const V normal{number(0), number(1), number(2)};
                const I length = sqrt(length2(normal));
                result.vector = {normal.x / length, normal.y / length, normal.z / length};
                result.number = number(3) / length;
                break;
            }
            case Kind::quadric:
                for (std::size_t i = 0; i < 10; ++i) {
                    result.numbers[i] = number(i);
                }
        }
        return result;
    }
};

}  // namespace certified
