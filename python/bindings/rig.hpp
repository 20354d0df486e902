#pragma once

#include <cstdint>
#include <memory>

#include "calib/model/rig.hpp"
#include "calib/rectification/rectifier.hpp"
#include "pipeline/shutters.hpp"

namespace cartvo::python {

/// A rig and its rectifier, as the Python class Rectifier holds them.
class RigRectifier {
 public:
  /// Throws std::invalid_argument if the rig cannot be rectified.
  explicit RigRectifier(const calib::Rig& rig)
      : rig_(rig), rectifier_(rig, rig.rectification, calib::buildTables(rig, rig.rectification)) {}

  const calib::Rig& rig() const { return rig_; }
  const calib::Rectifier& rectifier() const { return rectifier_; }

 private:
  calib::Rig rig_;
  calib::Rectifier rectifier_;
};

/// Readout of a camera whose rig states none.
inline pipeline::AbsentReadout absentReadout(bool is_unknown) {
  return is_unknown ? pipeline::AbsentReadout::unknown : pipeline::AbsentReadout::global_shutter;
}

}  // namespace cartvo::python
