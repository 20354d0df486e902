// Text: letters and white space, base64, digests, natural order, unprintable bytes, sizes of images.
#include <algorithm>
#include <cstddef>
#include <iterator>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "common/ascii_text.hpp"
#include "common/base64.hpp"
#include "common/digest.hpp"
#include "common/image_size.hpp"
#include "common/natural_order.hpp"
#include "common/printable_text.hpp"

namespace cartvo {
namespace {

TEST(AsciiText, ChangesLettersOfAsciiOnly) {
  EXPECT_EQ(lowerCase("RTSP://Ä[1]z"), "rtsp://Ä[1]z");
  EXPECT_EQ(upperCase("sha-256{é"), "SHA-256{é");
}

TEST(AsciiText, TrimsBothEnds) {
  EXPECT_EQ(trimmed(" \t a b \r\n"), "a b");
  EXPECT_EQ(trimmed(" \r\n"), "");
  EXPECT_EQ(trimmed(""), "");
}

TEST(Base64, EncodesAndDecodesTheVectorsOfTheStandard) {
  const std::pair<const char*, const char*> vectors[]{{"", ""},
                                                      {"f", "Zg=="},
                                                      {"fo", "Zm8="},
                                                      {"foo", "Zm9v"},
                                                      {"foob", "Zm9vYg=="},
                                                      {"fooba", "Zm9vYmE="},
                                                      {"foobar", "Zm9vYmFy"}};
  for (const auto& [bytes, text] : vectors) {
    EXPECT_EQ(encodeBase64(bytes), text);
    EXPECT_EQ(decodeBase64(text), bytes);
  }
}

TEST(Base64, KeepsAllBytes) {
  std::string bytes;
  for (int i = 0; i < 256; ++i)
    bytes += static_cast<char>(i);
  EXPECT_EQ(decodeBase64(encodeBase64(bytes)), bytes);
}

TEST(Base64, RefusesOtherText) {
  for (const char* text : {"Zg", "Zg=", "Z===", "====", "Zm9v Zm9", "Zm=v", "Zm9\xC3", "Zg==Zg=="})
    EXPECT_EQ(decodeBase64(text), std::nullopt) << text;
}

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

TEST(NaturalOrder, ComparesNumbersByValue) {
  const std::vector<std::string> expected{"0.png",
                                          "frame1",
                                          "frame2",
                                          "frame002_a",
                                          "frame10",
                                          "frame10_2",
                                          "frame10_11",
                                          "frame99999999999999999998",
                                          "frame99999999999999999999",
                                          "g"};
  std::vector<std::string> sorted = expected;
  std::reverse(sorted.begin(), sorted.end());
  std::sort(sorted.begin(), sorted.end(), NaturalOrder());
  EXPECT_EQ(sorted, expected);
}

TEST(NaturalOrder, ComparesDecimalNumbersByValue) {
  std::vector<std::string> instants{"1403636579.8", "1403636579.763", "1403636580.05", "900.1"};
  std::sort(instants.begin(), instants.end(), NaturalOrder());
  EXPECT_EQ(instants, (std::vector<std::string>{"900.1", "1403636579.763", "1403636579.8", "1403636580.05"}));
}

TEST(NaturalOrder, IsTotal) {
  const NaturalOrder before;
  EXPECT_NE(before("frame1", "frame01"), before("frame01", "frame1"));
  EXPECT_FALSE(before("frame1", "frame1"));
  EXPECT_TRUE(before("", "0"));
}

TEST(NaturalOrder, IgnoresLeadingZerosInNames) {
  EXPECT_EQ(withoutLeadingZeros("frame007_0010"), "frame7_10");
  EXPECT_EQ(withoutLeadingZeros("000"), "0");
  EXPECT_EQ(withoutLeadingZeros("left"), "left");
}

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

TEST(ImageSize, IsReadAsItIsWritten) {
  for (const cv::Size& size : {cv::Size(1, 1), cv::Size(680, 420), cv::Size(99999, 7)})
    EXPECT_EQ(parseImageSize(sizeText(size)), size);
  EXPECT_EQ(sizeText({1241, 376}), "1241x376");
}

TEST(ImageSize, RefusesOtherText) {
  for (const char* text : {"",
                           "x",
                           "680",
                           "680x",
                           "x420",
                           "680x420x",
                           "680x420 ",
                           " 680x420",
                           "680X420",
                           "680 x420",
                           "-680x420",
                           "680x-420",
                           "+680x420",
                           "680x+420",
                           "0x420",
                           "680x0",
                           "0680x420",
                           "100000x420",
                           "680x99999999999",
                           "99999999999x420",
                           "680.5x420"})
    EXPECT_FALSE(parseImageSize(text)) << text;
}

}  // namespace
}  // namespace cartvo
