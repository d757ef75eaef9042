#include <spdlog/logger.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "framework/component/component.hpp"
#include "framework/dds/json.hpp"

namespace kervan {
namespace {

void add(std::string& out, const Value& value);

void add(std::string& out, const ValueList& list) {
  out += '[';
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (i > 0) out += ", ";
    add(out, list[i]);
  }
  out += ']';
}

void add(std::string& out, const ValueMap& map) {
  out += '{';
  for (const auto& [name, value] : map) {
    if (out.back() != '{') out += ", ";
    json::add(out, std::string_view(name));
    out += ": ";
    add(out, value);
  }
  out += '}';
}

void add(std::string& out, const Value& value) {
  const auto add_one = [&out](const auto& held) {
    using Held = std::decay_t<decltype(held)>;
    if constexpr (std::is_same_v<Held, std::monostate>)
      out += "null";
    else if constexpr (std::is_same_v<Held, double>)
      json::add(out, std::round(held * 1e4) / 1e4);
    else if constexpr (std::is_same_v<Held, std::int64_t>)
      json::add(out, static_cast<long long>(held));
    else if constexpr (std::is_same_v<Held, std::string>)
      json::add(out, std::string_view(held));
    else if constexpr (std::is_same_v<Held, bool>)
      json::add(out, held);
    else
      add(out, held);
  };
  std::visit(add_one, static_cast<const Value::variant&>(value));
}

}  // namespace

void Component::write_figures(const ValueMap& figures) const {
  std::string text;
  add(text, figures);
  log().info("figures: {}", text);
  if (run_folder().empty()) return;
  std::string stem = name();
  std::replace(stem.begin(), stem.end(), '/', '-');
  std::ofstream file(run_folder() / ("figures-" + stem + ".json"));
  file << text << '\n';
  if (!file.flush()) log().error("figures-{}.json could not be written in {}", stem, run_folder().string());
}

}  // namespace kervan
