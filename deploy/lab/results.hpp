/// The runs of a plan side by side, and what groups of them have in common.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "deploy/lab/experiment.hpp"
#include "deploy/lab/responses.hpp"
#include "deploy/lab/run_record.hpp"
#include "deploy/lab/statistics.hpp"

namespace kervan::lab {

struct Results {
  Experiment experiment;
  std::vector<Cell> cells;
  std::vector<RunRecord> records;          ///< one for each cell
  std::vector<std::vector<Value>> values;  ///< one row for each cell, a value for each response; empty if it failed

  std::size_t failed() const;
};

/// What kind of thing a response is, by what the runs gave.
enum class ResponseKind {
  none,    ///< no run has it
  number,  ///< means are shown
  share,   ///< so or not: the share of the runs in which it is so
  text,    ///< only whether they are equal
};

ResponseKind kind_of(const Results& results, std::size_t response);
std::size_t index_of(const Results& results, const std::string& response);  ///< the response must be there

/// Some of the runs: those with these levels of the factors they were grouped by.
struct Group {
  std::vector<std::string> labels;  ///< one for each of the factors
  std::vector<std::size_t> cells;   ///< in their order
};

/// The runs by the levels of `factors`, in the order of the plan. Without factors one group of all.
std::vector<Group> grouped(const Results& results, const std::vector<std::string>& factors);

/// The runs that both groups have.
std::vector<std::size_t> common(const Group& a, const Group& b);

/// A response over some runs. Of a share the estimate's values are between 0 and 1.
struct Summary {
  ResponseKind kind = ResponseKind::none;
  std::optional<Estimate> estimate = {};  ///< of numbers and shares, if a run has one
  std::vector<std::string> texts = {};    ///< the different ones, in the order of the runs
  std::size_t n = 0;                      ///< runs that have a value
};

Summary summary_of(const Results& results, const std::vector<std::size_t>& cells, std::size_t response);

/// A level of the compared factor beside the one it is compared with, over runs that are equal in all else.
struct Difference {
  std::vector<std::string> group;  ///< the levels of Differences::by; empty: all runs
  std::string level;
  std::size_t response = 0;
  Estimate difference;          ///< of the pairs, this level's value minus the other's
  std::optional<double> ratio;  ///< of the means over the pairs; none if the other's is 0

  /// Whether the interval leaves out 0.
  bool significant() const { return difference.n > 1 && (difference.low > 0.0 || difference.high < 0.0); }
};

struct Differences {
  std::vector<std::string> by;  ///< the table's other factors
  std::vector<Difference> all;  ///< group by group, then over all runs
};

/// For an experiment with a comparison.
Differences differences(const Results& results);

}  // namespace kervan::lab
