/// Everything that the result of a run depends on, as one number: when it is the same, the run need not be made again.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace kervan::lab {

class Fingerprints {
 public:
  /// Takes the program: the contents of what is loaded into this process now. To be made before any component's module
  /// is, so that it does not depend on what else is in the plan.
  Fingerprints();

  /// Of a run that is told `specification` (JSON), that ends at `limit`, and whose components are in `modules`. Files
  /// that the specification names, and those that these name if they are YAML, count with their contents.
  std::uint64_t of(const std::string& specification, const std::string& limit,
                   const std::vector<std::filesystem::path>& modules);

 private:
  std::uint64_t contents(const std::filesystem::path& file);

  std::uint64_t program_ = 0;
  std::map<std::filesystem::path, std::uint64_t> contents_;  ///< what has been read
};

}  // namespace kervan::lab
