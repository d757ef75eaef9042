/// Rows of text in columns that are as wide as they need to be.
#pragma once

#include <algorithm>
#include <ostream>
#include <string>
#include <vector>

namespace kervan::cli {

inline void print_table(std::ostream& out, const std::vector<std::vector<std::string>>& rows,
                        const std::string& indent = "") {
  std::vector<std::size_t> widths;
  for (const auto& row : rows)
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (i >= widths.size()) widths.push_back(0);
      widths[i] = std::max(widths[i], row[i].size());
    }
  for (const auto& row : rows) {
    std::string line = indent;
    for (std::size_t i = 0; i < row.size(); ++i)
      line += i + 1 < row.size() ? row[i] + std::string(widths[i] - row[i].size() + 2, ' ') : row[i];
    out << line.substr(0, line.find_last_not_of(' ') + 1) << '\n';
  }
}

}  // namespace kervan::cli
