#include "deploy/lab/experiment.hpp"

#include <algorithm>
#include <cctype>
#include <set>

namespace kervan::lab {
namespace {

/// Long enough for every name, short enough for every file system.
constexpr std::size_t longest_name = 120;

/// What may stand in the name of a folder on every file system, and needs no quotes in a shell.
std::string plain(const std::string& text) {
  std::string plain;
  for (const char c : text)
    if (std::isalnum(static_cast<unsigned char>(c)) != 0 || std::string_view("._-+").find(c) != std::string_view::npos)
      plain += c;
    else if (c != ' ')
      plain += '_';
  return plain;
}

std::string folder_name(const Experiment& experiment, const std::vector<std::size_t>& levels) {
  std::string name;
  for (std::size_t i = 0; i < levels.size(); ++i)
    name += (i == 0 ? "" : ",") + plain(experiment.factors[i].name) + "=" +
            plain(experiment.factors[i].levels[levels[i]].label);
  return name.substr(0, longest_name);
}

void put_over(Settings& settings, const config::Node& setting) {
  std::erase_if(settings, [&](const config::Node& other) { return other.name == setting.name; });
  settings.push_back(setting);
}

}  // namespace

const Factor& Experiment::factor(std::string_view name_wanted) const {
  return *std::ranges::find(factors, name_wanted, &Factor::name);
}

const Response& Experiment::response(std::string_view name_wanted) const {
  return *std::ranges::find(responses, name_wanted, &Response::name);
}

std::vector<Cell> cells(const Experiment& experiment) {
  std::size_t count = 1;
  for (const Factor& factor : experiment.factors) count *= factor.levels.size();
  std::vector<Cell> cells(count);
  std::set<std::string> names;
  for (std::size_t n = 0; n < count; ++n) {
    Cell& cell = cells[n];
    cell.levels.resize(experiment.factors.size());
    std::size_t rest = n;
    for (std::size_t i = experiment.factors.size(); i-- > 0;) {
      const std::size_t levels = experiment.factors[i].levels.size();
      cell.levels[i] = rest % levels;
      rest /= levels;
    }
    const std::string name = folder_name(experiment, cell.levels);
    cell.name = name;
    for (int attempt = 2; !names.insert(cell.name).second; ++attempt) cell.name = name + "~" + std::to_string(attempt);
  }
  return cells;
}

Settings settings_of(const Experiment& experiment, const Cell& cell) {
  Settings settings = experiment.settings;
  for (std::size_t i = 0; i < cell.levels.size(); ++i)
    for (const config::Node& setting : experiment.factors[i].levels[cell.levels[i]].settings)
      put_over(settings, setting);
  return settings;
}

std::string describe(const Experiment& experiment, const Cell& cell) {
  std::string text;
  for (std::size_t i = 0; i < cell.levels.size(); ++i)
    text +=
        (i == 0 ? "" : ", ") + experiment.factors[i].name + "=" + experiment.factors[i].levels[cell.levels[i]].label;
  return text;
}

}  // namespace kervan::lab
