// The shipped worlds: each has a picture beside it that is what the program draws, a line on the page, and, if it was
// drawn by the script, is what the script draws.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "tests/program/program.hpp"

namespace fs = std::filesystem;

namespace {

using kervan::test::Folder;
using kervan::test::run;
using kervan::test::run_line;
using kervan::test::text_of;

const fs::path worlds = fs::path(KERVAN_SOURCE) / "sim" / "worlds";

std::vector<fs::path> folders() { return {worlds, worlds / "traps"}; }

std::vector<std::string> names_of(const fs::path& folder, const char* ending) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ending) names.push_back(entry.path().stem());
  std::sort(names.begin(), names.end());
  return names;
}

TEST(Worlds, HaveThePictureThatTheProgramDraws) {
  const Folder folder;
  for (const fs::path& place : folders()) {
    for (const std::string& name : names_of(place, ".yaml")) {
      const fs::path world = place / (name + ".yaml"), picture = place / (name + ".svg");
      const auto drawn = run_line(KERVAN_PROGRAM, "draw '" + world.string() + "' --out world.svg", folder.path());
      ASSERT_EQ(drawn.code, 0) << drawn.err;
      EXPECT_TRUE(fs::exists(picture) && text_of(folder.path() / "world.svg") == text_of(picture))
          << "draw it: ./kervan draw " << world << " --out " << picture;
    }
    EXPECT_EQ(names_of(place, ".svg"), names_of(place, ".yaml"));
  }
}

TEST(Worlds, HaveThePlansThatTheProgramDraws) {
  const Folder folder;
  int plans = 0;
  for (const auto& entry : fs::directory_iterator(worlds / "plans")) {
    if (entry.path().extension() != ".yaml") continue;
    ++plans;
    const std::string name = entry.path().stem();
    const auto drawn = run_line(KERVAN_PROGRAM, "draw " + name + " --plan " + name + ".yaml", folder.path());
    ASSERT_EQ(drawn.code, 0) << drawn.err;
    for (const char* ending : {".yaml", ".png"})
      EXPECT_TRUE(text_of(folder.path() / (name + ending)) == text_of(worlds / "plans" / (name + ending)))
          << "draw it: ./kervan draw " << name << " --plan " << entry.path();
  }
  EXPECT_EQ(plans, 4);
}

TEST(Worlds, AreOnTheirPageWithTheirPictures) {
  for (const fs::path& place : folders()) {
    const std::string page = text_of(place / "README.md");
    for (const std::string& name : names_of(place, ".yaml")) {
      EXPECT_NE(page.find("![" + name + "](" + name + ".svg)"), std::string::npos) << name;
      EXPECT_NE(page.find("[`" + name + "`](" + name + ".yaml)"), std::string::npos) << name;
    }
  }
}

TEST(Worlds, AreWhatTheScriptDraws) {
  const Folder folder;
  int drawn = 0;
  for (const fs::path& place : folders()) {
    for (const std::string& name : names_of(place, ".yaml")) {
      const std::string text = text_of(place / (name + ".yaml"));
      if (text.find("# Drawn by draw.awk") == std::string::npos) continue;
      ++drawn;
      const auto result =
          run({"/usr/bin/awk", {"-f", (place / "draw.awk").string(), "-v", "world=" + name}}, folder.path());
      EXPECT_EQ(result.code, 0) << result.err;
      EXPECT_TRUE(result.out == text) << "draw it: awk -f draw.awk -v world=" << name << " > " << name << ".yaml";
    }
  }
  EXPECT_GE(drawn, 6 + 23);
}

}  // namespace
