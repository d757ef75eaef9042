// What a person sees: a bar on a terminal, the result alone elsewhere, and nothing else while all is well.
#include <gtest/gtest.h>

#include "tests/program/program.hpp"

namespace kervan::test {
namespace {

TEST(Terminal, ShowsABarWithTimeAndSpeedAndThenTheResult) {
  const Folder folder;
  if (run({"/bin/sh", {"-c", "script -qec true /dev/null"}}, folder.path()).code != 0)
    GTEST_SKIP() << "script(1) cannot make a terminal here";
  const Result result = run({"/usr/bin/script", {"-qec", KERVAN_PROGRAM " run lab", "/dev/null"}}, folder.path());
  EXPECT_EQ(result.code, 0) << result.out;
  const auto bar = result.out.find("[################..............] 50.5 s of 90.0 s, ");
  ASSERT_NE(bar, std::string::npos) << result.out;
  EXPECT_NE(result.out.find("\nsuccess", bar), std::string::npos) << result.out;
}

TEST(Terminal, IsNotAssumedInAPipe) {
  const Folder folder;
  const Result result = run({KERVAN_PROGRAM, {"run", "lab"}}, folder.path());
  EXPECT_EQ(result.code, 0);
  EXPECT_EQ(result.err, "");
  const auto lines = lines_of(result.out);
  ASSERT_EQ(lines.size(), 4u) << result.out;
  EXPECT_EQ(lines[0], "success");
  EXPECT_TRUE(lines[1].starts_with("  r1  reached its goal in ")) << lines[1];
  EXPECT_NE(lines[2].find("x real time, trace "), std::string::npos) << lines[2];
  EXPECT_TRUE(std::filesystem::is_directory(folder.path() / lines[3].substr(2))) << lines[3];
}

TEST(Log, TellsTheStoryOfARunInTheFile) {
  const Folder folder;
  ASSERT_EQ(run({KERVAN_PROGRAM, {"run", "lab"}}, folder.path()).code, 0);
  std::string log;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path() / "runs"))
    log = text_of(entry.path() / "log.txt");
  for (const char* line :
       {"[mission] r1 is sent to goal 1 of 1, (16.00, 7.80)",
        "[r1/planner] route to (16.00, 7.80) over 0-1-2-4-5: ", "[r1/follower] waypoint 4 of 5 passed",
        "[mission] r1 has reached goal 1 of 1", "[r1/guard] the last command is zero"})
    EXPECT_NE(log.find(line), std::string::npos) << line << "\n" << log;
}

}  // namespace
}  // namespace kervan::test
