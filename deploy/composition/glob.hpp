/// Patterns over names with slashes: `*` stands for any characters within one segment, `**` for any number of segments.
#pragma once

#include <string_view>

namespace kervan::composition {

bool is_pattern(std::string_view text);

/// Whether the whole of `name` fits `pattern`.
bool matches(std::string_view pattern, std::string_view name);

/// Whether `name` or one of the names above it fits: `r*` covers `r1/control` because it matches `r1`.
bool covers(std::string_view pattern, std::string_view name);

/// Whether `a` is more specific than `b`: a plain name before any pattern, then the one with more characters that are
/// not wildcards, then the one without `**`.
bool more_specific(std::string_view a, std::string_view b);

}  // namespace kervan::composition
