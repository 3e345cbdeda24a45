// The principal axes of a cloud of points: the eigenvectors of a symmetric matrix, by Jacobi's rotations (Golub and Van
// Loan, "Matrix Computations", 4th ed., 2013, section 8.5).

#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace whitted {

template <typename Real, std::size_t size>
using SquareMatrix = std::array<std::array<Real, size>, size>;

// Orthogonal unit vectors in which the matrix is diagonal, as columns.
template <typename Real, std::size_t size>
SquareMatrix<Real, size> principal_axes(SquareMatrix<Real, size> matrix) {
    SquareMatrix<Real, size> axes{};
    for (std::size_t i = 0; i < size; ++i) {
        axes[i][i] = 1;
    }
    constexpr int most_sweeps = 12;  // half of them will do
    bool rotated = true;
    for (int sweep = 0; rotated && sweep < most_sweeps; ++sweep) {
        rotated = false;
        for (std::size_t i = 0; i < size; ++i) {
            for (std::size_t j = i + 1; j < size; ++j) {
                const Real least = std::numeric_limits<Real>::epsilon() * std::sqrt(std::abs(matrix[i][i])) *
                                   std::sqrt(std::abs(matrix[j][j]));
                if (std::abs(matrix[i][j]) <= least) {
                    continue;
                }
                rotated = true;
                const Real apart = matrix[j][j] - matrix[i][i];
                const Real twice = std::copysign(2 * matrix[i][j], apart < 0 ? -matrix[i][j] : matrix[i][j]);
                const Real tangent = twice / (std::abs(apart) + std::hypot(apart, twice));
                const Real cosine = 1 / std::sqrt(1 + tangent * tangent);
                const Real sine = tangent * cosine;
                const auto rotate = [&](Real& a, Real& b) {
                    const Real before = a;
                    a = cosine * before - sine * b;
                    b = sine * before + cosine * b;
                };
                for (std::size_t k = 0; k < size; ++k) {
                    rotate(matrix[k][i], matrix[k][j]);
                }
                for (std::size_t k = 0; k < size; ++k) {
                    rotate(matrix[i][k], matrix[j][k]);
                    rotate(axes[k][i], axes[k][j]);
                }
            }
        }
    }
    return axes;
}

}  // namespace whitted
