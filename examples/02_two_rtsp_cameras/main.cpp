// two_rtsp_cameras RIG LEFT-URL RIGHT-URL USER PASSWORD-FILE PAIRS: prints the speed of the cart for so many
// pairs.
#include <iostream>

#include <cartvo/calib.hpp>
#include <cartvo/capture.hpp>
#include <cartvo/pipeline.hpp>

int main(int argc, char** argv) try {
  using namespace cartvo;
  if (argc != 7)
    return std::cerr << "usage: two_rtsp_cameras RIG LEFT-URL RIGHT-URL USER PASSWORD-FILE PAIRS\n", 2;
  const calib::Rig rig = calib::readRig(argv[1]);
  calib::Rectifier rectifier(rig, rig.rectification, calib::buildTables(rig, rig.rectification));
  pipeline::PairProcessor processor(rig, std::move(rectifier),
                                    {.absent_readout = pipeline::AbsentReadout::unknown});
  const capture::Credentials credentials{argv[4], capture::readPasswordFile(argv[5])};
  capture::StereoTimestamper clock(capture::ClockChoice::automatic);  // relates both cameras' clocks
  capture::RtspCamera left({.url = argv[2], .credentials = credentials});
  capture::RtspCamera right({.url = argv[3], .credentials = credentials});
  left.setTimestamper(clock, capture::CameraSide::left);
  right.setTimestamper(clock, capture::CameraSide::right);

  const auto visual_offset = [&](const auto& offset) { clock.setVisual(offset); };
  pipeline::Pipeline pipeline(left, right, processor,
                              {.image_size = rig.left.size, .set_visual_offset = visual_offset});
  const auto use = [&](const pipeline::PairResult& pair) {
    std::cout << pair.sequence << (pair.isValid() ? " valid " : " invalid ")
              << pair.motion.velocity.transpose() << " m/s" << std::endl;
    if (pair.sequence + 1 >= std::stoull(argv[6])) pipeline.stop();
  };
  const auto missed = [&](const pipeline::NoPair&) {
    std::cerr << "no pair: " << left.health().last_error << ' ' << right.health().last_error << std::endl;
  };
  pipeline.runLive({use, missed});
  return 0;
} catch (const std::exception& error) {
  return std::cerr << error.what() << '\n', 1;
}
