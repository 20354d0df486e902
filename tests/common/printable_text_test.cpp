// Text from untrusted sources: check for printable characters, and truncation.
#include "common/printable_text.hpp"

#include <cstddef>
#include <iterator>
#include <span>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

namespace cartvo {
namespace {

TEST(PrintableText, AcceptsTextOfAnyLanguage) {
  for (const char* text :
       {"", "left camera", "Grüße", "左カメラ", "\U0001F6D2", "\u00A0", "\u202F", "\U0010FFFF"})
    EXPECT_TRUE(isPrintable(text)) << text;
}

TEST(PrintableText, RefusesControlCharacters) {
  const std::string_view c0[] = {"two\nlines", "tab\t", std::string_view("\0", 1), "\x1b[2J"};
  const std::string_view delete_and_c1[] = {"\x7f", "\u0080", "\u009B"};
  const std::string_view separators[] = {"\u2028", "\u2029"};
  const std::string_view directions[] = {"\u202A", "\u202E", "\u2066", "\u2069"};
  using Texts = std::span<const std::string_view>;
  for (const Texts texts : {Texts(c0), Texts(delete_and_c1), Texts(separators), Texts(directions)})
    for (const std::string_view text : texts)
      EXPECT_FALSE(isPrintable(text)) << testing::PrintToString(text);
}

TEST(PrintableText, RefusesInvalidUtf8) {
  for (const char* bytes :
       {"\x80", "\xC3", "\xC3(", "\xE2\x82", "\xF8\x88\x80\x80\x80", "\xFF",  // no characters
        "\xC0\xAF", "\xE0\x80\xAF", "\xF0\x80\x80\xAF",                       // overlong
        "\xED\xA0\x80", "\xF4\x90\x80\x80"})  // a surrogate; above the last character
    EXPECT_FALSE(isPrintable(std::string("a") + bytes)) << testing::PrintToString(bytes);
}

TEST(PrintableText, IsTruncatedBetweenCharacters) {
  EXPECT_EQ(utf8Prefix("abc", 3), "abc");
  EXPECT_EQ(utf8Prefix("abc", 2), "ab");
  EXPECT_EQ(utf8Prefix("abc", 0), "");
  const std::string_view text = "a\u00FC\u20AC\U0001F6D2";  // of one, two, three and four bytes
  const std::string_view expected[] = {"", "a", "a", "a\u00FC", "a\u00FC", "a\u00FC", "a\u00FC\u20AC"};
  for (std::size_t most = 0; most < std::size(expected); ++most)
    EXPECT_EQ(utf8Prefix(text, most), expected[most]) << most;
  EXPECT_EQ(utf8Prefix(text, 9), "a\u00FC\u20AC");
  EXPECT_EQ(utf8Prefix(text, 10), text);
}

TEST(PrintableText, TruncatesInvalidUtf8ToNothing) {
  EXPECT_EQ(utf8Prefix("\x80\x80\x80\x80", 2), "");
}

TEST(PrintableText, ExcerptEscapesAndTruncates) {
  EXPECT_EQ(printableExcerpt("a\u00FC b"), "a\u00FC b");
  EXPECT_EQ(printableExcerpt("\x1B[31m\n\xFF"), "\\x1b[31m\\x0a\\xff");
  EXPECT_EQ(printableExcerpt("\u202E"), "\\xe2\\x80\\xae");
  EXPECT_EQ(printableExcerpt("abcdef", 4), "abcd...");
  EXPECT_EQ(printableExcerpt("ab\u20AC", 4), "ab...");
  EXPECT_EQ(printableExcerpt(std::string(100, '\x01')).size(), 4U * 60 + 3);
}

}  // namespace
}  // namespace cartvo
