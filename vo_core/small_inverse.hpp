#pragma once

#include <algorithm>

namespace cartvo {

/// Inverts the upper left corner of a symmetric matrix by L D L^T, written out: Eigen solves for each column
/// anew. The other elements of `inverse` are left as they are. False if the smallest pivot is not more than
/// `least_pivot` times the largest.
template <int Size, typename Matrix>
bool invertCorner(const Matrix& matrix, double least_pivot, Matrix& inverse) {
  double lower[Size][Size];  // L without its diagonal of ones, then its inverse
  double pivot_inverse[Size];
  double least = 0.0, most = 0.0;
#pragma GCC unroll 6
  for (int j = 0; j < Size; ++j) {
    double scaled[Size];  // the row of L times D
    double pivot = matrix(j, j);
#pragma GCC unroll 6
    for (int k = 0; k < j; ++k) {
      scaled[k] = lower[j][k];
      lower[j][k] *= pivot_inverse[k];
      pivot -= scaled[k] * lower[j][k];
    }
    least = j == 0 ? pivot : std::min(least, pivot);
    most = std::max(most, pivot);
    pivot_inverse[j] = 1.0 / pivot;
    // The column below, times its pivot.
#pragma GCC unroll 6
    for (int i = j + 1; i < Size; ++i) {
      double element = matrix(i, j);
#pragma GCC unroll 6
      for (int k = 0; k < j; ++k)
        element -= lower[i][k] * lower[j][k];
      lower[i][j] = element;
    }
  }
  if (!(least > least_pivot * most)) return false;
#pragma GCC unroll 6
  for (int j = 0; j < Size; ++j) {
#pragma GCC unroll 6
    for (int i = j + 1; i < Size; ++i) {
      double element = -lower[i][j];
#pragma GCC unroll 6
      for (int k = j + 1; k < i; ++k)
        element -= lower[i][k] * lower[k][j];
      lower[i][j] = element;
    }
  }
#pragma GCC unroll 6
  for (int i = 0; i < Size; ++i) {
#pragma GCC unroll 6
    for (int j = 0; j <= i; ++j) {
      double element = (i == j ? 1.0 : lower[i][j]) * pivot_inverse[i];
#pragma GCC unroll 6
      for (int k = i + 1; k < Size; ++k)
        element += lower[k][i] * lower[k][j] * pivot_inverse[k];
      inverse(i, j) = inverse(j, i) = element;
    }
  }
  return true;
}

}  // namespace cartvo
