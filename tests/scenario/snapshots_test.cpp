// What --snapshots shows, and that looking changes nothing.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/program/program.hpp"

namespace kervan::test {
namespace {

namespace fs = std::filesystem;

struct Looked {
  std::string trace;
  std::string map;
};

Looked run_lab(const std::vector<std::string>& options) {
  const Folder folder;
  std::vector<std::string> arguments{"run", "lab", "--json", "--for", "12s"};
  arguments.insert(arguments.end(), options.begin(), options.end());
  const Result result = run({KERVAN_PROGRAM, arguments}, folder.path());
  EXPECT_FALSE(result.out.empty()) << result.err;
  Looked looked;
  if (!result.out.empty()) looked.trace = nlohmann::json::parse(result.out)["trace_hash"];
  for (const auto& entry : fs::recursive_directory_iterator(folder.path()))
    if (entry.path().filename() == "map.svg") looked.map = text_of(entry.path());
  return looked;
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(Snapshots, ShowWhatTheSensorsOfTheLabSawAndChangeNothingElse) {
  const Looked plain = run_lab({}), looked = run_lab({"--snapshots", "5s"});
  for (const char* time : {">0 s</text>", ">5 s</text>", ">10 s</text>"}) {
    EXPECT_TRUE(has(looked.map, time)) << time;
    EXPECT_FALSE(has(plain.map, time)) << time;
  }
  EXPECT_FALSE(has(looked.map, ">1 s</text>"));
  EXPECT_TRUE(has(looked.map, "fill-opacity=\"0.1\""));
  EXPECT_EQ(looked.trace, plain.trace);
  EXPECT_EQ(run_lab({"--snapshots", "5s"}).map, looked.map);
}

}  // namespace
}  // namespace kervan::test
