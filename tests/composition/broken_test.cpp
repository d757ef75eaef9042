// Every file under broken/ holds one mistake. Its first lines say what must be reported, exactly:
//   #= 40_unknown_parameter.yaml:6:38: control/field has no parameter 'sped'; …
//   #arg controller=vff        (a command line argument, if the mistake is there; #place, #host and #emulate likewise)
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "deploy/composition/load.hpp"
#include "tests/composition/fake_components.hpp"

namespace fs = std::filesystem;
using namespace kervan;

namespace {

struct Case {
  fs::path file;
  std::string expected;
  composition::LoadOptions options;
};

Case read(const fs::path& file) {
  Case result{file, "", {}};
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line) && line.starts_with('#');) {
    if (line.starts_with("#= ")) result.expected += line.substr(3) + "\n";
    if (line.starts_with("#arg ")) result.options.arguments.push_back(line.substr(5));
    if (line.starts_with("#place ")) result.options.place.push_back(line.substr(7));
    if (line.starts_with("#host ")) result.options.host = line.substr(6);
    if (line == "#emulate") result.options.emulate_hosts = true;
  }
  return result;
}

std::string text_of(const fs::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// What a person would read: the error that stops, or one line for each finding.
std::string report(const Case& test) {
  fs::current_path(COMPOSITION_TESTS);  // messages show paths as seen from here
  try {
    test::FakeComponents components;
    const auto resolved =
        composition::resolve(composition::load_text(text_of(test.file), test.file.filename().string(),
                                                    fs::path(COMPOSITION_TESTS) / "worlds", test.options),
                             components);
    std::string lines;
    for (const auto& finding : resolved.findings) lines += to_text(finding.location) + ": " + finding.message + "\n";
    return lines.empty() ? "nothing was reported\n" : lines;
  } catch (const ConfigError& error) {
    return std::string(error.what()) + "\n";
  }
}

std::vector<fs::path> files() {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(fs::path(COMPOSITION_TESTS) / "broken"))
    files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

class BrokenComposition : public testing::TestWithParam<fs::path> {};

TEST_P(BrokenComposition, IsReportedInOneSentenceAtItsPlace) {
  const Case test = read(GetParam());
  ASSERT_FALSE(test.expected.empty()) << "the file does not say what must be reported";
  EXPECT_EQ(report(test), test.expected);
}

INSTANTIATE_TEST_SUITE_P(File, BrokenComposition, testing::ValuesIn(files()),
                         [](const auto& file) { return file.param.stem().string(); });

TEST(BrokenCompositions, AreManyMore) { EXPECT_GE(files().size(), 140u); }

}  // namespace
