// Sums of a window's normal equations over SIMD lanes.
#include "vo_core/window/window_sums.hpp"

#include <algorithm>

namespace cartvo::vo {
namespace {

#pragma GCC diagnostic push
#if !defined(__clang__)
#pragma GCC diagnostic ignored "-Wpacked-not-aligned"
#endif
/// Four doubles anywhere in memory.
struct __attribute__((packed, may_alias)) FreeLanes {
  DoubleLanes value;
};
#pragma GCC diagnostic pop

FreeLanes& lanesAt(double* values) {
  return *reinterpret_cast<FreeLanes*>(values);
}
const FreeLanes& lanesAt(const double* values) {
  return *reinterpret_cast<const FreeLanes*>(values);
}

/// Adds a row of derivatives by a camera's pose (two groups of ObservationState) to those by its knots.
inline void addToKnots(const KnotMap& map, const double* states, double* knots) {
  const DoubleLanes position = lanesAt(states).value;
  const DoubleLanes tiles[3] = {position, __builtin_shufflevector(position, position, 0, 0, 0, 1),
                                __builtin_shufflevector(position, position, 2, 2, 2, 2)};
#pragma GCC unroll 6
  for (int group = 0; group < kKnotGroups; ++group)
    lanesAt(knots + kDoubleLanes * group).value +=
        (map.position[group] * tiles[group % 3] + map.turn[0][group] * states[4]) +
        (map.turn[1][group] * states[5] + map.turn[2][group] * states[6]);
}

constexpr bool isGap(int state) {
  return state == kRowLeftTurn + 3 || state == kRowRightPosition + 3 || state == kRowRightTurn + 3;
}

/// Products of two rows with their weighted values, from the diagonal on. Both depend on the states before
/// kStates and on the residuals only.
template <int kStates>
inline void addProducts(const double* x, const double* y, double x_weight, double y_weight, BandSums& band) {
  const auto depends = [](int group) { return group * kDoubleLanes < kStates || group == kStateGroups - 1; };
  DoubleLanes x_lanes[kStateGroups], y_lanes[kStateGroups];
#pragma GCC unroll 6
  for (int group = 0; group < kStateGroups; ++group) {
    if (!depends(group)) continue;
    x_lanes[group] = lanesAt(x + kDoubleLanes * group).value;
    y_lanes[group] = lanesAt(y + kDoubleLanes * group).value;
  }
#pragma GCC unroll 24
  for (int state = 0; state < kStates; ++state) {
    if (isGap(state)) continue;
    const double by_x = x_weight * x[state], by_y = y_weight * y[state];
#pragma GCC unroll 6
    for (int group = state / kDoubleLanes; group < kStateGroups; ++group)
      if (depends(group)) band.products[state][group] += by_x * x_lanes[group] + by_y * y_lanes[group];
  }
}

/// Adds derivatives by ObservationState (of shared states and the residuals) to columns from `shared` on.
inline void addShared(const double* states, double factor, double* shared) {
  static_assert(kRowResidual - kRowRightReadout == kSharedStates - kRightReadout);
  shared[kLeftReadout] += factor * states[kRowLeftReadout];
#pragma GCC unroll 2
  for (int i = 0; i < 2 * kDoubleLanes; i += kDoubleLanes)
    lanesAt(shared + kRightReadout + i).value += factor * lanesAt(states + kRowRightReadout + i).value;
}

CARTVO_TARGET_CLONES
void addObservation(const ObservationEquations& equations, const Eigen::Vector4d& weight, BandSums& band,
                    std::size_t stride, int shared, double* rows) {
  const auto row = [&](int i) { return equations.by_state.data() + kObservationStates * i; };
  const bool stereo = weight[2] > 0.0;
  addProducts<kRowRightPosition>(row(0), row(1), weight[0], weight[1], band);
  if (stereo) addProducts<kRowResidual>(row(2), row(3), weight[2], weight[3], band);
  for (int place = 0; place < 3; ++place, rows += stride) {
    alignas(DoubleLanes) double states[kObservationStates];
    const auto factor = [&](int i) { return weight[i] * equations.by_place.data()[3 * i + place]; };
#pragma GCC unroll 6
    for (int at = 0; at < kObservationStates; at += kDoubleLanes) {
      DoubleLanes sum = factor(0) * lanesAt(row(0) + at).value + factor(1) * lanesAt(row(1) + at).value;
      if (stereo) sum += factor(2) * lanesAt(row(2) + at).value + factor(3) * lanesAt(row(3) + at).value;
      lanesAt(states + at).value = sum;
    }
    addToKnots(band.left, states, rows + 6 * band.left.first);
    if (stereo) addToKnots(band.right, states + kRowRightPosition, rows + 6 * band.right.first);
    addShared(states, 1.0, rows + shared);
  }
}

/// Adds a band's equations, whose derivatives by the states are linear maps of those by the unknowns, right
/// of the diagonal. `row`: of unknowns.
CARTVO_TARGET_CLONES
void addBand(const BandSums& band, std::size_t stride, int shared, double* row, double* sums) {
  const int begin = 6 * std::min(band.left.first, band.right.first);
  const int end = 6 * (std::max(band.left.first, band.right.first) + Trajectory::kSupport);
  for (int state = 0; state < kRowResidual; ++state) {
    if (isGap(state)) continue;
    alignas(DoubleLanes) double states[kObservationStates];
    for (int i = 0; i < kObservationStates; ++i)
      states[i] = band(state, i);
    const auto sums_of = [&](int to) { return sums + stride * static_cast<std::size_t>(to); };
    if (state >= kRowRightReadout)
      addShared(states, 1.0, sums_of(shared + kRightReadout + state - kRowRightReadout) + shared);
    if (state == kRowLeftReadout) addShared(states, 1.0, sums_of(shared + kLeftReadout) + shared);
    if (state >= kRowRightReadout || state == kRowLeftReadout) continue;
    std::fill(row + begin, row + end + kDoubleLanes, 0.0);
    addToKnots(band.left, states, row + 6 * band.left.first);
    addToKnots(band.right, states + kRowRightPosition, row + 6 * band.right.first);
    const KnotMap& map = state < kRowRightPosition ? band.left : band.right;
    const int axis = state % kDoubleLanes;
    const bool turn = state % kRowRightPosition >= kRowLeftTurn;
    const double* const factors = reinterpret_cast<const double*>(turn ? map.turn[axis] : map.position);
    for (int i = 0; i < 6 * Trajectory::kSupport; ++i) {
      if (turn ? i % 6 < 3 : i % 6 != axis) continue;
      const int to = 6 * map.first + i;
      double* const sum = sums_of(to);
      for (int column = to & ~1; column < end; column += kDoubleLanes)
        lanesAt(sum + column).value += factors[i] * lanesAt(row + column).value;
      addShared(states, factors[i], sum + shared);
    }
  }
}

CARTVO_TARGET_CLONES
void multiplyByRoot(const Eigen::Matrix3d& root, int from, std::size_t stride, double* rows) {
  const double a = root(0, 0), b = root(1, 0), c = root(1, 1), d = root(2, 0), e = root(2, 1), f = root(2, 2);
  for (std::size_t i = static_cast<std::size_t>(from); i < stride; i += kDoubleLanes) {
    DoubleLanes &x = reinterpret_cast<DoubleLanes&>(rows[i]),
                &y = reinterpret_cast<DoubleLanes&>(rows[i + stride]),
                &z = reinterpret_cast<DoubleLanes&>(rows[i + 2 * stride]);
    z = d * x + e * y + f * z;
    y = b * x + c * y;
    x = a * x;
  }
}

/// Subtracts the products of the columns from `from` on, a multiple of eight: tiles of four by eight stay in
/// registers. `triangular`: the rows are zero right of the diagonal.
CARTVO_TARGET_CLONES
void subtractProducts(const double* rows, std::size_t count, std::size_t from, std::size_t stride,
                      bool triangular, double* sums) {
  const auto lanes = [](const double* values) -> const DoubleLanes& {
    return *reinterpret_cast<const DoubleLanes*>(values);
  };
  for (std::size_t i = from; i < stride; i += kDoubleLanes) {
    for (std::size_t j = i & ~std::size_t{7}; j < stride; j += 8) {
      DoubleLanes left[kDoubleLanes] = {}, right[kDoubleLanes] = {};
      for (std::size_t row = triangular ? j : 0; row < count; ++row) {
        const double* const values = rows + row * stride;
        const DoubleLanes a = lanes(values + j), b = lanes(values + j + kDoubleLanes);
#pragma GCC unroll 4
        for (int k = 0; k < kDoubleLanes; ++k) {
          left[k] += values[i + static_cast<std::size_t>(k)] * a;
          right[k] += values[i + static_cast<std::size_t>(k)] * b;
        }
      }
#pragma GCC unroll 4
      for (int k = 0; k < kDoubleLanes; ++k) {
        double* const sum = sums + (i + static_cast<std::size_t>(k)) * stride + j;
        lanesAt(sum).value -= left[k];
        lanesAt(sum + kDoubleLanes).value -= right[k];
      }
    }
  }
}

/// Inverts a lower triangular matrix of `count` rows in place; right of the diagonal, it is zero.
CARTVO_TARGET_CLONES
void invertTriangular(std::size_t count, std::size_t stride, double* rows) {
  for (std::size_t i = 0; i < count; ++i) {
    double* const own = rows + i * stride;
    const double by_pivot = 1.0 / own[i];
    // Four columns use those of the row from theirs on, and then replace them.
    for (std::size_t j = 0; j <= i; j += kDoubleLanes) {
      DoubleLanes sum{};
      for (std::size_t k = j; k < i; ++k)
        sum -= own[k] * lanesAt(rows + k * stride + j).value;
      if (i - j < kDoubleLanes) sum[i - j] = 1.0;
      lanesAt(own + j).value = sum * by_pivot;
    }
  }
}

CARTVO_TARGET_CLONES
void multiplyByStep(const double* rows, std::size_t from, std::size_t stride, const double* step,
                    double* products) {
  for (int row = 0; row < 3; ++row, rows += stride) {
    DoubleLanes sum{};
    for (std::size_t i = from; i < stride; i += kDoubleLanes)
      sum += lanesAt(rows + i).value * lanesAt(step + i).value;
    products[row] = sumOf(sum);
  }
}

/// Sums or rows as a matrix.
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

}  // namespace

void KnotMap::set(const Trajectory::Instant& instant) {
  first = instant.first;
  for (int knot = 0; knot < Trajectory::kSupport; ++knot) {
    const auto set = [&](DoubleLanes* row, const Eigen::RowVector3d& of_position,
                         const Eigen::RowVector3d& of_turn) {
      double* const values = reinterpret_cast<double*>(row) + 6 * knot;
      for (int axis = 0; axis < 3; ++axis) {
        values[axis] = of_position[axis];
        values[axis + 3] = of_turn[axis];
      }
    };
    set(position, Eigen::RowVector3d::Constant(instant.by_knot[knot]), Eigen::RowVector3d::Zero());
    for (int axis = 0; axis < 3; ++axis)
      set(turn[axis], Eigen::RowVector3d::Zero(), instant.turn_by_knot[knot].row(axis));
  }
}

void BandSums::reset(const WindowBand& band) {
  left.set(band.left);
  right.set(band.right);
  for (auto& row : products)
    std::fill(std::begin(row), std::end(row), DoubleLanes{});
}

void WindowSums::reset(int knots, std::size_t landmarks) {
  knots_ = knots;
  count_ = 0;
  blocks_ = static_cast<std::size_t>(columnOf(knots) + 1 + 7) / 8;
  sums_.assign(8 * blocks_ * blocks_, {});
  row_.resize(blocks_);
  rows_.resize(3 * blocks_ * (landmarks + 1));
  std::fill_n(rows_.begin(), 3 * blocks_, Block{});
  first_.assign(landmarks + 1, knots);
}

void WindowSums::add(const ObservationEquations& equations, const Eigen::Vector4d& weight, BandSums& band) {
  addObservation(equations, weight, band, 8 * blocks_, shared(), rowOf(3 * count_));
  first_[count_] = std::min({first_[count_], band.left.first, band.right.first});
}

void WindowSums::add(const BandSums& band) {
  addBand(band, 8 * blocks_, shared(), row_.front().value, sums_.front().value);
}

std::size_t WindowSums::eliminate(const Eigen::Matrix3d& root) {
  multiplyByRoot(root, 6 * first_[count_] / kDoubleLanes * kDoubleLanes, 8 * blocks_, rowOf(3 * count_));
  std::fill_n(rows_.begin() + static_cast<std::ptrdiff_t>(3 * blocks_ * (count_ + 1)), 3 * blocks_, Block{});
  return count_++;
}

void WindowSums::subtractEliminated() {
  constexpr std::size_t kAtOnce = 8;  // landmarks, whose rows fit into the first-level cache
  for (std::size_t begin = 0; begin < count_; begin += kAtOnce) {
    const std::size_t end = std::min(begin + kAtOnce, count_);
    const int first = *std::min_element(first_.begin() + static_cast<std::ptrdiff_t>(begin),
                                        first_.begin() + static_cast<std::ptrdiff_t>(end));
    subtractProducts(rowOf(3 * begin), 3 * (end - begin),
                     static_cast<std::size_t>(6 * first) & ~std::size_t{7}, 8 * blocks_, false,
                     sums_.front().value);
  }
}

void WindowSums::copyTo(Eigen::MatrixXd& information, Eigen::VectorXd& gradient) const {
  const Eigen::Index knots = shared(), unknowns = columnOf(knots_);
  const auto stride = static_cast<Eigen::Index>(8 * blocks_);
  const Eigen::Map<const RowMajor> sums(sums_.front().value, stride, stride);
  information.resize(unknowns, unknowns);
  information.topLeftCorner<kSharedStates, kSharedStates>() =
      sums.block<kSharedStates, kSharedStates>(knots, knots).selfadjointView<Eigen::Upper>();
  information.bottomLeftCorner(knots, kSharedStates) = sums.block(0, knots, knots, kSharedStates);
  information.topRightCorner(kSharedStates, knots) =
      information.bottomLeftCorner(knots, kSharedStates).transpose();
  information.bottomRightCorner(knots, knots) =
      sums.topLeftCorner(knots, knots).selfadjointView<Eigen::Upper>();
  gradient.resize(unknowns);
  gradient << sums.col(unknowns).segment<kSharedStates>(knots), sums.col(unknowns).head(knots);
}

void WindowSums::setStep(const Eigen::VectorXd& step) {
  row_.assign(blocks_, {});
  Eigen::Map<Eigen::VectorXd> row(row_.front().value, step.size() + 1);
  row << -step.tail(shared()), -step.head<kSharedStates>(), 1.0;
}

Eigen::Vector3d WindowSums::stepOf(std::size_t landmark) const {
  Eigen::Vector3d product;
  const int from = 6 * first_[landmark] / kDoubleLanes * kDoubleLanes;
  multiplyByStep(rows_[3 * blocks_ * landmark].value, static_cast<std::size_t>(from), 8 * blocks_,
                 row_.front().value, product.data());
  return product;
}

Eigen::MatrixXd WindowSums::inverseBy(const Eigen::MatrixXd& root) {
  const Eigen::Index unknowns = root.rows();
  const auto stride = static_cast<Eigen::Index>(8 * blocks_);
  rows_.assign(blocks_ * static_cast<std::size_t>(unknowns), {});
  sums_.assign(8 * blocks_ * blocks_, {});
  Eigen::Map<RowMajor> rows(rows_.front().value, unknowns, stride);
  rows.leftCols(unknowns).triangularView<Eigen::Lower>() = root;
  invertTriangular(static_cast<std::size_t>(unknowns), 8 * blocks_, rows.data());
  subtractProducts(rows.data(), static_cast<std::size_t>(unknowns), 0, 8 * blocks_, true,
                   sums_.front().value);
  const Eigen::Map<const RowMajor> sums(sums_.front().value, stride, stride);
  Eigen::MatrixXd inverse(unknowns, unknowns);
  inverse = (-sums.topLeftCorner(unknowns, unknowns)).selfadjointView<Eigen::Upper>();
  return inverse;
}

}  // namespace cartvo::vo
