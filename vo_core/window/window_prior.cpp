// The marginal prior of a window.
#include <Eigen/Cholesky>

#include "vo_core/window/window_problem.hpp"

namespace cartvo::vo {

void WindowPrior::extendTo(const Trajectory& trajectory) {
  const Eigen::Index before = information.rows();
  for (int i = static_cast<int>(first.size()); i < trajectory.size(); ++i)
    first.push_back(trajectory.knot(i));
  const Eigen::Index unknowns = columnOf(static_cast<int>(first.size()));
  if (unknowns == before) return;
  Eigen::MatrixXd grown = Eigen::MatrixXd::Zero(unknowns, unknowns);
  Eigen::VectorXd longer = Eigen::VectorXd::Zero(unknowns);
  grown.topLeftCorner(before, before) = information;
  longer.head(before) = vector;
  information.swap(grown);
  vector.swap(longer);
}

void WindowPrior::marginaliseOldest(int knots) {
  if (knots <= 0) return;
  const Eigen::Index gone = 6 * knots, rest = information.rows() - gone;
  const auto kept = [&](Eigen::Index i) { return i < kSharedStates ? i : i + gone; };
  Eigen::MatrixXd reduced(rest, rest), cross(gone, rest);
  Eigen::VectorXd shorter(rest);
  for (Eigen::Index column = 0; column < rest; ++column) {
    shorter[column] = vector[kept(column)];
    cross.col(column) = information.block(kSharedStates, kept(column), gone, 1);
    for (Eigen::Index row = 0; row < rest; ++row)
      reduced(row, column) = information(kept(row), kept(column));
  }
  Eigen::MatrixXd oldest = information.block(kSharedStates, kSharedStates, gone, gone);
  constexpr double kLeastInformation = 1e-6;  // 1/m^2 and 1/rad^2, of a knot that nothing is known of
  oldest.diagonal().array() += kLeastInformation;
  const Eigen::LDLT<Eigen::MatrixXd> factor(oldest);
  const Eigen::MatrixXd solved = factor.solve(cross);
  reduced.noalias() -= cross.transpose() * solved;
  shorter.noalias() -= solved.transpose() * vector.segment(kSharedStates, gone);
  information = 0.5 * (reduced + reduced.transpose());
  vector = shorter;
  first.erase(first.begin(), first.begin() + knots);
}

void WindowPrior::addSharedNoise(const SharedVector& variances) {
  for (int state = 0; state < kSharedStates; ++state) {
    if (!(variances[state] > 0.0)) continue;
    // The old state is eliminated: a new one differs from it by the noise.
    const double by_noise = 1.0 / variances[state], total = information(state, state) + by_noise;
    Eigen::VectorXd cross = information.col(state);
    cross[state] = -by_noise;
    const double old_gradient = vector[state];
    information.row(state).setZero();
    information.col(state).setZero();
    information(state, state) = by_noise;
    vector[state] = 0.0;
    information.noalias() -= cross * cross.transpose() / total;
    vector -= cross * (old_gradient / total);
  }
}

Eigen::VectorXd WindowPrior::changeTo(const SharedVector& shared, const Trajectory& trajectory) const {
  Eigen::VectorXd change(information.rows());
  change.head<kSharedStates>() = shared - first_shared;
  for (std::size_t i = 0; i < first.size(); ++i) {
    const Eigen::Isometry3d& knot = trajectory.knot(static_cast<int>(i));
    Eigen::Isometry3d turn = Eigen::Isometry3d::Identity();
    turn.linear() = first[i].linear().transpose() * knot.linear();
    const Eigen::Index at = columnOf(static_cast<int>(i));
    change.segment<3>(at) = knot.translation() - first[i].translation();
    change.segment<3>(at + 3) = vectorFromMotion(turn).tail<3>();
  }
  return change;
}

}  // namespace cartvo::vo
