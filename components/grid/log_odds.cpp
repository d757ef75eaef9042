#include "components/grid/log_odds.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace kervan::grid {

LogOdds log_odds_of(double probability) {
  if (std::isnan(probability)) return 0;
  const double p = std::clamp(probability, lowest_probability, highest_probability);
  const double units = std::round(log_odds_per_nat * std::log(p / (1.0 - p)));
  return static_cast<LogOdds>(std::clamp(units, -32767.0, 32767.0));
}

double probability_of(LogOdds value) { return 1.0 / (1.0 + std::exp(-value / log_odds_per_nat)); }

std::int8_t percent_of(LogOdds value) {
  // Whole maps are turned into percentages: a table is an order of magnitude faster than an exponential.
  static const auto table = [] {
    std::array<std::int8_t, 65536> percent{};
    for (int i = -32768; i < 32768; ++i)
      percent[static_cast<std::size_t>(i + 32768)] =
          static_cast<std::int8_t>(std::lround(100.0 * probability_of(static_cast<LogOdds>(i))));
    percent[32768] = -1;
    return percent;
  }();
  return table[static_cast<std::size_t>(value + 32768)];
}

}  // namespace kervan::grid
