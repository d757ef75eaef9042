// The strict reader: which files it takes, and what it says about the others.
#include "framework/config/node.hpp"

#include <gtest/gtest.h>

#include "tests/unit/config/refused.hpp"

using namespace kervan;
using namespace std::chrono_literals;
using config::parse;
using test::refused;

namespace {

std::string refused_text(const std::string& yaml) {
  return refused([&] { parse(yaml, "f.yaml"); });
}

TEST(StrictYaml, KeepsThePlaceOfEveryValueAndOfItsKey) {
  const auto root = parse("a: 1\nlist:\n  - x\n  -   {y: 2}\n", "f.yaml");
  EXPECT_EQ(to_text(root.required("a").location), "f.yaml:1:4");
  const auto& y = root.required("list").list()[1].required("y");
  EXPECT_EQ(to_text(y.location), "f.yaml:4:11");
  EXPECT_EQ(to_text(y.key_location), "f.yaml:4:8");
}

TEST(StrictYaml, NamesItemsByTheirListAndIndex) {
  const auto root = parse("nodes: [[1, 2], [3, 4]]", "f.yaml");
  EXPECT_EQ(root.required("nodes").list()[1].list()[0].name, "nodes[1][0]");
}

TEST(StrictYaml, TellsQuotedFromPlainScalars) {
  const auto root = parse("a: '1'\nb: 1\nc: \"x\"\nd: |\n  text\n", "f.yaml");
  EXPECT_TRUE(root.required("a").quoted);
  EXPECT_FALSE(root.required("b").quoted);
  EXPECT_TRUE(root.required("c").quoted);
  EXPECT_EQ(root.required("d").text, "text\n");
}

TEST(StrictYaml, PlacesAMissingValueAtItsKey) {
  const auto root = parse("a:\n  b:\n\n\nc: 1\n", "f.yaml");
  EXPECT_EQ(to_text(root.required("a").required("b").location), "f.yaml:2:3");
}

TEST(StrictYaml, RefusesWhatMakesYamlSurprising) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"a: 1\nb: 2\na: 3\n", "f.yaml:3:1: duplicate key 'a'; it was first given at line 1"},
      {"a: {x: 1, x: 2}", "f.yaml:1:11: duplicate key 'x'; it was first given at line 1"},
      {"a: &name 1\nb: *name\n", "f.yaml:1:4: anchors (&name) are not allowed; write the value out, or use a template"},
      {"a: *name\n", "f.yaml:1:4: this is not valid YAML: the referenced anchor is not defined"},
      {"base: {x: 1}\na:\n  <<: {x: 2}\n", "f.yaml:3:3: merge keys (<<) are not allowed; use a template"},
      {"a: !!str 1\n", "f.yaml:1:4: tags (tag:yaml.org,2002:str) are not allowed; the type follows from the key"},
      {"a: !mine {b: 1}\n", "f.yaml:1:4: tags (!mine) are not allowed; the type follows from the key"},
      {"a: 1\n---\nb: 2\n", "f.yaml:3:1: a second document begins here; a file holds one"},
      {"a:\n\tb: 1\n", "f.yaml:2:1: a tab indents this line; use spaces"},
      {std::string("a: \0", 4), "f.yaml:1:4: this is not a text file"},
      {"", "f.yaml:1:1: the file is empty"},
      {"# only a comment\n", "f.yaml:1:1: the file is empty"},
      {"[a, b]: 1\n", "f.yaml:1:1: a key must be a single word, not a list or a map"},
      {": 1\n", "f.yaml:1:1: a key is missing before the colon"},
      {"a: [1, 2\n", "f.yaml:2:1: this is not valid YAML: end of sequence flow not found"},
      {"a: b: c\n", "f.yaml:1:5: this is not valid YAML: illegal map value"},
  };
  for (const auto& [yaml, message] : cases) EXPECT_EQ(refused_text(yaml), message) << yaml;
}

TEST(StrictYaml, SaysThatAFileCannotBeRead) {
  EXPECT_EQ(refused([] { config::load("/no/such/file.yaml", "file.yaml"); }),
            "file.yaml: cannot read the file: No such file or directory");
}

TEST(Node, SuggestsTheKeyThatWasMeant) {
  const auto root = parse("kind: wall\ncolour: red\n", "f.yaml");
  EXPECT_EQ(refused([&] {
              root.only_keys({"kind", "color", "size"});
            }),
            "f.yaml:2:1: unknown key 'colour'; did you mean 'color'? allowed: kind, color, size");
  EXPECT_EQ(refused([&] {
              root.only_keys({"kind", "size"});
            }),
            "f.yaml:2:1: unknown key 'colour'; allowed: kind, size");
}

TEST(Node, NamesTheMissingKey) {
  const auto root = parse("wall: {from: 1}\n", "f.yaml");
  EXPECT_EQ(refused([&] { root.required("wall").required("to"); }), "f.yaml:1:7: wall: the key 'to' is missing");
}

TEST(Node, TakesOnlyTrueAndFalseForBooleans) {
  const auto root = parse("a: true\nb: no\nc: On\nd: 'true'\ne: 7\nf:\n", "f.yaml");
  EXPECT_TRUE(root.required("a").as_bool());
  EXPECT_EQ(refused([&] { root.required("b").as_bool(); }),
            "f.yaml:2:4: b: 'no' is not a boolean; write false (only true and false are booleans)");
  EXPECT_EQ(refused([&] { root.required("c").as_bool(); }),
            "f.yaml:3:4: c: 'On' is not a boolean; write true (only true and false are booleans)");
  EXPECT_EQ(refused([&] { root.required("d").as_bool(); }),
            "f.yaml:4:4: d: \"true\" is a text because of its quotes; write true or false without quotes");
  EXPECT_EQ(refused([&] { root.required("e").as_bool(); }), "f.yaml:5:4: e: expected true or false, found 7");
  EXPECT_EQ(refused([&] { root.required("f").as_bool(); }), "f.yaml:6:1: f: expected true or false, found nothing");
}

TEST(Node, TakesOnlyDecimalIntegers) {
  const auto root = parse("a: -12\nb: 010\nc: 0x10\nd: 1.0\ne: 99999999999999999999\nf: ten\ng: 0\nh: '5'\n", "f.yaml");
  EXPECT_EQ(root.required("a").as_integer(), -12);
  EXPECT_EQ(root.required("g").as_integer(), 0);
  EXPECT_EQ(refused([&] { root.required("b").as_integer(); }),
            "f.yaml:2:4: b: '010' begins with a zero, which some read as octal; write it without");
  EXPECT_EQ(refused([&] { root.required("c").as_integer(); }),
            "f.yaml:3:4: c: expected an integer: '0x10' is not a number");
  EXPECT_EQ(refused([&] { root.required("d").as_integer(); }),
            "f.yaml:4:4: d: 1.0 is not an integer; write a whole number without point or exponent");
  EXPECT_EQ(refused([&] { root.required("e").as_integer(); }),
            "f.yaml:5:4: e: 99999999999999999999 does not fit into 64 bits");
  EXPECT_EQ(refused([&] { root.required("f").as_integer(); }),
            "f.yaml:6:4: f: expected an integer: 'ten' is not a number");
  EXPECT_EQ(refused([&] { root.required("h").as_integer(); }),
            "f.yaml:8:4: h: \"5\" is a text because of its quotes; write the number without quotes");
}

TEST(Node, ReadsPosesAndPointsWithUnits) {
  const auto root = parse("pose: [1.0 m, 50 cm, 180 deg]\npoint: [1 m, 2]\n", "f.yaml");
  const auto pose = root.required("pose").as_pose();
  EXPECT_DOUBLE_EQ(pose.x, 1.0);
  EXPECT_DOUBLE_EQ(pose.y, 0.5);
  EXPECT_DOUBLE_EQ(pose.yaw, std::numbers::pi);
  EXPECT_EQ(refused([&] { root.required("point").as_point(); }),
            "f.yaml:2:14: point[1]: 2 has no unit; write e.g. 2 m");
  EXPECT_EQ(refused([&] { root.required("pose").as_point(); }),
            "f.yaml:1:7: pose: expected a point [x m, y m], found a list of 3");
}

TEST(Node, ReadsDurations) {
  EXPECT_EQ(parse("50ms", "f").as_duration(), 50ms);
  EXPECT_EQ(parse("1.5 s", "f").as_duration(), 1500ms);
  EXPECT_EQ(parse("2 min", "f").as_duration(), 120s);
}

TEST(Node, IsShownInOneShortLine) {
  const auto root = parse("a: \"first\\nsecond\"\nb: " + std::string(200, 'x') + "\n", "f.yaml");
  EXPECT_EQ(refused([&] { root.required("a").as_bool(); }),
            "f.yaml:1:4: a: \"first second\" is a text because of its quotes; write true or false without quotes");
  EXPECT_EQ(refused([&] { root.required("b").as_bool(); }),
            "f.yaml:2:4: b: expected true or false, found " + std::string(60, 'x') + "...");
}

TEST(Node, FollowsAPathAsFarAsItLeads) {
  const auto root = parse("robots: {r1: {start: [1, 2]}}", "f.yaml");
  EXPECT_EQ(root.nearest_to("robots.r1.start[1]").text, "2");
  EXPECT_EQ(root.nearest_to("robots.r1.start[7]").name, "start");
  EXPECT_EQ(root.nearest_to("robots.r2.start").name, "robots");
}

}  // namespace
