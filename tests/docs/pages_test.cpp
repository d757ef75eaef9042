// The pages are true: tables come from the program, quoted code and linked files exist, commands can be given.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <regex>
#include <sstream>

#include "tests/program/program.hpp"

namespace fs = std::filesystem;

namespace {

const fs::path root = KERVAN_SOURCE;

using kervan::test::lines_of;
using kervan::test::text_of;

kervan::test::Result kervan_says(const std::string& arguments) {
  return kervan::test::run_line(KERVAN_PROGRAM, arguments, root);
}

std::string trimmed(const std::string& line) {
  const auto begin = line.find_first_not_of(' ');
  return begin == std::string::npos ? "" : line.substr(begin, line.find_last_not_of(' ') - begin + 1);
}

/// Every page of the repository.
std::vector<fs::path> pages() {
  std::vector<fs::path> pages;
  for (auto entry = fs::recursive_directory_iterator(root); entry != fs::recursive_directory_iterator(); ++entry) {
    const std::string name = entry->path().filename();
    if (entry->is_directory() && (name == "build" || name == "runs" || name.starts_with(".")))
      entry.disable_recursion_pending();
    if (entry->path().extension() == ".md") pages.push_back(entry->path());
  }
  return pages;
}

/// A fenced block of a page: its language, the line of text before it, and what it holds.
struct Block {
  std::string language;
  std::string lead;
  std::vector<std::string> lines;
};

std::vector<Block> blocks_of(const fs::path& page) {
  std::vector<Block> blocks;
  bool inside = false;
  std::string lead;
  for (const std::string& line : lines_of(text_of(page))) {
    if (line.starts_with("```")) {
      inside = !inside;
      if (inside) blocks.push_back({line.substr(3), lead, {}});
    } else if (inside) {
      blocks.back().lines.push_back(line);
    } else if (!trimmed(line).empty()) {
      lead = line;
    }
  }
  return blocks;
}

/// The first line of `quoted` that does not follow the one before it in `source`; nothing if all do. Indentation is
/// free, and a line with only "…" leaves something out.
std::optional<std::string> misquoted(const std::vector<std::string>& quoted, const std::vector<std::string>& source) {
  const auto matches_from = [&](std::size_t at) -> std::optional<std::string> {
    bool gap = false;
    for (const std::string& line : quoted) {
      const std::string wanted = trimmed(line);
      if (wanted == "…") {
        gap = true;
        continue;
      }
      while (gap && at < source.size() && trimmed(source[at]) != wanted) ++at;
      gap = false;
      if (at >= source.size() || trimmed(source[at]) != wanted) return line;
      ++at;
    }
    return std::nullopt;
  };
  std::optional<std::string> wrong = quoted.front();
  for (std::size_t at = 0; at < source.size(); ++at) {
    if (trimmed(source[at]) != trimmed(quoted.front())) continue;
    wrong = matches_from(at);
    if (!wrong) return std::nullopt;
  }
  return wrong;
}

TEST(ComponentPages, HaveTheTablesThatTheProgramPrints) {
  const auto types = nlohmann::json::parse(kervan_says("describe --json").out).at("components");
  ASSERT_GE(types.size(), 7u);
  for (const auto& component : types) {
    const auto type = component.at("type").get<std::string>();
    const fs::path page = (type.starts_with("sim/") ? root : root / "components") / (type + ".md");
    ASSERT_TRUE(fs::exists(page)) << type << " has no page " << page;
    const std::string text = text_of(page);
    const std::string begin = "<!-- kervan describe " + type + " -->\n", end = "<!-- end -->\n";
    const auto from = text.find(begin);
    ASSERT_NE(from, std::string::npos) << page << " has no line " << begin;
    const auto to = text.find(end, from);
    ASSERT_NE(to, std::string::npos) << page << " has no line " << end;
    const auto printed = kervan_says("describe " + type + " --markdown");
    EXPECT_EQ(printed.code, 0);
    EXPECT_EQ(text.substr(from + begin.size(), to - from - begin.size()), printed.out)
        << page << " is out of date; put between its markers what this prints: ./kervan describe " << type
        << " --markdown";
  }
}

TEST(Pages, QuoteOnlyCodeThatIsThere) {
  const std::regex source("From `([^`]+)`.*:");
  int quoted = 0;
  for (const char* name : {"README.md", "CONTRIBUTING.md", "framework/README.md", "framework/test/README.md"}) {
    for (const Block& block : blocks_of(root / name)) {
      std::smatch match;
      if (!std::regex_search(block.lead, match, source)) {
        EXPECT_NE(block.language, "cpp") << name << " quotes C++ without saying from where: " << block.lines.front();
        continue;
      }
      ++quoted;
      const fs::path file = root / match[1].str();
      ASSERT_TRUE(fs::exists(file)) << name << ": " << file;
      const auto wrong = misquoted(block.lines, lines_of(text_of(file)));
      EXPECT_FALSE(wrong) << name << " quotes " << match[1] << " wrongly, from: " << wrong.value_or("");
    }
  }
  EXPECT_GE(quoted, 5);
}

/// The page without its fenced blocks.
std::string prose_of(const fs::path& page) {
  std::string prose;
  bool inside = false;
  for (const std::string& line : lines_of(text_of(page))) {
    if (line.starts_with("```")) inside = !inside;
    if (!inside) prose += line + "\n";
  }
  return prose;
}

TEST(Pages, LinkOnlyToWhatIsThere) {
  const std::regex link("\\]\\(([^)#]+)(#[^)]*)?\\)");
  for (const fs::path& page : pages()) {
    const std::string text = prose_of(page);
    for (auto match = std::sregex_iterator(text.begin(), text.end(), link); match != std::sregex_iterator(); ++match) {
      const std::string target = (*match)[1];
      if (target.find("://") != std::string::npos) continue;
      EXPECT_TRUE(fs::exists(page.parent_path() / target)) << page << " links to " << target;
    }
  }
}

/// A command of the front page: one of the script's own, or one that the program takes as it stands. What is run is
/// only checked here; the project in tests/package has a test of its own.
void expect_good(const std::string& command) {
  std::istringstream words(command);
  std::string script, verb, rest;
  words >> script >> verb;
  std::getline(words, rest);
  if (verb == "build" || verb == "test" || verb == "bench") {
    EXPECT_NE(text_of(root / "kervan").find("    " + verb + ")\n"), std::string::npos) << command;
  } else if (const std::string file = trimmed(rest); file.starts_with("tests/package/")) {
    EXPECT_EQ(kervan_says(verb + " --help").code, 0) << command;
    EXPECT_TRUE(fs::exists(root / file)) << command;
  } else if (verb == "sweep") {
    // That every shipped one can begin is tested where sweeps are.
    EXPECT_TRUE(fs::exists(root / "deploy/lab/experiments" / (file + ".yaml"))) << command;
  } else {
    // How long it may run is nothing to check.
    const auto result =
        kervan_says(verb == "run" ? "check" + std::regex_replace(rest, std::regex(" --for [^ ]+"), "") : verb + rest);
    EXPECT_EQ(result.code, 0) << command << "\n" << result.out + result.err;
  }
}

TEST(FrontPage, ShowsOnlyCommandsThatWork) {
  int commands = 0;
  for (const Block& block : blocks_of(root / "README.md")) {
    for (const std::string& line : block.lines) {
      if (!line.starts_with("./kervan ")) continue;
      ++commands;
      expect_good(line.substr(0, line.find(" #")));
    }
  }
  EXPECT_GE(commands, 4);
}

}  // namespace
