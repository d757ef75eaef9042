/// Means and shares of a few runs, and how far they can be trusted.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

namespace kervan::lab {

/// What is estimated from `n` runs, and the interval that holds the truth in 95 of 100 such experiments.
struct Estimate {
  double value = 0.0;
  double low = 0.0, high = 0.0;  ///< equal to the value where nothing is known of the spread (n = 1)
  std::size_t n = 0;
};

/// Mean with Student's t interval, mean +- t(0.975, n - 1) s / sqrt(n). Nothing for no values.
///
/// Student, "The Probable Error of a Mean", Biometrika 6(1), 1908, doi:10.2307/2331554.
std::optional<Estimate> mean_of(std::span<const double> values);

/// Share of `hits` among `n` with the score interval, which is right for shares of 0 and 1 as well. Nothing for n = 0.
///
/// E. B. Wilson, "Probable Inference, the Law of Succession, and Statistical Inference", JASA 22(158), 1927,
/// doi:10.1080/01621459.1927.10502953.
std::optional<Estimate> share_of(std::size_t hits, std::size_t n);

}  // namespace kervan::lab
