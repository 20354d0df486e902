#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pipeline/source_rig.hpp"
#include "tools/benchmark/sequence.hpp"

// Faults and hardships that are added to a sequence of good image pairs.

namespace cartvo::benchmark {

/// The part of a sequence that a disturbance changes.
enum class DisturbanceKind : std::uint8_t {
  none,
  pairs,     ///< some pairs are missing
  picture,   ///< both images are changed
  jumps,     ///< the cameras jump between two directions
  exposure,  ///< the right camera is exposed half a period later
  rig,       ///< a gross fault, at which no motion is right
};

struct Disturbance {
  std::string name;         ///< as on the command line
  std::string explanation;  ///< what is done, for the help text
  DisturbanceKind kind = DisturbanceKind::none;
};

/// All disturbances; the first is "none", with which the others are compared.
const std::vector<Disturbance>& allDisturbances();

/// The disturbance of a name. Throws std::invalid_argument if there is none.
const Disturbance& disturbanceNamed(const std::string& name);

/// A disturbed sequence that can be played once.
struct DisturbedSequence {
  capture::StereoSource source;
  pipeline::FoundRig rig;
  SequenceTruth truth;  ///< of the left images that are played
};

/// Opens a sequence of synchronised cameras and disturbs it; the same arguments give the same images. Not for
/// `exposure` on rendered worlds, whose right images depend on the offset: they are rendered with it.
DisturbedSequence disturbed(const Sequence& sequence, const Disturbance& disturbance);

}  // namespace cartvo::benchmark
