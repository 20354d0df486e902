// Tests of the width of terminals and text.
#include "common/command_line/terminal.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <stdlib.h>  // NOLINT(modernize-deprecated-headers): posix_openpt
#include <sys/ioctl.h>
#include <unistd.h>

namespace cartvo {
namespace {

TEST(Terminal, HasTheColumnsThatItStates) {
  const int terminal = ::posix_openpt(O_RDWR | O_NOCTTY);
  if (terminal < 0) GTEST_SKIP() << "no pseudo terminals here";
  const winsize size{24, 66, 0, 0};
  ASSERT_EQ(::ioctl(terminal, TIOCSWINSZ, &size), 0);
  EXPECT_EQ(terminalColumns(terminal), 66u);
  ::close(terminal);
  const int file = ::open("/dev/null", O_WRONLY);
  EXPECT_EQ(terminalColumns(file), std::nullopt);
  ::close(file);
}

TEST(Terminal, TextIsCutBetweenCharacters) {
  EXPECT_EQ(textColumns("±0.7 ms"), 7u);
  EXPECT_EQ(cutToColumns("±0.7 ms", 7), "±0.7 ms");
  EXPECT_EQ(cutToColumns("±±±±±±", 5), "±±...");
  EXPECT_EQ(cutToColumns("abcdef", 3), "...");
  EXPECT_EQ(cutToColumns("abcdef", 1), ".");
  EXPECT_EQ(cutToColumns("abcdef", 0), "");
}

TEST(Terminal, LinesAreWrappedBelowTheirSecondColumn) {
  EXPECT_EQ(wrapLines("  -h,--help  Print this help\n\n", 24),
            "  -h,--help  Print this\n             help\n\n");
  EXPECT_EQ(wrapLines("  --sequence DIR Excludes: --world --seed", 24),
            "  --sequence DIR\n          Excludes:\n          --world --seed\n");
  EXPECT_EQ(wrapLines("Text in ± words", 10), "Text in ±\nwords\n");
  EXPECT_EQ(wrapLines("a_word_beyond_the_line", 10), "a_word_beyond_the_line\n");
}

}  // namespace
}  // namespace cartvo
