/// What a run has to say about each response, from its summary.json.
#pragma once

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "deploy/lab/experiment.hpp"

namespace kervan::lab {

/// Nothing (the run lacks the figure, or it is null), so or not, a number, or a text such as the trace hash.
using Value = std::variant<std::monostate, bool, double, std::string>;

struct RunValues {
  std::vector<Value> values;         ///< one for each response
  std::vector<std::size_t> absent;   ///< responses whose figure the summary does not have at all
  std::vector<std::string> figures;  ///< dotted paths of all figures that it has
};

/// Throws std::runtime_error if `summary` is no file with a JSON object.
RunValues read_values(const std::vector<Response>& responses, const std::filesystem::path& summary);

/// The same for a text.
RunValues values_in(const std::vector<Response>& responses, const std::string& summary);

/// Throws ConfigError at the first response that is not optional and whose figure is absent, with what there is.
void require_figures(const std::vector<Response>& responses, const RunValues& run);

/// A value for a table: "12.3", "yes", the text; empty for nothing. Numbers as short as they can be read back exactly.
std::string to_text(const Value& value);

}  // namespace kervan::lab
