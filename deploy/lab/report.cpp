#include "deploy/lab/report.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>

#include "deploy/composition/load.hpp"
#include "deploy/lab/bar_chart.hpp"
#include "deploy/lab/overlay.hpp"
#include "deploy/lab/tables.hpp"

namespace kervan::lab {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_failures_shown = 50;

void write(const fs::path& file, const std::string& text) {
  errno = 0;
  std::ofstream stream(file, std::ios::binary | std::ios::trunc);
  stream << text;
  if (!stream.flush())
    throw ConfigError({composition::shown_path(file), 0, 0},
                      "cannot be written" + (errno != 0 ? std::string(": ") + std::strerror(errno) : ""));
}

/// "floor 1, avoidance pursuit"
std::string named(const std::vector<std::string>& factors, const Group& group) {
  std::string text;
  for (std::size_t i = 0; i < factors.size(); ++i) text += (i == 0 ? "" : ", ") + factors[i] + ' ' + group.labels[i];
  return text;
}

BarChart chart_of(const Results& results, std::size_t response) {
  const Table& table = results.experiment.table;
  BarChart chart;
  chart.title = results.experiment.responses[response].name;
  chart.unit = results.experiment.responses[response].unit;
  chart.percent = kind_of(results, response) == ResponseKind::share;
  const auto columns = grouped(results, table.columns);
  for (const Group& column : columns) chart.series.push_back(named(table.columns, column));
  for (const Group& row : grouped(results, table.rows)) {
    Bars bars{row.labels.empty() ? "all" : named(table.rows, row), {}};
    for (const Group& column : columns)
      bars.bars.push_back(summary_of(results, common(row, column), response).estimate);
    chart.groups.push_back(std::move(bars));
  }
  return chart;
}

std::string runs_text(std::size_t count) { return std::to_string(count) + (count == 1 ? " run" : " runs"); }

std::string failures(const Results& results) {
  if (results.failed() == 0) return "";
  std::string text =
      "\n## What failed\n\nThese runs are in no table. The sweep makes them again when it is run again.\n\n";
  std::size_t shown = 0;
  for (std::size_t i = 0; i < results.cells.size() && shown < most_failures_shown; ++i) {
    if (results.records[i].state == RunState::done) continue;
    text += "- `" + results.cells[i].name + "`: " + results.records[i].reason + "\n";
    ++shown;
  }
  if (shown < results.failed()) text += "- and " + std::to_string(results.failed() - shown) + " more, see `runs.csv`\n";
  return text;
}

std::string matrix(const Experiment& experiment) {
  std::string text;
  for (const Factor& factor : experiment.factors) {
    text += "- `" + factor.name + "`: ";
    const std::size_t count = factor.levels.size();
    for (std::size_t i = 0; i < count; ++i) {
      if (count > 12 && i == 3) {  // a long list says no more than its ends
        text += ", … ";
        i = count - 1;
        text += factor.levels[i].label + " (" + std::to_string(count) + ")";
        break;
      }
      text += (i == 0 ? "" : ", ") + factor.levels[i].label;
    }
    text += "\n";
  }
  return text;
}

}  // namespace

void write_report(const Results& results, const fs::path& folder, const WorldOf& world_of) {
  const Experiment& experiment = results.experiment;
  write(folder / "runs.csv", runs_csv(results));
  write(folder / "table.csv", table_csv(results));
  std::string page = "# " + experiment.name + "\n\n";
  if (!experiment.help.empty()) page += experiment.help + "\n\n";
  page += runs_text(results.cells.size()) + " of the composition `" + experiment.composition.text + "`";
  if (results.failed() > 0) page += ", of which " + std::to_string(results.failed()) + " failed";
  page +=
      ".\n\n" + matrix(experiment) +
      "\n## Table\n\nMeans and, in brackets, their 95 % confidence intervals (Student's t; of shares, Wilson's).\n\n" +
      table_markdown(results);
  if (experiment.comparison) {
    write(folder / "differences.csv", differences_csv(results));
    page += "\n## Beside " + experiment.comparison->factor + " " + experiment.comparison->to +
            "\n\nDifferences of runs that are equal in everything else.\n\n" + differences_markdown(results);
  }
  std::string bars;
  for (const std::string& name : experiment.table.responses) {
    const std::size_t response = index_of(results, name);
    const ResponseKind kind = kind_of(results, response);
    if (kind != ResponseKind::number && kind != ResponseKind::share) continue;
    write(folder / ("bars-" + name + ".svg"), to_svg(chart_of(results, response)));
    bars += "\n![" + name + "](bars-" + name + ".svg)\n";
  }
  if (!bars.empty()) page += "\n## Bars\n" + bars;
  if (experiment.overlay) {
    page += "\n## Paths\n";
    std::size_t number = 0;
    for (const Group& group : grouped(results, experiment.overlay->by)) {
      const std::string picture = "paths-" + std::to_string(++number) + ".svg";
      const observe::MapDrawing drawing = overlay_of(results, group, world_of(group.cells.front()), folder / "runs");
      write(folder / picture, observe::to_svg(drawing));
      page += "\n![" + drawing.title + "](" + picture + ")\n";
    }
  }
  page +=
      failures(results) +
      "\n## Files\n\n[`runs.csv`](runs.csv) has one row for each run, [`table.csv`](table.csv) one for each group and "
      "response.\nWhat each run left is in [`runs`](runs).\n";
  write(folder / "README.md", page);
}

}  // namespace kervan::lab
