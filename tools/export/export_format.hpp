#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "tools/export/export_source.hpp"

namespace cartvo {

/// Format of an exported file.
enum class ExportFormat : std::uint8_t { mcap, rosbag2_mcap, lcm_log, tum, kitti, euroc, csv };

/// Names as on the command line, in the order of ExportFormat.
std::vector<std::string> exportFormatNames();

/// Throws std::invalid_argument for another name.
ExportFormat exportFormatNamed(const std::string& name);

/// Called with the number of pictures written so far; only for formats with video.
using ExportProgress = std::function<void(std::size_t pictures)>;

/// The files that writeExport writes: `output`, or those in the folder `output` for a bag of ROS 2.
std::vector<std::filesystem::path> exportedFiles(ExportFormat format, const std::filesystem::path& output);

/// Writes the source in a format. Each file appears when it is complete. Throws std::runtime_error naming the
/// file and the reason.
void writeExport(const ExportSource& source, ExportFormat format, const std::filesystem::path& output,
                 const ExportProgress& progress);

}  // namespace cartvo
