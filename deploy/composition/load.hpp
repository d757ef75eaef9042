/// Reads a composition file and everything in it that can be judged without knowing the component types.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "deploy/composition/composition.hpp"

namespace kervan::composition {

struct LoadOptions {
  std::vector<std::string> arguments = {};  ///< "controller=vff", as on the command line
  std::vector<std::string> place = {};      ///< "all", "each" or "brain=r1/*,r2", as on the command line
  std::string host = {};                    ///< the host that this is; empty: not said
  bool emulate_hosts = false;               ///< this machine is to play all of them
  std::vector<config::Node> values = {};    ///< arguments, too, each named by its node: `seed`
  std::vector<config::Node> settings = {};  ///< parameters over those of the file (settings.hpp)
};

/// Throws ConfigError at the place of the first thing that cannot be used.
Composition load(const std::filesystem::path& file, const LoadOptions& options = {});

/// The same for a text; `shown_as` names it in messages, `folder` is where its relative paths begin.
Composition load_text(const std::string& text, const std::string& shown_as, const std::filesystem::path& folder,
                      const LoadOptions& options = {});

/// The file of a composition, or of what else `what` says: `name_or_file` itself if it ends in .yaml or holds a slash,
/// else NAME.yaml in the first of `folders` that has it. Throws ConfigError with a suggestion and the list of what
/// there is.
std::filesystem::path find_composition(const std::string& name_or_file,
                                       const std::vector<std::filesystem::path>& folders,
                                       const std::string& what = "composition");

/// The path as a person would write it from here: relative if it lies below the working folder.
std::string shown_path(const std::filesystem::path& path);

}  // namespace kervan::composition
