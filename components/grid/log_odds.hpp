/// How sure a cell is, as the logarithm of its odds, in the sixteen bits that vector instructions add eight at a time.
#pragma once

#include <cstdint>

namespace kervan::grid {

/// ln(P / (1 - P)), scaled so that the ends of sixteen bits are P = 0.99 and 0.01: an addition that stops at the ends
/// keeps a cell from becoming so sure of itself that nothing changes its mind. 0 is P = 0.5, which says nothing.
using LogOdds = std::int16_t;

/// Units of LogOdds for 1 nat: 32767 / ln 99.
inline constexpr double log_odds_per_nat = 7130.836;

inline constexpr double highest_probability = 0.99;
inline constexpr double lowest_probability = 0.01;

/// The nearest value; probabilities outside of lowest .. highest count as those. NaN is 0.
LogOdds log_odds_of(double probability);

double probability_of(LogOdds value);

/// The sum, stopping at the ends.
constexpr LogOdds added(LogOdds a, LogOdds b) {
  const int sum = int{a} + int{b};
  return static_cast<LogOdds>(sum > 32767 ? 32767 : sum < -32768 ? -32768 : sum);
}

/// Per cent occupied, 1 .. 99; -1 for 0, of which nothing is known.
std::int8_t percent_of(LogOdds value);

}  // namespace kervan::grid
