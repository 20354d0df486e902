// Fuzz target for what cameras answer over ISAPI, SADP and WS-Discovery: documents, their settings, login
// states, devices.

#include <algorithm>
#include <array>

#include "capture/isapi/isapi_client.hpp"
#include "capture/isapi/xml_document.hpp"
#include "common/printable_text.hpp"
#include "tests/fuzz/fuzzing.hpp"
#include "tools/camera/discovery_messages.hpp"
#include "tools/camera/settings_change.hpp"

using namespace cartvo;

namespace {

void checkPrintable(std::initializer_list<std::string> texts) {
  for (const std::string& text : texts)
    fuzz::require(isPrintable(text), "what is shown is printable");
}

void parseAnswers(const std::string& text) {
  checkPrintable({capture::loginStateText(capture::parseLoginState(text))});
  const capture::ResponseStatus status = capture::parseResponseStatus(text);
  checkPrintable({status.text, status.sub_code});
  std::vector<DiscoveredDevice> devices = parseOnvifAnswer(text);
  if (const auto device = parseSadpAnswer(text)) mergeDevice(devices, *device);
  for (const DiscoveredDevice& device : devices)
    checkPrintable({device.address, device.model, device.serial_number, device.mac_address, device.firmware,
                    device.subnet_mask, device.gateway, device.http_port});
}

/// The same document as each kind of document of a camera.
void checkSettings(const capture::XmlDocument& document) {
  CameraDocuments camera;
  for (const Document kind : kDocuments)
    camera.of(kind) = document.copy();
  camera.image_offers = document.copy();
  camera.stream_offers = document.copy();
  const CameraPair pair{&camera, &camera};
  Selection selection;
  selection.all = true;
  const ChangePlan plan = planChanges(pair, {}, selection);
  for (const std::string& problem : plan.problems[0])
    checkPrintable({problem});
  for (const Change& change : plan.changes[0]) {
    checkPrintable({change.from, change.to});
    CameraDocuments changed;
    changed.of(change.setting.document) = document.copy();
    fuzz::require(setValue(change.setting, *changed.of(change.setting.document), change.to),
                  "a planned change can be made");
    const auto value = valueOf(change.setting, changed);
    fuzz::require(value && sameValue(*value, change.to), "a value that was set is read back");
  }
}

void parseDocument(const std::string& text) {
  const auto document =
      fuzz::parseOrReject([&] { return capture::XmlDocument::parse(text, "NAME"); }, "NAME");
  if (!document) return;
  const std::string written = document->toText();
  if (written.size() <= capture::XmlDocument::kMaxBytes) {
    const auto again = capture::XmlDocument::parse(written, "written");
    fuzz::require(again.rootName() == document->rootName(), "a document that was written is read back");
    fuzz::require(again.toText() == written, "and written alike");
  }
  checkSettings(*document);
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text = fuzz::toText(data, size);
  parseAnswers(text);
  parseDocument(text);
  return 0;
}
