#pragma once

namespace cartvo::capture {

/// Silences FFmpeg, which by default prints what it finds in files to stderr. Every user of FFmpeg in capture
/// calls it before its first use.
void keepFfmpegQuiet();

}  // namespace cartvo::capture
