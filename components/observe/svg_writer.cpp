#include "components/observe/svg_writer.hpp"

namespace kervan::observe {
namespace {

void append_escaped(std::string& out, std::string_view content) {
  for (const char c : content) {
    switch (c) {
      case '&': out += "&amp;"; break;
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '"': out += "&quot;"; break;
      default:
        // XML 1.0 has no way to write the other control characters.
        if (static_cast<unsigned char>(c) >= 0x20) out += c;
    }
  }
}

}  // namespace

void SvgWriter::begin(std::string_view name, Attributes attributes) {
  text_.append("<").append(name);
  for (const auto& [key, value] : attributes) {
    if (value.empty()) continue;
    text_.append(" ").append(key).append("=\"");
    append_escaped(text_, value);
    text_ += '"';
  }
}

void SvgWriter::element(std::string_view name, Attributes attributes) {
  begin(name, attributes);
  text_ += "/>\n";
}

void SvgWriter::open(std::string_view name, Attributes attributes) {
  begin(name, attributes);
  text_ += ">\n";
}

void SvgWriter::close(std::string_view name) { text_.append("</").append(name).append(">\n"); }

void SvgWriter::text(std::string_view content, Attributes attributes) {
  begin("text", attributes);
  text_ += '>';
  append_escaped(text_, content);
  text_ += "</text>\n";
}

void SvgWriter::span(std::string_view content, Attributes attributes) {
  begin("tspan", attributes);
  text_ += '>';
  append_escaped(text_, content);
  text_ += "</tspan>";
}

}  // namespace kervan::observe
