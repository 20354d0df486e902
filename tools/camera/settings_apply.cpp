// Writes changed settings and reads them back.
#include <algorithm>
#include <cctype>
#include <utility>

#include "tools/camera/settings_change.hpp"

namespace cartvo {
namespace {

using capture::IsapiClient;
using capture::IsapiError;
using capture::XmlDocument;

/// The parts of a document's address that one writing needs.
class DocumentWriter {
 public:
  DocumentWriter(IsapiClient& client, const CameraChannels& channels, Document document)
      : client_(client), channels_(channels), document_(document), path_(pathOf(document, channels)) {}

  /// Writes the changes, all of this document.
  void write(std::vector<ChangeResult*>& changes) {
    writeWhole(changes);
    readBack(changes);
    std::vector<ChangeResult*> pending;
    for (ChangeResult* change : changes)
      if (!change->is_taken) pending.push_back(change);
    if (pending.empty() || needs_reboot_) return;
    writeParts(pending);
    readBack(pending);
  }

  bool needsReboot() const { return needs_reboot_; }
  /// Whether what the camera is set to is not known, after an exception.
  bool isUnread() const { return is_unread_; }

 private:
  XmlDocument changedDocument(const std::vector<ChangeResult*>& changes) {
    XmlDocument document = client_.get(path_);
    for (const ChangeResult* change : changes)
      setValue(change->change.setting, document, change->change.to);
    return document;
  }

  /// Writes a document. The camera's reason if it does not take it.
  std::string put(const std::string& path, const XmlDocument& document) {
    const bool was_unread = std::exchange(is_unread_, true);
    try {
      needs_reboot_ = client_.put(path, document) || needs_reboot_;
    } catch (const IsapiError& error) {
      is_unread_ = was_unread;
      const bool may_go_otherwise =
          error.kind() == IsapiError::Kind::rejected || error.kind() == IsapiError::Kind::not_supported;
      if (!may_go_otherwise) throw;
      return error.what();
    }
    return {};
  }

  void writeWhole(const std::vector<ChangeResult*>& changes) {
    const std::string reason = put(path_, changedDocument(changes));
    for (ChangeResult* change : changes)
      change->problem = reason;
  }

  /// Writes each top element with a change to its own address. Firmwares spell the same address with a small
  /// or a capital letter.
  void writeParts(const std::vector<ChangeResult*>& changes) {
    const XmlDocument document = changedDocument(changes);
    std::vector<std::string> elements;
    for (const ChangeResult* change : changes) {
      const std::string element = topElement(change->change.setting, document);
      if (!element.empty() && std::find(elements.begin(), elements.end(), element) == elements.end())
        elements.push_back(element);
    }
    for (const std::string& element : elements) {
      const XmlDocument part = document.part(element);
      std::string reason;
      for (const std::string& name : addressesOf(element, part)) {
        reason = put(path_ + "/" + name, part);
        if (reason.empty()) break;
      }
      for (ChangeResult* change : changes)
        if (topElement(change->change.setting, document) == element && !reason.empty())
          change->problem = reason;
    }
  }

  /// The element below the root that holds a setting; empty if there is none.
  static std::string topElement(const Setting& setting, const XmlDocument& document) {
    if (setting.rule == Rule::time_server) return document.has("NTPServer") ? "NTPServer" : "";
    for (const std::string& path : setting.paths)
      if (document.has(path) && path.find('/') != std::string::npos) return path.substr(0, path.find('/'));
    return {};
  }

  static std::vector<std::string> addressesOf(const std::string& element, const XmlDocument& part) {
    if (element == "NTPServer" || element == "TextOverlayList") {
      const std::string id = part.text("id").value_or("1");
      return {element == "NTPServer" ? id : "text"};
    }
    std::string small = element;
    small.front() = static_cast<char>(std::tolower(static_cast<unsigned char>(small.front())));
    if (small == element) return {element};
    return {element, small};
  }

  void readBack(const std::vector<ChangeResult*>& changes) {
    CameraDocuments camera;
    camera.channels = channels_;
    camera.of(document_) = client_.get(path_);
    is_unread_ = false;
    for (ChangeResult* change : changes) {
      const Change& wanted = change->change;
      const std::optional<std::string> value = valueOf(wanted.setting, camera);
      change->is_taken = value && sameValue(*value, wanted.to);
      if (change->is_taken) {
        change->problem.clear();
      } else if (needs_reboot_) {
        change->problem = "it takes effect after a reboot of the camera";
      } else if (change->problem.empty()) {
        change->problem =
            "the camera accepted " + wanted.to + " and still reports " + value.value_or("nothing");
      }
    }
  }

  IsapiClient& client_;
  CameraChannels channels_;
  Document document_;
  std::string path_;
  bool needs_reboot_ = false;
  bool is_unread_ = false;  ///< something was sent, and not read back since
};

/// Writes the changes of one document. Why that ended early; empty if it did not.
std::string writeDocument(DocumentWriter& writer, std::vector<ChangeResult*>& changes) {
  std::string failure;
  try {
    writer.write(changes);
    return failure;
  } catch (const IsapiError& error) {
    failure = error.what();
  } catch (const capture::HttpError& error) {
    failure = error.what();
  }
  for (ChangeResult* change : changes)
    if (!change->is_taken && writer.isUnread())
      change->problem = "it was sent, but whether the camera took it is not known";
  return failure;
}

}  // namespace

ApplyResult applyChanges(IsapiClient& client, const CameraChannels& channels,
                         const std::vector<Change>& changes) {
  ApplyResult result;
  for (const Change& change : changes)
    result.results.push_back({change, false, "it was not changed"});
  for (const Document document : kDocuments) {
    std::vector<ChangeResult*> part;
    for (ChangeResult& one : result.results)
      if (one.change.setting.document == document) part.push_back(&one);
    if (part.empty()) continue;
    DocumentWriter writer(client, channels, document);
    result.failure = writeDocument(writer, part);
    result.needs_reboot = result.needs_reboot || writer.needsReboot();
    if (!result.failure.empty()) break;
  }
  return result;
}

}  // namespace cartvo
