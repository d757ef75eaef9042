// The only file that knows yaml-cpp. It listens to the parser's events instead of building YAML::Node, because only the
// events still tell quoted from plain scalars, keep duplicate keys apart and give every mark.
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include "framework/config/node.hpp"

namespace kervan::config {
namespace {

class TreeBuilder final : public YAML::EventHandler {
 public:
  explicit TreeBuilder(std::string file) : file_(std::move(file)) {}

  Node root;

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    refuse_anchor(mark, anchor);
    if (expects_key()) {
      take_key(mark, "");
      return;
    }
    Node node = make(Kind::null, mark);
    // The parser's mark of a missing value is that of the next token, often lines below; its key is where to look.
    if (!open_.empty() && open_.back().node.is_map()) node.location = open_.back().key_location;
    put(std::move(node));
  }

  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    throw ConfigError(at(mark), "aliases (*name) are not allowed; write the value out, or use a template");
  }

  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& text) override {
    refuse_anchor(mark, anchor);
    // The parser names plain scalars "?" and quoted ones "!"; anything else was written by a person.
    if (tag != "?" && tag != "!" && !tag.empty()) refuse_tag(mark, tag);
    if (expects_key()) {
      if (text == "<<" && tag != "!") throw ConfigError(at(mark), "merge keys (<<) are not allowed; use a template");
      take_key(mark, text);
      return;
    }
    Node node = make(Kind::scalar, mark);
    node.text = text;
    node.quoted = tag == "!";
    put(std::move(node));
  }

  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open(Kind::list, mark, tag, anchor);
  }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open(Kind::map, mark, tag, anchor);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapEnd() override { close(); }

 private:
  /// A list or map that has begun and not ended; a map that waits for a value keeps its key here.
  struct Open {
    Node node;
    bool has_key = false;
    std::string key = {};
    Location key_location = {};
  };

  Location at(const YAML::Mark& mark) const { return {file_, mark.line + 1, mark.column + 1}; }

  Node make(Kind kind, const YAML::Mark& mark) const {
    Node node;
    node.kind = kind;
    node.location = at(mark);
    node.key_location = node.location;
    return node;
  }

  bool expects_key() const { return !open_.empty() && open_.back().node.is_map() && !open_.back().has_key; }

  void take_key(const YAML::Mark& mark, const std::string& key) {
    Open& map = open_.back();
    if (key.empty()) throw ConfigError(at(mark), "a key is missing before the colon");
    for (const Node& known : map.node.children)
      if (known.name == key)
        throw ConfigError(at(mark), "duplicate key '" + key + "'; it was first given at line " +
                                        std::to_string(known.key_location.line));
    map.key = key;
    map.key_location = at(mark);
    map.has_key = true;
  }

  void open(Kind kind, const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor) {
    refuse_anchor(mark, anchor);
    if (tag != "?" && !tag.empty()) refuse_tag(mark, tag);
    if (expects_key()) throw ConfigError(at(mark), "a key must be a single word, not a list or a map");
    Node node = make(kind, mark);
    name(node);
    open_.push_back({std::move(node)});
  }

  void close() {
    Node node = std::move(open_.back().node);
    open_.pop_back();
    put(std::move(node));
  }

  /// A node's name comes from the collection it stands in.
  void name(Node& node) const {
    if (open_.empty()) return;
    const Open& parent = open_.back();
    if (parent.node.is_map()) {
      node.name = parent.key;
      node.key_location = parent.key_location;
    } else {
      node.name = parent.node.name + "[" + std::to_string(parent.node.children.size()) + "]";
    }
  }

  void put(Node node) {
    name(node);
    if (open_.empty()) {
      root = std::move(node);
      return;
    }
    Open& parent = open_.back();
    parent.has_key = false;
    parent.node.children.push_back(std::move(node));
  }

  void refuse_anchor(const YAML::Mark& mark, YAML::anchor_t anchor) const {
    if (anchor != YAML::NullAnchor)
      throw ConfigError(at(mark), "anchors (&name) are not allowed; write the value out, or use a template");
  }

  [[noreturn]] void refuse_tag(const YAML::Mark& mark, const std::string& tag) const {
    throw ConfigError(at(mark), "tags (" + tag + ") are not allowed; the type follows from the key");
  }

  std::string file_;
  std::vector<Open> open_;
};

/// yaml-cpp takes a tab for the beginning of a plain scalar and reports the damage lines later.
void refuse_tabs(const std::string& text, const std::string& file) {
  int line = 1;
  int column = 1;
  bool indentation = true;
  for (const char c : text) {
    if (c == '\0') throw ConfigError({file, line, column}, "this is not a text file");
    if (c == '\t' && indentation) throw ConfigError({file, line, column}, "a tab indents this line; use spaces");
    if (c != ' ') indentation = false;
    ++column;
    if (c == '\n') {
      ++line;
      column = 1;
      indentation = true;
    }
  }
}

}  // namespace

Node parse(const std::string& text, const std::string& shown_as) {
  refuse_tabs(text, shown_as);
  std::istringstream stream(text);
  TreeBuilder builder(shown_as);
  try {
    YAML::Parser parser(stream);
    if (!parser.HandleNextDocument(builder)) throw ConfigError({shown_as, 1, 1}, "the file is empty");
    TreeBuilder second(shown_as);
    if (parser.HandleNextDocument(second))
      throw ConfigError(second.root.location, "a second document begins here; a file holds one");
  } catch (const YAML::Exception& error) {
    throw ConfigError({shown_as, error.mark.line + 1, error.mark.column + 1}, "this is not valid YAML: " + error.msg);
  }
  return std::move(builder.root);
}

Node load(const std::string& path, const std::string& shown_as) {
  const std::string& name = shown_as.empty() ? path : shown_as;
  std::ifstream file(path, std::ios::binary);
  std::string text;
  char part[1 << 16];
  while (file && (file.read(part, sizeof part) || file.gcount() > 0))
    text.append(part, static_cast<std::size_t>(file.gcount()));
  // A folder can be opened, but not read.
  if (!file.is_open() || file.bad())
    throw ConfigError({name, 0, 0}, "cannot read the file: " + std::string(std::strerror(errno)));
  return parse(text, name);
}

}  // namespace kervan::config
