// XML documents of cameras. State of a login and result of a request, as cameras answer.
#include "capture/isapi/xml_document.hpp"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/isapi/isapi_client.hpp"
#include "support/error_message.hpp"

namespace cartvo::capture {
namespace {

using testing::HasSubstr;

XmlDocument parse(const std::string& text) {
  return XmlDocument::parse(text, "camera");
}

TEST(XmlDocument, FindsElementsByLocalNames) {
  const XmlDocument document = parse("<p:A xmlns:p='urn:x'><p:B> 1 \n</p:B><p:B>2</p:B></p:A>");
  EXPECT_EQ(document.rootName(), "A");
  EXPECT_EQ(document.text("B"), "1");
  EXPECT_THAT(document.texts("B"), testing::ElementsAre("1", "2"));
  EXPECT_EQ(document.text("C"), std::nullopt);
  EXPECT_EQ(document.text("B/C"), std::nullopt);
  EXPECT_EQ(document.anyText("B"), "1");
}

TEST(XmlDocument, KeepsWhatIsNotChanged) {
  const std::string text = "<A xmlns=\"urn:x\" version=\"2.0\"><B>1</B><!-- note --><C d=\"e\">&lt; </C></A>";
  XmlDocument document = parse(text);
  EXPECT_THAT(document.toText(), HasSubstr(text));
  EXPECT_TRUE(document.setTexts("B", "<2>"));
  EXPECT_THAT(document.toText(), HasSubstr("<B>&lt;2&gt;</B><!-- note --><C d=\"e\">&lt; </C>"));
  EXPECT_FALSE(document.setTexts("missing", "2"));
}

TEST(XmlDocument, TakesNamespacesAlongWithAPart) {
  const XmlDocument document = parse("<p:A xmlns:p='urn:x' xmlns='urn:y'><p:B><C>1</C></p:B></p:A>");
  const std::string part = document.part("B").toText();
  EXPECT_THAT(part, HasSubstr("xmlns:p=\"urn:x\""));
  EXPECT_THAT(part, HasSubstr("xmlns=\"urn:y\""));
  EXPECT_EQ(parse(part).text("C"), "1");
}

TEST(XmlDocument, AddsAMissingElementWithThePrefixOfItsParent) {
  XmlDocument document = parse("<p:A xmlns:p='urn:x'><p:B/></p:A>");
  EXPECT_TRUE(document.setOrAppend("B/C", "1"));
  EXPECT_THAT(document.toText(), HasSubstr("<p:B><p:C>1</p:C></p:B>"));
  EXPECT_FALSE(document.setOrAppend("D/E", "1"));
}

TEST(XmlDocument, RejectsWhatIsNoXmlWithoutRepeatingIt) {
  for (const std::string text : {"", "secret", "<A>secret", "<?xml version='1.0'?>"}) {
    const std::string message = test::messageOf([&] { parse(text); });
    EXPECT_THAT(message, HasSubstr("camera: expected XML")) << text;
    EXPECT_THAT(message, testing::Not(HasSubstr("secret")));
  }
  EXPECT_THAT(test::messageOf([] { parse("<A>" + std::string(XmlDocument::kMaxBytes, 'x') + "</A>"); }),
              HasSubstr("at most 512 KiB"));
}

TEST(XmlDocument, RejectsDeepDocuments) {
  const auto nested = [](int depth) {
    std::string text;
    for (int i = 0; i < depth; ++i)
      text += "<A>";
    for (int i = 0; i < depth; ++i)
      text += "</A>";
    return text;
  };
  EXPECT_EQ(parse(nested(XmlDocument::kMaxDepth)).rootName(), "A");
  EXPECT_EQ(test::messageOf([&] { parse(nested(XmlDocument::kMaxDepth + 1)); }),
            "camera: expected XML of at most 64 levels, found more");
  EXPECT_FALSE(XmlDocument::parseIfXml(nested(70'000)).has_value());
  EXPECT_TRUE(XmlDocument::parseIfXml("<A><B/><B><C/></B>" + nested(60) + "<D/></A>").has_value());
}

TEST(XmlDocument, TakesPartsThatAreNotInEachOther) {
  const XmlDocument document = parse("<A xmlns:p='urn:x'><p:B>1<B>2</B></p:B><C><B>3</B></C></A>");
  const std::vector<XmlDocument> parts = document.parts("B");
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_THAT(parts[0].toText(), HasSubstr("xmlns:p=\"urn:x\""));
  EXPECT_EQ(parts[0].text("B"), "2");
  EXPECT_EQ(parts[1].text(""), "3");
  std::string many;
  for (int i = 0; i < 1000; ++i)
    many += "<B/>";
  EXPECT_EQ(parse("<A>" + many + "</A>").parts("B").size(), XmlDocument::kMaxParts);
}

TEST(XmlDocument, ReadsTruths) {
  const XmlDocument document = parse("<A><B>True</B><C>0</C><D>yes</D></A>");
  EXPECT_EQ(document.anyTruth("B"), true);
  EXPECT_EQ(document.anyTruth("C"), false);
  EXPECT_EQ(document.anyTruth("D"), std::nullopt);
  EXPECT_EQ(document.anyTruth("E"), std::nullopt);
}

TEST(XmlDocument, ReadsNoExternalEntities) {
  const XmlDocument document =
      parse("<!DOCTYPE A [<!ENTITY e SYSTEM 'file:///etc/passwd'>]><A><B>&e;</B></A>");
  EXPECT_EQ(document.text("B"), "&e;");
}

TEST(LoginState, ReadsLocksAndTheAttemptsThatAreLeft) {
  const struct {
    const char* elements;
    bool is_locked;
    std::optional<std::chrono::seconds> unlock_after;
    const char* text;
  } cases[] = {{"<statusValue>401</statusValue><isActivated>true</isActivated><lockStatus>lock</lockStatus>"
                "<unlockTime> 1800 </unlockTime>",
                true, std::chrono::seconds(1800), "the camera has locked this login for another 1800 s"},
               {"<isActivated>true</isActivated><lockStatus>lock</lockStatus><unlockTime>0</unlockTime>",
                true, std::nullopt, "the camera has locked this login"},
               {"<isActivated>true</isActivated><lockStatus>unlock</lockStatus><unlockTime>0</unlockTime>"
                "<retryLoginTime>1</retryLoginTime>",
                false, std::nullopt, "1 attempt is left before the camera locks the login"}};
  for (const auto& [elements, is_locked, unlock_after, text] : cases) {
    const LoginState state =
        parseLoginState("<userCheck xmlns='urn:x'>" + std::string(elements) + "</userCheck>");
    EXPECT_EQ(state.isLocked(), is_locked) << elements;
    EXPECT_EQ(state.unlock_after, unlock_after) << elements;
    EXPECT_EQ(state.activated, true);
    EXPECT_EQ(loginStateText(state), text);
  }
}

TEST(LoginState, IsUnknownForOtherAnswers) {
  for (const char* body : {"", "<html>no", "<userCheck><unlockTime>-3</unlockTime></userCheck>"}) {
    const LoginState state = parseLoginState(body);
    EXPECT_EQ(state.locked, std::nullopt);
    EXPECT_EQ(state.activated, std::nullopt);
    EXPECT_EQ(loginStateText(state), "");
  }
}

TEST(ResponseStatus, ReadsCodes) {
  const ResponseStatus busy = parseResponseStatus(
      "<ResponseStatus><statusCode>2</statusCode><statusString>Device Busy</statusString></ResponseStatus>");
  EXPECT_EQ(busy.code, ResponseStatus::Code::busy);
  EXPECT_EQ(busy.text, "Device Busy");
  const ResponseStatus reboot = parseResponseStatus(
      "<ResponseStatus><statusCode>1</statusCode><subStatusCode>rebootRequired</subStatusCode></"
      "ResponseStatus>");
  EXPECT_EQ(reboot.code, ResponseStatus::Code::reboot_required);
  EXPECT_TRUE(
      parseResponseStatus("<R><statusCode>4</statusCode><subStatusCode>notSupport</subStatusCode></R>")
          .isNotSupported());
  EXPECT_EQ(parseResponseStatus("<R><statusCode>99</statusCode></R>").code, ResponseStatus::Code::unknown);
}

}  // namespace
}  // namespace cartvo::capture
