// The examples on the pages of the format are real.
#include <gtest/gtest.h>

#include <fstream>

#include "deploy/composition/load.hpp"

using namespace kervan;

namespace {

std::vector<std::string> yaml_blocks(const std::filesystem::path& page) {
  std::ifstream stream(page);
  std::vector<std::string> blocks;
  bool inside = false;
  for (std::string line; std::getline(stream, line);) {
    if (line == "```yaml") blocks.emplace_back();
    if (line.starts_with("```"))
      inside = line == "```yaml";
    else if (inside)
      blocks.back() += line + "\n";
  }
  return blocks;
}

/// An example that shows only some keys, completed by the least that a composition needs.
std::string completed(const std::string& block) {
  if (block.starts_with("kervan: 1")) return block;
  std::string text = "kervan: 1\nname: example\n" + block;
  if (block.find("\ncomponents:") == std::string::npos && !block.starts_with("components:"))
    text += "components: {world: {type: sim/world}, r1: {type: control/potential_field}}\n";
  return text;
}

TEST(FormatPages, HaveOnlyExamplesThatLoad) {
  for (const char* page : {"README.md", "qos.md"}) {
    const auto blocks = yaml_blocks(std::filesystem::path(COMPOSITION_TESTS) / "../../deploy/composition" / page);
    EXPECT_FALSE(blocks.empty());
    for (const std::string& block : blocks)
      EXPECT_NO_THROW(composition::load_text(completed(block), page, "")) << block;
  }
}

}  // namespace
