#include "deploy/lab/fingerprint.hpp"

#include <link.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "framework/dds/hash.hpp"

namespace kervan::lab {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::uint64_t hash_of(const std::string& text) {
  Hash64 hash;
  hash.text(text);
  return hash.value();
}

int add_library(dl_phdr_info* info, std::size_t, void* data) {
  if (info->dlpi_name != nullptr && info->dlpi_name[0] == '/')
    static_cast<std::vector<fs::path>*>(data)->emplace_back(info->dlpi_name);
  return 0;
}

void collect_files(const nlohmann::json& value, std::set<fs::path>& files) {
  if (value.is_structured())
    for (const auto& child : value) collect_files(child, files);
  std::error_code none;
  if (value.is_string() && value.get_ref<const std::string&>().starts_with('/') &&
      fs::is_regular_file(value.get<std::string>(), none))
    files.insert(value.get<std::string>());
}

/// Words of a YAML file that name files beside it.
std::vector<fs::path> named_in(const fs::path& file) {
  if (file.extension() != ".yaml" && file.extension() != ".yml") return {};
  static const std::regex word("[A-Za-z0-9_./-]+\\.[A-Za-z0-9]+");
  const std::string text = text_of(file);
  std::vector<fs::path> named;
  std::error_code none;
  for (auto match = std::sregex_iterator(text.begin(), text.end(), word); match != std::sregex_iterator(); ++match) {
    const fs::path candidate = file.parent_path() / match->str();
    if (fs::is_regular_file(candidate, none)) named.push_back(candidate);
  }
  return named;
}

}  // namespace

Fingerprints::Fingerprints() {
  std::vector<fs::path> libraries{"/proc/self/exe"};
  ::dl_iterate_phdr(add_library, &libraries);
  Hash64 hash;
  for (const fs::path& library : libraries) hash.word(hash_of(text_of(library)));
  program_ = hash.value();
}

std::uint64_t Fingerprints::contents(const fs::path& file) {
  const auto [known, is_new] = contents_.try_emplace(file, 0);
  if (is_new) {  // entered before it is read: files that name each other end here
    Hash64 hash;
    hash.text(text_of(file));
    for (const fs::path& named : named_in(file)) hash.word(contents(named));
    contents_[file] = hash.value();
  }
  return contents_[file];
}

std::uint64_t Fingerprints::of(const std::string& specification, const std::string& limit,
                               const std::vector<fs::path>& modules) {
  Hash64 hash;
  hash.word(program_);
  hash.text(specification);
  hash.text(limit);
  std::set<fs::path> files(modules.begin(), modules.end());
  collect_files(nlohmann::json::parse(specification), files);
  for (const fs::path& file : files) hash.word(contents(file));
  return hash.value();
}

}  // namespace kervan::lab
