/// Errors over time as a picture.
#pragma once

#include <string>
#include <vector>

namespace kervan::test {

/// One value for each second, m.
struct ErrorCurve {
  std::string name;
  std::vector<double> mean;
  std::vector<double> worst;
};

/// Writes an SVG of all curves, means as thick lines, worst ones as thin lines, of one scale. Up to six curves.
void save_error_plot(const std::string& path, const std::string& title, const std::vector<ErrorCurve>& curves);

}  // namespace kervan::test
