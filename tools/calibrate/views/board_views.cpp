// Board views from image pairs: detection, and rejection of unusable views.
#include "tools/calibrate/views/board_views.hpp"

#include <algorithm>
#include <exception>
#include <map>
#include <mutex>
#include <stdexcept>

#include <opencv2/core/utility.hpp>

#include "calib/board/board_detection.hpp"
#include "capture/dataset/image_files.hpp"
#include "common/image_size.hpp"

namespace cartvo {
namespace {

void requireSize(const cv::Mat& image, cv::Size size, const std::filesystem::path& file) {
  if (image.size() == size) return;
  throw std::runtime_error(file.string() + ": is " + sizeText(image.size()) + " but the first image is " +
                           sizeText(size) + ": a calibration holds for one size only");
}

DetectedView detectPair(const ImagePair& pair, const capture::GreyLevels& levels,
                        const calib::BoardSpec& board, cv::Size size) {
  const cv::Mat left = capture::readGreyImage(pair.left, levels.left),
                right = capture::readGreyImage(pair.right, levels.right);
  requireSize(left, size, pair.left);
  requireSize(right, size, pair.right);
  return detectView(pair.name, left, right, board);
}

std::string cornerProblem(const char* side, const std::vector<calib::SeenCorner>& seen) {
  if (seen.empty()) return std::string("the ") + side + " image shows no board";
  if (seen.size() < kMinCornersPerImage)
    return std::string("the ") + side + " image shows only " + std::to_string(seen.size()) + " corners";
  return {};
}

double usualEdgeWidth(const std::vector<DetectedView>& detected) {
  std::vector<double> widths;
  for (const DetectedView& view : detected) {
    if (!view.view.left.empty()) widths.push_back(view.left.edge_width);
    if (!view.view.right.empty()) widths.push_back(view.right.edge_width);
  }
  if (widths.empty()) return 0.0;
  std::sort(widths.begin(), widths.end());
  return widths[widths.size() / 2];
}

/// Why a view is not usable; empty if it is.
std::string problemOf(const DetectedView& view, double usual_edge_width) {
  for (const std::string& problem :
       {cornerProblem("left", view.view.left), cornerProblem("right", view.view.right)}) {
    if (!problem.empty()) return problem;
  }
  if (const std::string problem = calib::qualityProblem(view.left, usual_edge_width); !problem.empty())
    return "left image: " + problem;
  if (const std::string problem = calib::qualityProblem(view.right, usual_edge_width); !problem.empty())
    return "right image: " + problem;
  return {};
}

[[noreturn]] void failWithoutViews(const std::vector<DetectedView>& detected, const BoardViews& views,
                                   const calib::BoardSpec& board) {
  std::string message = "no view shows the board " + calib::boardSpecText(board) + " to both cameras";
  const auto other = std::find_if(detected.begin(), detected.end(),
                                  [](const DetectedView& view) { return !view.other_board.empty(); });
  if (other != detected.end()) {
    message += "; view '" + other->view.name + "' shows " + other->other_board +
               ": is the board's size wrong? (a chessboard's inner corners are counted, not its squares)";
  } else if (!views.rejected.empty()) {
    message += "; the first: " + views.rejected.front().reason;
  }
  throw std::runtime_error(message);
}

}  // namespace

DetectedView detectView(const std::string& name, const cv::Mat& left, const cv::Mat& right,
                        const calib::BoardSpec& board) {
  DetectedView detected;
  detected.view = {name, calib::detectBoard(left, board), calib::detectBoard(right, board)};
  calib::matchNumbering(board, detected.view);
  const std::vector<Eigen::Vector2d> board_corners = calib::boardCorners(board);
  if (!detected.view.left.empty())
    detected.left = calib::viewQuality(left, detected.view.left, board_corners);
  if (!detected.view.right.empty())
    detected.right = calib::viewQuality(right, detected.view.right, board_corners);
  return detected;
}

BoardViews classifyViews(const std::vector<DetectedView>& detected, cv::Size image_size) {
  BoardViews result;
  result.image_size = image_size;
  const double usual_edge_width = usualEdgeWidth(detected);
  for (const DetectedView& view : detected) {
    const std::string problem = problemOf(view, usual_edge_width);
    if (problem.empty()) {
      result.views.push_back(view.view);
    } else {
      result.rejected.push_back({view.view.name, problem});
    }
  }
  return result;
}

void refuseLargerBoard(const std::vector<LargerBoardSample>& samples, const calib::BoardSpec& board) {
  constexpr std::size_t kMinAgreeing = 2;
  std::map<std::string, std::vector<std::string>> views;  // by the larger board that they show
  for (const LargerBoardSample& sample : samples) {
    if (const std::string seen = calib::describeLargerBoard(sample.image, board); !seen.empty())
      views[seen].push_back(sample.name);
  }
  for (const auto& [larger, names] : views) {
    if (names.size() < std::min(kMinAgreeing, samples.size())) continue;
    throw std::runtime_error(
        "view '" + names.front() + "' shows " + larger + ", more than --board " +
        calib::boardSpecText(board) +
        " has: corners of different views would be mixed up. Is the board's size wrong? (a "
        "chessboard's inner corners are counted, not its squares)");
  }
}

BoardViews selectViews(const std::vector<DetectedView>& detected, const calib::BoardSpec& board,
                       cv::Size image_size) {
  BoardViews result = classifyViews(detected, image_size);
  if (result.views.empty()) failWithoutViews(detected, result, board);
  return result;
}

BoardViews findViews(const ImagePairs& pairs, const calib::BoardSpec& board,
                     const DetectionProgress& progress) {
  const cv::Size size = capture::readGreyImage(pairs.pairs.front().left).size();
  std::vector<DetectedView> detected(pairs.pairs.size());
  std::vector<std::exception_ptr> problems(pairs.pairs.size());
  std::mutex mutex;
  std::size_t done = 0;
  cv::parallel_for_(
      {0, static_cast<int>(pairs.pairs.size())},
      [&](const cv::Range& range) {
        for (auto i = static_cast<std::size_t>(range.start); i < static_cast<std::size_t>(range.end); ++i) {
          try {
            detected[i] = detectPair(pairs.pairs[i], pairs.grey_levels, board, size);
          } catch (...) {
            problems[i] = std::current_exception();
          }
          const std::lock_guard lock(mutex);
          progress(++done);
        }
      },
      static_cast<double>(pairs.pairs.size()));
  for (const std::exception_ptr& problem : problems) {
    if (problem) std::rethrow_exception(problem);
  }
  if (std::none_of(detected.begin(), detected.end(),
                   [](const DetectedView& view) { return !view.view.left.empty(); })) {
    detected.front().other_board = calib::describeOtherBoard(
        capture::readGreyImage(pairs.pairs.front().left, pairs.grey_levels.left), board);
  }
  BoardViews views = selectViews(detected, board, size);
  std::vector<LargerBoardSample> samples;
  for (std::size_t i = 0; i < detected.size() && samples.size() < kLargerBoardSamples; ++i) {
    if (!detected[i].view.left.empty())
      samples.push_back(
          {detected[i].view.name, capture::readGreyImage(pairs.pairs[i].left, pairs.grey_levels.left)});
  }
  refuseLargerBoard(samples, board);
  views.rejected.insert(views.rejected.end(), pairs.unpaired.begin(), pairs.unpaired.end());
  return views;
}

}  // namespace cartvo
