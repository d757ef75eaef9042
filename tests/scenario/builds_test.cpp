// One trace, whatever the compiler's flags: the same runs with the programs of all builds there are.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/program/program.hpp"

namespace kervan::test {
namespace {

namespace fs = std::filesystem;

/// When the newest file below `folder` with one of the endings was written.
fs::file_time_type newest(const fs::path& folder, const std::vector<std::string>& endings) {
  fs::file_time_type time = fs::file_time_type::min();
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file() && std::find(endings.begin(), endings.end(), entry.path().extension()) != endings.end())
      time = std::max(time, entry.last_write_time());
  return time;
}

/// Whether nothing was changed since the build; an older one may well have another trace.
bool is_up_to_date(const fs::path& build) {
  const fs::file_time_type built = std::max(newest(build / "bin", {""}), newest(build / "lib", {".so"}));
  for (const char* folder : {"framework", "components", "sim", "deploy", "idl"})
    if (newest(fs::path(KERVAN_SOURCES) / folder, {".cpp", ".hpp", ".c", ".h", ".idl"}) > built) return false;
  return true;
}

std::string trace(const fs::path& program, const std::string& law, int seed) {
  const Folder folder;
  const Result result =
      run({program.string(),
           {"run", "lab", "--json", "--arg", "controller=" + law, "--arg", "seed=" + std::to_string(seed)}},
          folder.path());
  if (result.out.empty()) return "no result: " + result.err;
  return nlohmann::json::parse(result.out)["trace_hash"];
}

TEST(Builds, HaveTheSameTrace) {
  const fs::path own = fs::canonical(KERVAN_PROGRAM);
  std::vector<fs::path> others;
  std::string outdated;
  if (fs::is_directory(KERVAN_SOURCES "/build")) {
    for (const auto& entry : fs::directory_iterator(KERVAN_SOURCES "/build")) {
      const fs::path program = entry.path() / "bin" / "kervan";
      if (!fs::is_regular_file(program) || fs::canonical(program) == own) continue;
      if (is_up_to_date(entry.path()))
        others.push_back(program);
      else
        outdated += " " + entry.path().filename().string();
    }
  }
  if (others.empty())
    GTEST_SKIP() << "there is no other build to compare with in " KERVAN_SOURCES "/build"
                 << (outdated.empty() ? "; make one, e.g. KERVAN_PRESET=asan ./kervan build"
                                      : " that is up to date; build again:" + outdated);
  for (const char* law : {"potential_gecui", "potential_classic"})
    for (const int seed : {1, 7}) {
      const std::string expected = trace(own, law, seed);
      for (const fs::path& other : others)
        EXPECT_EQ(trace(other, law, seed), expected) << other << " " << law << " seed " << seed;
    }
}

}  // namespace
}  // namespace kervan::test
