/// Results as text: CSV for programs, Markdown for people. Equal results give equal bytes.
#pragma once

#include <string>

#include "deploy/lab/results.hpp"

namespace kervan::lab {

/// One row for each run: the levels of the factors, the responses, and whether it failed and why.
std::string runs_csv(const Results& results);

/// One row for each group of the table and response: kind, n, value and the ends of its interval.
std::string table_csv(const Results& results);

/// One row for each difference. For an experiment with a comparison.
std::string differences_csv(const Results& results);

/// The table as Markdown. With columns: one table for each response, groups of the rows against groups of the columns.
/// Without: one table, with a column for each response.
std::string table_markdown(const Results& results);

/// The comparison as Markdown, one table.
std::string differences_markdown(const Results& results);

/// "0.296 [0.291, 0.301]", "19 of 20 [76, 99] %", a text, "3 different" or "-"; for people.
std::string summary_text(const Summary& summary);

/// As many digits as the interval is worth: the half of its width has two. `exact` ones (n = 1, no spread) have four.
std::string estimate_text(const Estimate& estimate);

}  // namespace kervan::lab
