// XML documents of cameras, on pugixml.
#include "capture/isapi/xml_document.hpp"

#include <algorithm>
#include <cstring>
#include <set>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <pugixml.hpp>

#include "common/ascii_text.hpp"

namespace cartvo::capture {
namespace {

std::string_view localName(const char* name) {
  const char* colon = std::strchr(name, ':');
  return colon == nullptr ? name : colon + 1;
}

/// All elements that a path leads to.
std::vector<pugi::xml_node> elementsOf(const pugi::xml_node& root, std::string_view path) {
  std::vector<pugi::xml_node> found{root};
  while (!path.empty()) {
    const std::string_view name = path.substr(0, path.find('/'));
    path.remove_prefix(std::min(path.size(), name.size() + 1));
    std::vector<pugi::xml_node> below;
    for (const pugi::xml_node& element : found)
      for (const pugi::xml_node& child : element.children())
        if (child.type() == pugi::node_element && localName(child.name()) == name) below.push_back(child);
    found = std::move(below);
  }
  return found;
}

std::string textOf(const pugi::xml_node& element) {
  return std::string(trimmed(element.text().get()));
}

/// The node after `node` and all that is in it, in document order, below `root`.
pugi::xml_node nodeBehind(pugi::xml_node node, const pugi::xml_node& root) {
  while (node && node != root) {
    if (pugi::xml_node sibling = node.next_sibling()) return sibling;
    node = node.parent();
  }
  return {};
}

/// The node after `node` in document order, below `root`.
pugi::xml_node nextNode(const pugi::xml_node& node, const pugi::xml_node& root) {
  if (pugi::xml_node child = node.first_child()) return child;
  return nodeBehind(node, root);
}

/// Whether no element is deeper than so many levels; the root is on the first one.
bool isWithinDepth(const pugi::xml_node& root, int levels) {
  int depth = 1;
  for (pugi::xml_node node = root; node;) {
    if (depth > levels) return false;
    if (const pugi::xml_node child = node.first_child()) {
      node = child;
      ++depth;
      continue;
    }
    while (node && node != root && !node.next_sibling()) {
      node = node.parent();
      --depth;
    }
    node = node == root ? pugi::xml_node() : node.next_sibling();
  }
  return true;
}

}  // namespace

struct XmlDocument::Tree {
  pugi::xml_document document;
  pugi::xml_node root;

  pugi::xml_node first(std::string_view path) const {
    const std::vector<pugi::xml_node> found = elementsOf(root, path);
    return found.empty() ? pugi::xml_node() : found.front();
  }

  /// Tree whose root is a copy of the element, with the namespaces that are declared above it.
  static std::unique_ptr<Tree> copyOf(const pugi::xml_node& element) {
    auto tree = std::make_unique<Tree>();
    tree->root = tree->document.append_copy(element);
    std::set<std::string_view> known;
    for (const pugi::xml_attribute& attribute : element.attributes())
      known.insert(attribute.name());
    for (pugi::xml_node above = element.parent(); above; above = above.parent())
      for (const pugi::xml_attribute& attribute : above.attributes()) {
        const std::string_view name = attribute.name();
        const bool declares = name == "xmlns" || name.starts_with("xmlns:");
        if (declares && known.insert(name).second) tree->root.append_copy(attribute);
      }
    return tree;
  }
};

XmlDocument::XmlDocument(std::unique_ptr<Tree> tree) : tree_(std::move(tree)) {}
XmlDocument::~XmlDocument() = default;
XmlDocument::XmlDocument(XmlDocument&&) noexcept = default;
XmlDocument& XmlDocument::operator=(XmlDocument&&) noexcept = default;

XmlDocument XmlDocument::parse(std::string_view text, const std::string& name) {
  if (text.size() > kMaxBytes)
    throw std::runtime_error(name + ": expected at most " + std::to_string(kMaxBytes / 1024) + " KiB of XML");
  auto tree = std::make_unique<Tree>();
  constexpr unsigned kOptions = pugi::parse_default | pugi::parse_comments;
  const pugi::xml_parse_result result =
      tree->document.load_buffer(text.data(), text.size(), kOptions, pugi::encoding_auto);
  tree->root = tree->document.document_element();
  if (!result || !tree->root) {
    throw std::runtime_error(name +
                             ": expected XML: " + (result ? "it has no element" : result.description()) +
                             " at byte " + std::to_string(result.offset));
  }
  if (!isWithinDepth(tree->root, kMaxDepth)) {
    throw std::runtime_error(name + ": expected XML of at most " + std::to_string(kMaxDepth) +
                             " levels, found more");
  }
  return XmlDocument(std::move(tree));
}

std::optional<XmlDocument> XmlDocument::parseIfXml(std::string_view text) {
  try {
    return parse(text, "text");
  } catch (const std::runtime_error&) {
    return std::nullopt;
  }
}

XmlDocument XmlDocument::copy() const {
  return part("");
}

std::string XmlDocument::rootName() const {
  return std::string(localName(tree_->root.name()));
}

bool XmlDocument::has(std::string_view path) const {
  return !tree_->first(path).empty();
}

std::optional<std::string> XmlDocument::text(std::string_view path) const {
  const pugi::xml_node element = tree_->first(path);
  if (!element) return std::nullopt;
  return textOf(element);
}

std::vector<std::string> XmlDocument::texts(std::string_view path) const {
  std::vector<std::string> found;
  for (const pugi::xml_node& element : elementsOf(tree_->root, path))
    found.push_back(textOf(element));
  return found;
}

std::optional<std::string> XmlDocument::anyText(std::string_view name) const {
  for (pugi::xml_node node = tree_->root; node; node = nextNode(node, tree_->root))
    if (node.type() == pugi::node_element && localName(node.name()) == name) return textOf(node);
  return std::nullopt;
}

std::optional<bool> XmlDocument::anyTruth(std::string_view name) const {
  const std::string word = lowerCase(anyText(name).value_or(""));
  if (word == "true" || word == "1") return true;
  if (word == "false" || word == "0") return false;
  return std::nullopt;
}

std::optional<std::string> XmlDocument::attribute(std::string_view path, const char* name) const {
  const pugi::xml_attribute found = tree_->first(path).attribute(name);
  if (!found) return std::nullopt;
  return found.value();
}

bool XmlDocument::setTexts(std::string_view path, const std::string& value) {
  const std::vector<pugi::xml_node> found = elementsOf(tree_->root, path);
  for (const pugi::xml_node& element : found)
    element.text().set(value.c_str());
  return !found.empty();
}

bool XmlDocument::setOrAppend(std::string_view path, const std::string& value) {
  pugi::xml_node element = tree_->first(path);
  if (!element) {
    const std::size_t slash = path.rfind('/');
    const bool is_top = slash == std::string_view::npos;
    pugi::xml_node parent = tree_->first(is_top ? std::string_view() : path.substr(0, slash));
    if (!parent) return false;
    const std::string_view full = parent.name(), local = localName(parent.name());
    const std::string prefix(full.substr(0, full.size() - local.size()));
    element = parent.append_child((prefix + std::string(path.substr(is_top ? 0 : slash + 1))).c_str());
  }
  return element.text().set(value.c_str());
}

XmlDocument XmlDocument::part(std::string_view path) const {
  return XmlDocument(Tree::copyOf(tree_->first(path)));
}

std::vector<XmlDocument> XmlDocument::parts(std::string_view name) const {
  std::vector<XmlDocument> found;
  for (pugi::xml_node node = tree_->root; node && found.size() < kMaxParts;) {
    const bool matches = node.type() == pugi::node_element && localName(node.name()) == name;
    if (matches) found.push_back(XmlDocument(Tree::copyOf(node)));
    node = matches ? nodeBehind(node, tree_->root) : nextNode(node, tree_->root);
  }
  return found;
}

std::string XmlDocument::toText() const {
  std::ostringstream stream;
  stream << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
  tree_->root.print(stream, "", pugi::format_raw, pugi::encoding_utf8);
  return stream.str();
}

}  // namespace cartvo::capture
