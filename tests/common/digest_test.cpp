// Digest of bytes.
#include "common/digest.hpp"

#include <set>
#include <string>

#include <gtest/gtest.h>

namespace cartvo {
namespace {

TEST(Digest, TellsEachByteAndTheLength) {
  const std::string bytes = "eighteen bytes are";
  std::set<std::uint64_t> digests{digestOf(bytes), digestOf(bytes + '\0'), digestOf({})};
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    std::string other = bytes;
    other[i] ^= 1;
    digests.insert(digestOf(other));
  }
  EXPECT_EQ(digests.size(), bytes.size() + 3);
}

}  // namespace
}  // namespace cartvo
