// read_a_recording FOLDER: prints instants and mean brightness of each pair of a recording, and what is
// damaged.
#include <iostream>

#include <cartvo/capture.hpp>
#include <opencv2/core.hpp>

int main(int argc, char** argv) try {
  using namespace cartvo::capture;
  if (argc != 2) return std::cerr << "usage: read_a_recording FOLDER\n", 2;
  const StereoSource source = openSource(argv[1]);
  PairReader reader(*source.left, *source.right, {.period_ns = source.period_ns});
  std::size_t pairs = 0;
  while (const auto pair = reader.next()) {
    std::cout << pair->left.exposure_ns << " ns, right " << 1e-6 * static_cast<double>(pair->offsetNs())
              << " ms later (stddev " << 1e-6 * pair->offsetStddevNs() << " ms), " << pair->left.image.size()
              << " px, brightness " << cv::mean(pair->left.image)[0] << ' ' << cv::mean(pair->right.image)[0]
              << '\n';
    ++pairs;
  }
  std::cout << pairs << " pairs\n";
  for (const CameraSource* camera : {source.left.get(), source.right.get()}) {
    if (const std::string error = camera->health().last_error; !error.empty()) std::cerr << error << '\n';
  }
  return 0;
} catch (const std::exception& error) {
  return std::cerr << error.what() << '\n', 1;
}
