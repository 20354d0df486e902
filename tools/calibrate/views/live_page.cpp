// HTTP server of the live calibration page.
#include "tools/calibrate/views/live_page.hpp"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <stdexcept>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "common/http/http_service.hpp"
#include "tools/calibrate/views/live_page_files.hpp"
#include "tools/calibrate/views/stream_views.hpp"

namespace cartvo {
namespace {

using Clock = std::chrono::steady_clock;

// State of a live calibration as JSON, and its camera pictures as JPEG.

using Json = nlohmann::ordered_json;

Json previewState(const CameraPreview& preview) {
  return {{"corners", preview.corners.size()},
          {"coverage", preview.coverage.corners},
          {"covered", preview.coverage.share()}};
}

/// The progress of the collection of views as JSON, for the page's script.
Json liveState(const StreamProgress& progress) {
  Json state{{"seconds", progress.seconds},
             {"advice", progress.advice},
             {"next", progress.next_view_advice},
             {"enough_views", kTargetViewCount},
             {"columns", calib::ImageCoverage::kColumns},
             {"rows", calib::ImageCoverage::kRows},
             {"left", previewState(progress.left)},
             {"right", previewState(progress.right)},
             {"tilts",
              {{"left", progress.tilts.to_left},
               {"right", progress.tilts.to_right},
               {"up", progress.tilts.up},
               {"down", progress.tilts.down}}},
             {"views", Json::array()},
             {"rejected", Json::array()}};
  for (const calib::BoardView& view : progress.so_far.views) {
    state["views"].push_back(
        {{"name", view.name}, {"left_corners", view.left.size()}, {"right_corners", view.right.size()}});
  }
  for (const calib::RejectedView& view : progress.so_far.rejected)
    state["rejected"].push_back({{"name", view.name}, {"reason", view.reason}});
  return state;
}

/// A camera's picture with its corners as JPEG, at most 960 px wide. Empty without a picture.
std::string liveJpeg(const CameraPreview& preview) {
  constexpr int kMaxWidth = 960, kQuality = 80, kFractionBits = 4;  // px; percent; of cv::circle
  constexpr double kRadius = 3.0;                                   // px
  if (preview.image.empty()) return {};
  const double scale = std::min(1.0, static_cast<double>(kMaxWidth) / preview.image.cols);
  cv::Mat picture;
  cv::resize(preview.image, picture, {}, scale, scale, cv::INTER_AREA);
  cv::cvtColor(picture, picture, cv::COLOR_GRAY2BGR);
  const auto fixed = [](double value) { return cvRound(value * (1 << kFractionBits)); };
  for (const calib::SeenCorner& corner : preview.corners) {
    const Eigen::Vector2d at = scale * (corner.pixel.array() + 0.5).matrix() - Eigen::Vector2d(0.5, 0.5);
    cv::circle(picture, {fixed(at.x()), fixed(at.y())}, fixed(kRadius), {60, 220, 60}, 1, cv::LINE_AA,
               kFractionBits);
  }
  std::vector<unsigned char> jpeg;
  if (!cv::imencode(".jpg", picture, jpeg, {cv::IMWRITE_JPEG_QUALITY, kQuality})) return {};
  return {jpeg.begin(), jpeg.end()};
}

constexpr std::size_t kServerThreads = 6;  // the number of connections that a browser opens to one server

}  // namespace

struct LivePage::Implementation {
  /// A picture, encoded as JPEG at the first request.
  struct Picture {
    CameraPreview preview;
    std::string jpeg;
  };

  void update(const std::function<void()>& change) {
    const std::lock_guard lock(mutex);
    change();
    ++number;
  }

  std::string state() {
    const std::lock_guard lock(mutex);
    nlohmann::ordered_json json{
        {"board", board},
        {"number", number},
        {"stage", stage},
        {"has_pictures", !left.preview.image.empty() && !right.preview.image.empty()}};
    json.update(liveState(progress));
    if (stage == "done") {
      json["passed"] = passed;
      json["result"] = result;
      result_was_read = true;
    }
    last_request = Clock::now();
    state_read.notify_all();
    return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  }

  std::string jpegOf(Picture& picture) {
    const std::lock_guard lock(mutex);
    if (picture.jpeg.empty()) picture.jpeg = liveJpeg(picture.preview);
    return picture.jpeg;
  }

  void route();
  void routePicture(const char* path, Picture& picture);

  std::mutex mutex;
  std::condition_variable state_read;
  std::string board;
  std::uint64_t number = 0;  ///< counts updates
  std::string stage = "views";
  StreamProgress progress;
  Picture left, right;
  bool passed = false;
  std::string result;
  bool result_was_read = false;
  Clock::time_point last_request;

  std::string url;
  HttpService server{kServerThreads};  ///< last, because its threads use the others
};

void LivePage::Implementation::route() {
  using httplib::Request, httplib::Response;
  server.set_default_headers({{"Cache-Control", "no-store"},
                              {"X-Content-Type-Options", "nosniff"},
                              {"X-Frame-Options", "DENY"},
                              {"Content-Security-Policy",
                               "default-src 'none'; script-src 'self'; connect-src 'self'; img-src 'self'; "
                               "style-src 'unsafe-inline'"}});
  server.Get("/", [](const Request&, Response& response) {
    response.set_content(kLivePageHtml, "text/html; charset=utf-8");
  });
  server.Get("/page.js", [](const Request&, Response& response) {
    response.set_content(kLivePageScript, "text/javascript; charset=utf-8");
  });
  server.Get("/state.json", [this](const Request&, Response& response) {
    response.set_content(state(), "application/json");
  });
  routePicture("/left.jpg", left);
  routePicture("/right.jpg", right);
}

void LivePage::Implementation::routePicture(const char* path, Picture& picture) {
  server.Get(path, [this, &picture](const httplib::Request&, httplib::Response& response) {
    const std::string jpeg = jpegOf(picture);
    if (jpeg.empty()) {
      response.status = 404;
    } else {
      response.set_content(jpeg, "image/jpeg");
    }
  });
}

LivePage::LivePage(const ListenAddress& address, const calib::BoardSpec& board)
    : implementation_(std::make_unique<Implementation>()) {
  Implementation& page = *implementation_;
  page.board = calib::boardSpecText(board);
  page.route();
  const int port = page.server.bind(address);
  if (port < 0) {
    throw std::runtime_error("the page cannot be served at " + address.text() +
                             ": is the port taken? Choose another with --page");
  }
  page.url = "http://" + ListenAddress{address.address, static_cast<std::uint16_t>(port)}.text() + "/";
  page.server.start();
}

LivePage::~LivePage() = default;

std::string LivePage::url() const {
  return implementation_->url;
}

void LivePage::show(const StreamProgress& progress) {
  implementation_->update([&] {
    implementation_->progress = progress;
    implementation_->left = {progress.left, {}};
    implementation_->right = {progress.right, {}};
  });
}

void LivePage::showSolving() {
  implementation_->update([&] { implementation_->stage = "solving"; });
}

void LivePage::showResult(bool passed, const std::string& text) {
  implementation_->update([&] {
    implementation_->stage = "done";
    implementation_->passed = passed;
    implementation_->result = text;
  });
  std::unique_lock lock(implementation_->mutex);
  if (Clock::now() - implementation_->last_request > std::chrono::seconds(5)) return;
  implementation_->state_read.wait_for(lock, std::chrono::seconds(2),
                                       [this] { return implementation_->result_was_read; });
}

}  // namespace cartvo
