/// A container's specification as a file: what a supervisor hands to the process that hosts the container. Every value
/// comes back exactly as it was; durations are whole nanoseconds, hashes 16 hexadecimal digits.
#pragma once

#include <filesystem>
#include <string>

#include "framework/runtime/spec.hpp"

namespace kervan::container {

/// Throws std::runtime_error if a text is no UTF-8.
std::string to_json(const runtime::ContainerSpec& spec);

/// Throws ConfigError with file, place and key for anything that is missing, unknown or of another type.
/// `shown_as` names the text in messages.
runtime::ContainerSpec spec_from_json(const std::string& text, const std::string& shown_as);

/// Throws ConfigError if the file cannot be written, or cannot be read.
void write_spec(const runtime::ContainerSpec& spec, const std::filesystem::path& file);
runtime::ContainerSpec read_spec(const std::filesystem::path& file);

}  // namespace kervan::container
