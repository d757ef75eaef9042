#include "components/observe/decimal.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace kervan::observe {

std::string decimal(double value, int digits) {
  if (!(std::abs(value) <= 1e15)) return {};
  std::array<char, 40> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::fixed,
                                 std::clamp(digits, 0, 9));
  std::string text(buffer.data(), end.ptr);
  if (text.front() == '-' && text.find_first_not_of("-0.") == std::string::npos) text.erase(0, 1);
  return text;
}

}  // namespace kervan::observe
