// Removal of credentials from FFmpeg's messages.

#include "capture/codec/ffmpeg_log.hpp"

#include <gtest/gtest.h>

namespace cartvo::capture {
namespace {

TEST(FfmpegLog, RemovesCredentialsFromUrls) {
  EXPECT_EQ(withoutCredentials("open rtsp://admin:secret@10.0.0.1/101 failed"),
            "open rtsp://***@10.0.0.1/101 failed");
  EXPECT_EQ(withoutCredentials("a://u:p@h/x b://v@k"), "a://***@h/x b://***@k");
  EXPECT_EQ(withoutCredentials("rtsp://admin:p@ss@host"), "rtsp://***@host");
}

TEST(FfmpegLog, KeepsTextWithoutCredentials) {
  EXPECT_EQ(withoutCredentials("tcp://10.0.0.1:554?timeout=5 failed"), "tcp://10.0.0.1:554?timeout=5 failed");
  EXPECT_EQ(withoutCredentials("rtsp://host/a@b"), "rtsp://host/a@b");
  EXPECT_EQ(withoutCredentials(""), "");
}

}  // namespace
}  // namespace cartvo::capture
