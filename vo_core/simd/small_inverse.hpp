#pragma once

#include "vo_core/simd/double_lanes.hpp"

namespace cartvo::vo {

/// Inverts the upper left Size x Size corner of four symmetric matrices, one SIMD lane each, by L D L^T. Only
/// elements on and below the diagonal are read; elements of `inverse` outside the corner are left as they
/// are. `regular`: lanes whose smallest pivot is more than `least_pivot` times the largest.
template <int Size, int Side>
void invertCorner(const DoubleLanes (&matrix)[Side][Side], double least_pivot,
                  DoubleLanes (&inverse)[Side][Side], MaskLanes& regular) {
  DoubleLanes lower[Size][Size];  // L without its diagonal of ones, then its inverse
  DoubleLanes pivot_inverse[Size];
  DoubleLanes least{}, most{};
#pragma GCC unroll 6
  for (int j = 0; j < Size; ++j) {
    DoubleLanes scaled[Size];  // the row of L times D
    DoubleLanes pivot = matrix[j][j];
#pragma GCC unroll 6
    for (int k = 0; k < j; ++k) {
      scaled[k] = lower[j][k];
      lower[j][k] *= pivot_inverse[k];
      pivot -= scaled[k] * lower[j][k];
    }
    least = j == 0 ? pivot : (pivot < least ? pivot : least);
    most = most < pivot ? pivot : most;
    pivot_inverse[j] = 1.0 / pivot;
    // The column below, times its pivot.
#pragma GCC unroll 6
    for (int i = j + 1; i < Size; ++i) {
      DoubleLanes element = matrix[i][j];
#pragma GCC unroll 6
      for (int k = 0; k < j; ++k)
        element -= lower[i][k] * lower[j][k];
      lower[i][j] = element;
    }
  }
  regular = least > least_pivot * most;
#pragma GCC unroll 6
  for (int j = 0; j < Size; ++j) {
#pragma GCC unroll 6
    for (int i = j + 1; i < Size; ++i) {
      DoubleLanes element = -lower[i][j];
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
      DoubleLanes element = pivot_inverse[i];
      if (i != j) element *= lower[i][j];
#pragma GCC unroll 6
      for (int k = i + 1; k < Size; ++k)
        element += lower[k][i] * lower[k][j] * pivot_inverse[k];
      inverse[i][j] = inverse[j][i] = element;
    }
  }
}

}  // namespace cartvo::vo
