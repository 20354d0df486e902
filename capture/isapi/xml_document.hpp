#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

// XML documents of cameras. Firmwares differ in namespaces and prefixes, so that elements are found by their
// local names.

namespace cartvo::capture {

/// One XML document. A path is a list of local names below the root element: "Video/maxFrameRate"; the empty
/// path is the root. Where several elements have a name, a path takes the first. All that is not changed is
/// kept.
class XmlDocument {
 public:
  static constexpr std::size_t kMaxBytes = 512 * 1024;
  static constexpr int kMaxDepth = 64;  ///< levels of elements and their texts
  static constexpr std::size_t kMaxParts = 64;

  /// Throws std::runtime_error "NAME: ...", without the content, unless `text` is XML of at most kMaxBytes
  /// and kMaxDepth with a root element. Document types and external entities are never read.
  static XmlDocument parse(std::string_view text, const std::string& name);

  /// As `parse`; nothing where that throws.
  static std::optional<XmlDocument> parseIfXml(std::string_view text);

  ~XmlDocument();
  XmlDocument(XmlDocument&& other) noexcept;
  XmlDocument& operator=(XmlDocument&& other) noexcept;

  XmlDocument copy() const;

  /// Local name of the root element.
  std::string rootName() const;

  bool has(std::string_view path) const;

  /// Text of an element without blanks at its ends; nothing if it does not exist.
  std::optional<std::string> text(std::string_view path) const;

  /// Texts of all elements of that path.
  std::vector<std::string> texts(std::string_view path) const;

  /// Text of the first element of that local name, wherever it is.
  std::optional<std::string> anyText(std::string_view name) const;

  /// The same text as a truth: "true", "1", "false" or "0" in any case; nothing for other texts.
  std::optional<bool> anyTruth(std::string_view name) const;

  /// An attribute's value, for example `opt` of an element in a camera's list of capabilities.
  std::optional<std::string> attribute(std::string_view path, const char* name) const;

  /// Replaces the text of all elements of that path. False if there is none.
  bool setTexts(std::string_view path, const std::string& value);

  /// Replaces the text of the first element of that path, which is added to its parent element if it does not
  /// exist. False if the parent does not exist either.
  bool setOrAppend(std::string_view path, const std::string& value);

  /// Document whose root is the element, with the namespaces that are declared above it. The path must exist.
  XmlDocument part(std::string_view path) const;

  /// Documents of the first kMaxParts elements of that local name, wherever they are but in each other, as
  /// `part`.
  std::vector<XmlDocument> parts(std::string_view name) const;

  /// The document as XML with a declaration.
  std::string toText() const;

 private:
  struct Tree;
  explicit XmlDocument(std::unique_ptr<Tree> tree);

  std::unique_ptr<Tree> tree_;
};

}  // namespace cartvo::capture
