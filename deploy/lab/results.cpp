#include "deploy/lab/results.hpp"

#include <algorithm>
#include <map>

namespace kervan::lab {
namespace {

std::size_t index_of_factor(const Experiment& experiment, const std::string& name) {
  return static_cast<std::size_t>(&experiment.factor(name) - experiment.factors.data());
}

/// A number to reckon with; so counts as 1.
std::optional<double> number_of(const Value& value) {
  if (const auto* number = std::get_if<double>(&value)) return *number;
  if (const auto* so = std::get_if<bool>(&value)) return *so ? 1.0 : 0.0;
  return std::nullopt;
}

std::optional<double> number_at(const Results& results, std::size_t cell, std::size_t response) {
  return results.values[cell].empty() ? std::nullopt : number_of(results.values[cell][response]);
}

/// The run that is equal to `cell` but for the level of one factor. Cells are counted with the last factor fastest.
std::size_t sibling(const Results& results, std::size_t cell, std::size_t factor, std::size_t level) {
  std::size_t step = 1;
  for (std::size_t i = factor + 1; i < results.experiment.factors.size(); ++i)
    step *= results.experiment.factors[i].levels.size();
  return cell + step * level - step * results.cells[cell].levels[factor];
}

std::optional<Difference> difference(const Results& results, const Group& group, std::size_t factor, std::size_t level,
                                     std::size_t to, std::size_t response) {
  std::vector<double> differences;
  double sum = 0.0, other_sum = 0.0;
  for (const std::size_t cell : group.cells) {
    if (results.cells[cell].levels[factor] != level) continue;
    const auto value = number_at(results, cell, response);
    const auto other = number_at(results, sibling(results, cell, factor, to), response);
    if (!value || !other) continue;
    differences.push_back(*value - *other);
    sum += *value;
    other_sum += *other;
  }
  const auto estimate = mean_of(differences);
  if (!estimate) return std::nullopt;
  Difference found{group.labels, results.experiment.factors[factor].levels[level].label, response, *estimate, {}};
  if (other_sum != 0.0) found.ratio = sum / other_sum;
  return found;
}

}  // namespace

std::size_t Results::failed() const {
  return static_cast<std::size_t>(std::ranges::count(records, RunState::failed, &RunRecord::state));
}

ResponseKind kind_of(const Results& results, std::size_t response) {
  ResponseKind kind = ResponseKind::none;
  for (const auto& values : results.values) {
    if (values.empty()) continue;
    const Value& value = values[response];
    if (std::holds_alternative<std::string>(value)) return ResponseKind::text;
    if (std::holds_alternative<double>(value)) kind = ResponseKind::number;
    if (std::holds_alternative<bool>(value) && kind == ResponseKind::none) kind = ResponseKind::share;
  }
  return kind;
}

std::size_t index_of(const Results& results, const std::string& response) {
  return static_cast<std::size_t>(&results.experiment.response(response) - results.experiment.responses.data());
}

std::vector<Group> grouped(const Results& results, const std::vector<std::string>& factors) {
  std::vector<std::size_t> indices;
  for (const std::string& name : factors) indices.push_back(index_of_factor(results.experiment, name));
  std::map<std::vector<std::size_t>, Group> groups;  // by their levels, which are in the order of the file
  for (std::size_t i = 0; i < results.cells.size(); ++i) {
    std::vector<std::size_t> levels;
    for (const std::size_t index : indices) levels.push_back(results.cells[i].levels[index]);
    Group& group = groups[levels];
    if (group.cells.empty())
      for (std::size_t k = 0; k < indices.size(); ++k)
        group.labels.push_back(results.experiment.factors[indices[k]].levels[levels[k]].label);
    group.cells.push_back(i);
  }
  std::vector<Group> list;
  for (auto& [levels, group] : groups) list.push_back(std::move(group));
  return list;
}

std::vector<std::size_t> common(const Group& a, const Group& b) {
  std::vector<std::size_t> cells;
  std::ranges::set_intersection(a.cells, b.cells, std::back_inserter(cells));
  return cells;
}

Summary summary_of(const Results& results, const std::vector<std::size_t>& cells, std::size_t response) {
  Summary summary{.kind = kind_of(results, response)};
  std::vector<double> numbers;
  for (const std::size_t cell : cells) {
    if (results.values[cell].empty()) continue;
    const Value& value = results.values[cell][response];
    if (std::holds_alternative<std::monostate>(value)) continue;
    ++summary.n;
    if (const auto number = number_of(value)) numbers.push_back(*number);
    const std::string text = to_text(value);
    if (std::ranges::find(summary.texts, text) == summary.texts.end()) summary.texts.push_back(text);
  }
  if (summary.kind == ResponseKind::number) summary.estimate = mean_of(numbers);
  if (summary.kind == ResponseKind::share)
    summary.estimate = share_of(static_cast<std::size_t>(std::ranges::count(numbers, 1.0)), numbers.size());
  return summary;
}

Differences differences(const Results& results) {
  const Comparison& comparison = *results.experiment.comparison;
  const Factor& compared = results.experiment.factor(comparison.factor);
  const std::size_t factor = index_of_factor(results.experiment, comparison.factor);
  const auto to = static_cast<std::size_t>(std::ranges::find(compared.levels, comparison.to, &Level::label) -
                                           compared.levels.begin());
  Differences differences;
  for (const auto* names : {&results.experiment.table.rows, &results.experiment.table.columns})
    std::ranges::copy_if(*names, std::back_inserter(differences.by),
                         [&](const std::string& name) { return name != comparison.factor; });
  std::vector<Group> groups = grouped(results, differences.by);
  if (groups.size() > 1) {
    groups.push_back(grouped(results, {}).front());
    groups.back().labels.clear();
  }
  for (const Group& group : groups)
    for (const std::string& response : comparison.responses)
      for (std::size_t level = 0; level < compared.levels.size(); ++level) {
        if (level == to) continue;
        if (auto found = difference(results, group, factor, level, to, index_of(results, response)))
          differences.all.push_back(std::move(*found));
      }
  return differences;
}

}  // namespace kervan::lab
