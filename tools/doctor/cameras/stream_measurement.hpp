#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/types.hpp>

#include "capture/encoded_unit.hpp"

// Measurements of one camera's stream.

namespace cartvo::doctor {

/// Values that are kept of each received picture.
struct ReceivedPicture {
  std::int64_t time_ns = 0;           ///< by the camera: RTP time of IP cameras, else the exposure
  std::int64_t first_arrival_ns = 0;  ///< host's clock, as EncodedUnit; 0: unknown
  std::optional<std::int64_t> reference_us = {};  ///< as EncodedUnit
  std::uint64_t sequence = 0;                     ///< as EncodedUnit
  std::size_t bytes = 0;                          ///< 0: not encoded
  bool key = false, data_lost = false;
};

/// As ReceivedPicture of an encoded one.
ReceivedPicture receivedPicture(const capture::EncodedUnit& unit);

/// Everything received of one camera.
struct StreamMeasurement {
  std::optional<capture::VideoCodec> codec;  ///< nothing: not encoded
  cv::Size size;                             ///< px; empty: no picture was decoded
  std::vector<ReceivedPicture> pictures;
  std::vector<double> decode_times;  ///< s, last packet to decoded picture
  std::string problem;               ///< what the source reports; empty: nothing
  bool is_refused = false;           ///< the login
};

/// Statistics of the pictures. Times are nothing, and rates 0, where there are too few pictures.
struct StreamStatistics {
  double seconds = 0.0;    ///< first to last picture
  double rate = 0.0;       ///< Hz, by the camera's clock
  double host_rate = 0.0;  ///< Hz, by the host's clock; 0: unknown
  double host_rate_stddev = 0.0;
  double uneven = 0.0;                 ///< standard deviation of the intervals, share of the period
  double largest_gap = 0.0;            ///< s
  double bit_rate = 0.0;               ///< bit/s
  std::optional<double> key_interval;  ///< s, the largest; nothing: fewer than two key pictures
  std::uint64_t losses = 0;            ///< pictures before or in which data are missing
  bool has_b_frames = false;           ///< pictures are not sent in the order of their exposure
  double arrival_jitter = 0.0;         ///< s, 95 % of the arrivals are delayed by less
  /// Least arrival (host's clock) minus exposure by the sender reports (camera's clock), s; nothing: there
  /// are no reports.
  std::optional<double> latency;
  double report_spread = 0.0;  ///< s, by which the reports disagree about the camera's clock
};

StreamStatistics statisticsOf(const StreamMeasurement& measurement);

}  // namespace cartvo::doctor
