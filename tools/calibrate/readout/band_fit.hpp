#pragma once

#include <Eigen/Core>
#include <complex>
#include <cstddef>
#include <vector>

#include "tools/calibrate/readout/mains_bands.hpp"

namespace cartvo::calibrate {

/// Movement of the bands from one picture to the next.
struct BandAdvance {
  double period = 0.0;           ///< s
  std::complex<double> product;  ///< its angle is the change of the phase, its magnitude the weight
};

/// Fits moving bands to the row profiles of a scene at standstill: brightness over the temporal mean of the
/// row = 1 + Re(A(row) exp(i phase(picture))), where the phase of A grows linearly with the row and its
/// magnitude is free, since the lamp may light only a part of the scene.
class BandFit {
 public:
  /// Searches for the number of bands with the most power, from 0.5 to 25 across the picture.
  explicit BandFit(const std::vector<RowProfile>& profiles);

  /// Movement of the bands between consecutive pictures.
  const std::vector<BandAdvance>& advances() const { return advances_; }

  /// Number of bands across the picture (positive), from all pictures; leaves out parts of pictures in which
  /// something else changed. The standard deviation is from the scatter over pictures and over blocks of
  /// columns.
  Estimate refine();

  /// Amplitude of the bands relative to the mean brightness, RMS over the picture; after refine().
  double amplitude() const;

 private:
  /// Returns the signals without the mean and the trend over the rows of each picture.
  std::vector<Eigen::MatrixXd> normalise(const std::vector<RowProfile>& profiles);
  void searchBands(const std::vector<Eigen::MatrixXd>& level_signals);
  void measureAdvances(const std::vector<RowProfile>& profiles,
                       const std::vector<Eigen::MatrixXd>& level_signals);
  void fitRows(Eigen::Index excluded_begin, Eigen::Index excluded_end);
  void fitPhases();
  void updateWeights();
  /// Slope of the phases of A, per block, around `bands`; and their information.
  void fitSlopes(double bands, Eigen::VectorXd& slopes, Eigen::VectorXd& information) const;
  double bandsFromRows() const;
  double blockScatter(double bands) const;

  Eigen::Index rows_ = 0, pictures_ = 0;
  Eigen::VectorXd shares_;                ///< of the readout, of each row
  std::vector<Eigen::MatrixXd> signals_;  ///< per block: rows x pictures
  Eigen::MatrixXd weights_;               ///< blocks x pictures
  double bands_ = 0.0;                    ///< across the picture
  std::vector<BandAdvance> advances_;
  Eigen::VectorXd phases_;           ///< of the pictures
  std::vector<Eigen::VectorXcd> A_;  ///< per block: of the rows
};

}  // namespace cartvo::calibrate
