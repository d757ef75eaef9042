/// Writes SVG elements into a text.
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>

namespace kervan::observe {

class SvgWriter {
 public:
  using Attributes = std::initializer_list<std::pair<std::string_view, std::string>>;

  /// `<name …/>`
  void element(std::string_view name, Attributes attributes);
  /// `<name …>`, to be ended by close().
  void open(std::string_view name, Attributes attributes);
  void close(std::string_view name);
  /// `<text …>content</text>`, the content escaped.
  void text(std::string_view content, Attributes attributes);

  /// `<tspan …>content</tspan>` within an open text; no line break follows, which would be drawn as a space.
  void span(std::string_view content, Attributes attributes);
  /// Everything another writer holds.
  void append(const SvgWriter& other) { text_ += other.text_; }

  const std::string& document() const { return text_; }

 private:
  void begin(std::string_view name, Attributes attributes);

  std::string text_;
};

}  // namespace kervan::observe
