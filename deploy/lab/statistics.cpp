#include "deploy/lab/statistics.hpp"

#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <numeric>

namespace kervan::lab {
namespace {

/// The quantile 0.975 of the normal distribution.
constexpr double z = 1.959963984540054;

}  // namespace

std::optional<Estimate> mean_of(std::span<const double> values) {
  if (values.empty()) return std::nullopt;
  const double n = static_cast<double>(values.size());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  Estimate estimate{mean, mean, mean, values.size()};
  if (values.size() < 2) return estimate;
  double squares = 0.0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  const double t = boost::math::quantile(boost::math::students_t(n - 1.0), 0.975);
  const double half = t * std::sqrt(squares / (n - 1.0) / n);
  estimate.low = mean - half;
  estimate.high = mean + half;
  return estimate;
}

std::optional<Estimate> share_of(std::size_t hits, std::size_t count) {
  if (count == 0) return std::nullopt;
  const double n = static_cast<double>(count), p = static_cast<double>(hits) / n;
  const double scale = 1.0 / (1.0 + z * z / n);
  const double center = scale * (p + z * z / (2.0 * n));
  const double half = scale * z * std::sqrt(p * (1.0 - p) / n + z * z / (4.0 * n * n));
  // None and all are the ends themselves, which rounding misses.
  return Estimate{p, hits == 0 ? 0.0 : center - half, hits == count ? 1.0 : center + half, count};
}

}  // namespace kervan::lab
