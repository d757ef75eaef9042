#include "deploy/lab/tables.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>

namespace kervan::lab {
namespace {

using Row = std::vector<std::string>;

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + '"';
}

std::string csv_line(const Row& row) {
  std::string line;
  for (std::size_t i = 0; i < row.size(); ++i) line += (i == 0 ? "" : ",") + csv_field(row[i]);
  return line + '\n';
}

std::string markdown_line(const Row& row) {
  std::string line = "|";
  for (const std::string& text : row) {
    line += ' ';
    for (const char c : text) line += c == '|' ? "\\|" : c == '\n' ? " " : std::string(1, c);
    line += " |";
  }
  return line + '\n';
}

std::string markdown_head(const Row& row) {
  std::string rule = "|";
  for (std::size_t i = 0; i < row.size(); ++i) rule += "---|";
  return markdown_line(row) + rule + '\n';
}

const char* to_text(ResponseKind kind) {
  switch (kind) {
    case ResponseKind::none: return "none";
    case ResponseKind::number: return "mean";
    case ResponseKind::share: return "share";
    case ResponseKind::text: return "text";
  }
  return "";
}

std::string number(double value) { return lab::to_text(Value(value)); }

bool shows_zero(std::string_view number) { return number.find_first_of("123456789") == std::string_view::npos; }

std::string fixed(double value, int digits) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  // Nothing is gained by "-0.00".
  return text[0] == '-' && shows_zero(text) ? text + 1 : text;
}

/// Four significant digits, without an exponent where it can be.
std::string four_digits(double value) {
  if (value == std::round(value) && std::abs(value) < 1e6) return fixed(value, 0);
  char text[64];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

std::string titled(const Response& response) {
  return response.unit.empty() ? response.name : response.name + " (" + response.unit + ")";
}

std::string joined(const std::vector<std::string>& labels) {
  std::string text;
  for (const std::string& label : labels) text += (text.empty() ? "" : ", ") + label;
  return text.empty() ? "all" : text;
}

void append(Row& row, const std::vector<std::string>& more) { row.insert(row.end(), more.begin(), more.end()); }

/// How many runs each value of the table stands for, if it is the same number for all and not said by the values.
std::string runs_each(const std::vector<std::vector<Summary>>& rows) {
  std::set<std::size_t> counts;
  for (const auto& row : rows)
    for (const Summary& summary : row)
      if (summary.kind != ResponseKind::share) counts.insert(summary.n);
  return counts.size() == 1 && *counts.begin() > 0 ? ", n = " + std::to_string(*counts.begin()) : "";
}

std::string table_by_columns(const Results& results, const std::string& name) {
  const Table& table = results.experiment.table;
  const std::size_t response = index_of(results, name);
  const auto rows = grouped(results, table.rows), columns = grouped(results, table.columns);
  std::vector<std::vector<Summary>> summaries;
  for (const Group& group : rows) {
    summaries.emplace_back();
    for (const Group& column : columns)
      summaries.back().push_back(summary_of(results, common(group, column), response));
  }
  const std::string each = runs_each(summaries);
  Row head = table.rows;
  for (const Group& column : columns) head.push_back(joined(column.labels));
  std::string text = "**" + titled(results.experiment.responses[response]) + "** by " + joined(table.columns) + each +
                     "\n\n" + markdown_head(head);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    Row row = rows[i].labels;
    for (const Summary& summary : summaries[i])
      row.push_back(summary_text(summary) +
                    (summary.kind == ResponseKind::share || !each.empty() ? "" : ", n = " + std::to_string(summary.n)));
    text += markdown_line(row);
  }
  return text;
}

}  // namespace

std::string estimate_text(const Estimate& estimate) {
  const double half = (estimate.high - estimate.low) / 2.0;
  if (!(half > 0.0)) return four_digits(estimate.value);
  int digits = std::clamp(1 - static_cast<int>(std::floor(std::log10(half))), 0, 9);
  // An interval that leaves out 0 by little must not look as if it ended there.
  const auto looks_zero = [&](double end) { return end != 0.0 && shows_zero(fixed(end, digits)); };
  for (int more = 0; more < 2 && (looks_zero(estimate.low) || looks_zero(estimate.high)); ++more) ++digits;
  return fixed(estimate.value, digits) + " [" + fixed(estimate.low, digits) + ", " + fixed(estimate.high, digits) + "]";
}

std::string summary_text(const Summary& summary) {
  if (summary.n == 0) return "-";
  if (summary.kind == ResponseKind::text)
    return summary.texts.size() == 1 ? summary.texts.front() : std::to_string(summary.texts.size()) + " different";
  const Estimate& estimate = *summary.estimate;
  if (summary.kind == ResponseKind::number) return estimate_text(estimate);
  const double n = static_cast<double>(estimate.n);
  return fixed(estimate.value * n, 0) + " of " + std::to_string(estimate.n) + " [" + fixed(100.0 * estimate.low, 0) +
         ", " + fixed(100.0 * estimate.high, 0) + "] %";
}

std::string runs_csv(const Results& results) {
  const Experiment& experiment = results.experiment;
  Row head;
  for (const Factor& factor : experiment.factors) head.push_back(factor.name);
  for (const Response& response : experiment.responses) head.push_back(titled(response));
  append(head, {"state", "reason", "folder"});
  std::string text = csv_line(head);
  for (std::size_t i = 0; i < results.cells.size(); ++i) {
    Row row;
    for (std::size_t k = 0; k < experiment.factors.size(); ++k)
      row.push_back(experiment.factors[k].levels[results.cells[i].levels[k]].label);
    for (std::size_t k = 0; k < experiment.responses.size(); ++k)
      row.push_back(results.values[i].empty() ? "" : lab::to_text(results.values[i][k]));
    const RunRecord& record = results.records[i];
    append(row, {record.state == RunState::done ? "done" : "failed", record.reason, "runs/" + results.cells[i].name});
    text += csv_line(row);
  }
  return text;
}

std::string table_csv(const Results& results) {
  const Table& table = results.experiment.table;
  Row head = table.rows;
  append(head, table.columns);
  append(head, {"response", "unit", "kind", "n", "value", "low", "high"});
  std::string text = csv_line(head);
  const auto columns = grouped(results, table.columns);
  for (const Group& group : grouped(results, table.rows))
    for (const Group& column : columns)
      for (const std::string& name : table.responses) {
        const std::size_t response = index_of(results, name);
        const Summary summary = summary_of(results, common(group, column), response);
        Row row = group.labels;
        append(row, column.labels);
        append(row,
               {name, results.experiment.responses[response].unit, to_text(summary.kind), std::to_string(summary.n)});
        if (summary.estimate)
          append(row, {number(summary.estimate->value), number(summary.estimate->low), number(summary.estimate->high)});
        else
          append(row, {summary.kind == ResponseKind::text ? summary_text(summary) : "", "", ""});
        text += csv_line(row);
      }
  return text;
}

std::string differences_csv(const Results& results) {
  const Differences found = differences(results);
  Row head = found.by;
  append(head, {results.experiment.comparison->factor, "response", "n", "difference", "low", "high", "ratio"});
  std::string text = csv_line(head);
  for (const Difference& one : found.all) {
    Row row = one.group.empty() ? Row(found.by.size(), "all") : one.group;
    append(row, {one.level, results.experiment.responses[one.response].name, std::to_string(one.difference.n),
                 number(one.difference.value), number(one.difference.low), number(one.difference.high),
                 one.ratio ? number(*one.ratio) : ""});
    text += csv_line(row);
  }
  return text;
}

std::string table_markdown(const Results& results) {
  const Table& table = results.experiment.table;
  std::string text;
  if (!table.columns.empty()) {
    for (const std::string& name : table.responses)
      text += (text.empty() ? "" : "\n") + table_by_columns(results, name);
    return text;
  }
  Row head = table.rows;
  if (head.empty()) head.push_back("");
  head.push_back("runs");
  for (const std::string& name : table.responses) head.push_back(titled(results.experiment.response(name)));
  text = markdown_head(head);
  for (const Group& group : grouped(results, table.rows)) {
    Row row = group.labels.empty() ? Row{"all"} : group.labels;
    const auto done =
        std::ranges::count_if(group.cells, [&](std::size_t cell) { return !results.values[cell].empty(); });
    row.push_back(std::to_string(done));
    for (const std::string& name : table.responses)
      row.push_back(summary_text(summary_of(results, group.cells, index_of(results, name))));
    text += markdown_line(row);
  }
  return text;
}

std::string differences_markdown(const Results& results) {
  const Differences found = differences(results);
  Row head = found.by;
  append(head, {results.experiment.comparison->factor, "response", "pairs", "difference", "ratio", "significant"});
  std::string text = markdown_head(head);
  for (const Difference& one : found.all) {
    Row row = one.group.empty() ? Row(found.by.size(), "all") : one.group;
    append(row, {one.level, titled(results.experiment.responses[one.response]), std::to_string(one.difference.n),
                 estimate_text(one.difference), one.ratio ? fixed(*one.ratio, 2) : "-",
                 one.difference.n < 2 ? "-"
                 : one.significant()  ? "yes"
                                      : "no"});
    text += markdown_line(row);
  }
  return text;
}

}  // namespace kervan::lab
