#include "deploy/composition/glob.hpp"

#include <algorithm>
#include <tuple>

namespace kervan::composition {

bool is_pattern(std::string_view text) { return text.find('*') != std::string_view::npos; }

bool matches(std::string_view pattern, std::string_view name) {
  if (pattern.empty()) return name.empty();
  if (pattern.starts_with("**")) {
    for (std::size_t skip = 0; skip <= name.size(); ++skip)
      if (matches(pattern.substr(2), name.substr(skip))) return true;
    return false;
  }
  if (pattern.front() == '*') {
    for (std::size_t skip = 0; skip <= name.size(); ++skip) {
      if (matches(pattern.substr(1), name.substr(skip))) return true;
      if (skip < name.size() && name[skip] == '/') return false;
    }
    return false;
  }
  return !name.empty() && pattern.front() == name.front() && matches(pattern.substr(1), name.substr(1));
}

bool covers(std::string_view pattern, std::string_view name) {
  for (std::size_t end = name.find('/'); end != std::string_view::npos; end = name.find('/', end + 1))
    if (matches(pattern, name.substr(0, end))) return true;
  return matches(pattern, name);
}

bool more_specific(std::string_view a, std::string_view b) {
  const auto rank = [](std::string_view text) {
    const auto wildcards = std::count(text.begin(), text.end(), '*');
    const auto literals = static_cast<std::ptrdiff_t>(text.size()) - wildcards;
    return std::tuple(wildcards == 0, literals, text.find("**") == std::string_view::npos);
  };
  return rank(a) > rank(b);
}

}  // namespace kervan::composition
