#include "framework/component/registry.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>
#include <stdexcept>

namespace kervan {

namespace fs = std::filesystem;

namespace {
const char kOfThisLibrary = 0;
}

ComponentRegistry::ComponentRegistry(std::vector<fs::path> folders) : folders_(std::move(folders)) {}

std::vector<fs::path> ComponentRegistry::default_folders() {
  std::vector<fs::path> folders;
  if (const char* path = std::getenv("KERVAN_COMPONENT_PATH")) {
    std::istringstream parts(path);
    for (std::string part; std::getline(parts, part, ':');)
      if (!part.empty()) folders.emplace_back(part);
  }
  std::error_code ignored;
  const fs::path program = fs::read_symlink("/proc/self/exe", ignored);
  if (!program.empty()) folders.push_back(program.parent_path().parent_path() / "lib" / "kervan" / "components");
  // Beside this library: there an installation has them, wherever the program that links it lies.
  Dl_info self;
  if (dladdr(&kOfThisLibrary, &self) != 0 && self.dli_fname) {
    const fs::path library = fs::canonical(self.dli_fname, ignored);
    const fs::path folder = library.parent_path() / "kervan" / "components";
    if (!ignored && std::find(folders.begin(), folders.end(), folder) == folders.end()) folders.push_back(folder);
  }
  return folders;
}

void ComponentRegistry::add(const ComponentClass& type) { types_[type.type] = type; }

const ComponentClass* ComponentRegistry::find(const std::string& name) {
  if (const auto found = types_.find(name); found != types_.end()) return &found->second;
  for (const fs::path& folder : folders_) {
    const fs::path file = folder / (name + ".so");
    if (!fs::is_regular_file(file)) continue;
    // Never unloaded: unloading a component removes the component, while its code and its types' code stay.
    void* module = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
    if (!module) throw std::runtime_error("cannot load the module of " + name + ": " + dlerror());
    const auto* type = static_cast<const ComponentClass*>(dlsym(module, "kervan_component"));
    if (!type) throw std::runtime_error(file.string() + " is no component module: it has no KERVAN_COMPONENT");
    if (name != type->type)
      throw std::runtime_error(file.string() + " holds the component " + type->type + ", not " + name);
    return &types_.emplace(name, *type).first->second;
  }
  return nullptr;
}

std::vector<std::string> ComponentRegistry::names() const {
  std::vector<std::string> names;
  for (const auto& [name, type] : types_) names.push_back(name);
  for (const fs::path& folder : folders_) {
    std::error_code none;
    for (auto entry = fs::recursive_directory_iterator(folder, none); entry != fs::recursive_directory_iterator();
         entry.increment(none)) {
      if (entry->path().extension() == ".so")
        names.push_back(fs::relative(entry->path(), folder).replace_extension().string());
    }
  }
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

}  // namespace kervan
