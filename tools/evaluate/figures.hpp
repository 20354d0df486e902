#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/evaluate/association.hpp"
#include "tools/evaluate/evaluation.hpp"
#include "tools/evaluate/ground_paths.hpp"
#include "tools/evaluate/motion_comparison.hpp"
#include "tools/evaluate/validity/validity_figures.hpp"
#include "tools/report/chart.hpp"
#include "tools/report/drawing.hpp"

namespace cartvo {

/// An estimate that a report compares with the truth.
struct ReportInput {
  std::string estimate, odometry;  ///< names of its files; odometry empty: no messages are known
  AssociatedTrajectories associated;
  Evaluation evaluation;
  TopView view = TopView::camera_axes;
  std::vector<ComparedMessage> messages;  ///< in the order of time; empty: none are known
  pipeline::AlertLimits limits;           ///< in the figures of errors and bounds
};

/// A chart of a report with its numbers.
struct Figure {
  std::string name;  ///< of its files, without extension
  Chart chart;
  std::string caption;
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;  ///< evenly spread over the chart if there are many
};

/// Charts of the paths, errors over distance and over time, segments, and, of a single estimate with
/// messages, of velocities, rates, NEES and bounds. Charts over time need files with times or messages. A
/// panel without a value is left out. `inputs` must not be empty.
std::vector<Figure> evaluationFigures(const std::vector<ReportInput>& inputs);

/// The paths and the errors over distance as one drawing.
Drawing evaluationPlot(const std::vector<ReportInput>& inputs);

/// Stanford diagrams, as far as there are values: errors of VALID velocities and rates against their bounds,
/// component by component.
std::vector<Figure> boundFigures(const std::vector<JudgedMessage>& messages,
                                 const pipeline::AlertLimits& limits);

/// Whether the covariances of the messages are right, in words.
std::string consistencyVerdict(const std::vector<ComparedMessage>& messages);

/// Charts of velocities, rates and NEES, as far as there are values; `messages` must not be empty.
std::vector<Figure> motionFigures(const std::vector<ComparedMessage>& messages);

/// Parts of the time in which the messages are not valid, s since the first; the first message, which can
/// have no motion, is left out.
std::vector<ChartSpan> invalidSpans(const std::vector<ComparedMessage>& messages);

/// Indices of at most 30 of `count` values, evenly spread, with the first and the last.
std::vector<std::size_t> spreadIndices(std::size_t count);

}  // namespace cartvo
