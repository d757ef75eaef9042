/// Finds component types: modules (shared objects named by their type below the component folders, loaded on first use
/// and never unloaded) and types that a program adds itself, as tests do.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "framework/component/component.hpp"

namespace kervan {

class ComponentRegistry {
 public:
  /// Looks for modules in `folders`, first match wins.
  explicit ComponentRegistry(std::vector<std::filesystem::path> folders);

  /// The folders of KERVAN_COMPONENT_PATH (separated by ':'), then lib/kervan/components beside the running program and
  /// kervan/components beside this library.
  static std::vector<std::filesystem::path> default_folders();

  /// Adds a type of this program; it hides a module of the same name.
  void add(const ComponentClass& type);

  /// The type called `name` ("control/vff"); nullptr if there is none. Throws std::runtime_error with the reason when a
  /// module of that name exists but cannot be loaded.
  const ComponentClass* find(const std::string& name);

  /// The names of all types there are, sorted.
  std::vector<std::string> names() const;

  const std::vector<std::filesystem::path>& folders() const { return folders_; }

 private:
  std::vector<std::filesystem::path> folders_;
  std::map<std::string, ComponentClass> types_;
};

}  // namespace kervan
