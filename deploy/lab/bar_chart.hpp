/// Groups of bars with their intervals, as one self-contained SVG document.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "deploy/lab/statistics.hpp"

namespace kervan::lab {

struct Bars {
  std::string label;                          ///< beside the group
  std::vector<std::optional<Estimate>> bars;  ///< one for each series; none: nothing is known
};

struct BarChart {
  std::string title = {};
  std::string unit = {};                 ///< beside the title; may be empty
  bool percent = false;                  ///< the values are shares
  std::vector<std::string> series = {};  ///< names of the bars of a group; one without a name needs no legend
  std::vector<Bars> groups = {};
};

/// Bars lie from left to right, groups from top to bottom, 1000 px wide. A bar's thin line is its interval. Equal
/// charts give equal bytes.
std::string to_svg(const BarChart& chart);

}  // namespace kervan::lab
