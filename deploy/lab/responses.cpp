#include "deploy/lab/responses.hpp"

#include <charconv>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace kervan::lab {
namespace {

using nlohmann::json;

/// A key may hold dots itself (`figures.r1.p99.5`), so longer keys are tried first. Null pointer: there is none.
const json* at(const json& value, const std::string& path) {
  if (path.empty()) return &value;
  if (!value.is_object()) return nullptr;
  for (std::size_t end = path.size(); end != std::string::npos && end > 0; end = path.find_last_of('.', end - 1)) {
    const auto child = value.find(path.substr(0, end));
    if (child == value.end()) continue;
    if (const json* found = at(*child, end < path.size() ? path.substr(end + 1) : "")) return found;
  }
  return nullptr;
}

void list_figures(const json& value, const std::string& path, std::vector<std::string>& figures) {
  if (value.is_array()) return;
  if (!value.is_object()) return figures.push_back(path);
  for (const auto& [key, child] : value.items()) list_figures(child, path.empty() ? key : path + "." + key, figures);
}

Value value_of(const json& figure, const Response& response) {
  if (response.is) return figure.is_string() && figure.get<std::string>() == *response.is;
  if (figure.is_boolean()) return figure.get<bool>();
  if (figure.is_number()) return figure.get<double>();
  if (figure.is_string()) return figure.get<std::string>();
  return {};
}

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace

RunValues values_in(const std::vector<Response>& responses, const std::string& summary) {
  const json object = json::parse(summary, nullptr, false);
  if (!object.is_object()) throw std::runtime_error("there is no JSON object in it");
  RunValues run;
  for (std::size_t i = 0; i < responses.size(); ++i) {
    const json* figure = at(object, responses[i].figure);
    const bool is_figure = figure != nullptr && !figure->is_structured();
    if (!is_figure) run.absent.push_back(i);
    run.values.push_back(is_figure ? value_of(*figure, responses[i]) : Value());
  }
  list_figures(object, "", run.figures);
  return run;
}

RunValues read_values(const std::vector<Response>& responses, const std::filesystem::path& summary) {
  return values_in(responses, text_of(summary));
}

void require_figures(const std::vector<Response>& responses, const RunValues& run) {
  for (const std::size_t i : run.absent)
    if (!responses[i].optional)
      throw ConfigError(responses[i].location, "the runs have no figure '" + responses[i].figure + "'" +
                                                   config::hint(responses[i].figure, run.figures, "they have"));
}

std::string to_text(const Value& value) {
  if (const auto* so = std::get_if<bool>(&value)) return *so ? "yes" : "no";
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  if (const auto* number = std::get_if<double>(&value)) {
    char buffer[32];
    const auto end = std::to_chars(buffer, buffer + sizeof buffer, *number);
    return {buffer, end.ptr};
  }
  return "";
}

}  // namespace kervan::lab
