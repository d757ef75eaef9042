// Who may include whom. The arrows are those of the house: deploy -> framework -> idl, components and the simulator ->
// framework, and algorithms know nothing but geometry. What an arrow does not allow needs a line here, with its reason.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <regex>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;
using Strings = std::vector<std::string>;

/// In an arrow: generated message types, "nav_msgs/msg/Odometry.hpp".
const char* const messages = "<messages>";
/// In an arrow: the folder of the including file, as far as the second slash (components/control/).
const char* const own_folder = "<own folder>";

/// Files whose path fits `files` may include project headers that begin with one of `may_include`, and none that begins
/// with one of `but_not`. The first arrow that fits a file holds.
struct Arrow {
  const char* files;  ///< a regular expression over the whole path
  Strings may_include;
  Strings but_not = {};
};

const std::vector<Arrow> arrows = {
    // Conversions between geometry and messages stand with geometry, for everybody who has messages at all.
    {"framework/geometry/messages.hpp", {"framework/geometry/", "framework/component/time.hpp", messages}},
    // time.hpp is two aliases of std::chrono.
    {"framework/geometry/pose_history.hpp", {"framework/geometry/", "framework/component/time.hpp"}},
    {"framework/geometry/.*", {"framework/geometry/"}, {"framework/geometry/messages.hpp"}},
    // The strict reader of files and what a manifest is made of: a library of their own, without DDS.
    {"framework/config/.*",
     {"framework/config/", "framework/geometry/", "framework/component/"},
     {"framework/component/component.hpp", "framework/component/ports.hpp", "framework/component/sample.hpp"}},
    // Pictures and map_server's files: a library for the simulator's worlds and for maps.
    {"framework/map_file/.*", {"framework/map_file/", "framework/config/", "framework/geometry/"}},
    // Threads that share out work: a library for lockstep and for the simulator.
    {"framework/workers/.*", {"framework/workers/"}},
    {"framework/dds/.*", {"framework/dds/", "framework/component/", "framework/geometry/"}},
    // A component's public headers do not show what runs it; its .cpp files hand over to the runtime.
    {"framework/component/.*\\.hpp", {"framework/component/", "framework/geometry/", "framework/dds/"}},
    {"framework/.*", {"framework/", messages}, {"framework/config/"}},

    // What the areas share: cells, and the files that maps are kept in.
    {"components/grid/messages.hpp", {own_folder, messages}},
    {"components/grid/.*",
     {own_folder, "framework/geometry/", "framework/map_file/"},
     {"framework/geometry/messages.hpp"}},
    // Messages that several components of an area read or write alike, and the shell of those that make maps.
    {"components/observe/outline\\.hpp", {own_folder, messages}},
    {"components/mapping/map_(maker|ports)\\.hpp",
     {own_folder, "components/grid/", "framework/kervan.hpp", "framework/component/", "framework/geometry/", messages}},
    {"components/localization/pose_ports\\.hpp", {own_folder, "framework/kervan.hpp", "framework/geometry/", messages}},
    {"components/localization/scan_match_params\\.hpp",
     {own_folder, "framework/component/parameters.hpp", "framework/geometry/"}},
    // A robot that finds itself in the map it makes puts readings into it as the mappers do.
    {"components/localization/[^/]+_component\\.cpp",
     {own_folder, "components/mapping/", "framework/kervan.hpp", "framework/component/", "framework/geometry/",
      messages},
     {"components/mapping/map_ports.hpp", "components/mapping/map_maker.hpp"}},
    {"components/localization/.*",
     {own_folder, "components/mapping/", "components/grid/", "framework/geometry/", "framework/component/time.hpp"},
     {"components/mapping/map_ports.hpp", "components/mapping/map_maker.hpp", "framework/geometry/messages.hpp"}},
    // A frontier is worth driving to if a planner would find a way: both ask the same costmap.
    {"components/exploration/frontier_map\\..*",
     {own_folder, "components/planning/costmap.hpp", "components/grid/", "framework/geometry/"},
     {"framework/geometry/messages.hpp", "components/grid/messages.hpp"}},
    // The certainty grid that repels a robot is filled as the mappers fill theirs.
    {"components/control/vff_component\\.cpp",
     {own_folder, "components/mapping/sonar_mapper.hpp", "framework/kervan.hpp", "framework/component/",
      "framework/geometry/", messages}},
    {"components/[^/]+/[^/]+_component\\.cpp",
     {own_folder, "components/grid/", "framework/kervan.hpp", "framework/component/", "framework/geometry/", messages}},
    {"components/planning/grid_planner_shell\\.hpp",
     {own_folder, "components/grid/", "framework/kervan.hpp", "framework/geometry/", messages}},
    // One shell around seven behaviours, each a declaration in its own component; one around the planners, and one
    // around the controllers, two of which show the forces that steer them.
    {"components/(behavior/behaviour_shell|planning/planner_shell|control/(controller_shell|force_display))\\.hpp",
     {own_folder, "framework/kervan.hpp", "framework/component/", "framework/geometry/", messages}},
    // time.hpp is two aliases of std::chrono; an algorithm that takes a time takes it as everybody else does.
    {"components/.*",
     {own_folder, "components/grid/", "framework/geometry/", "framework/component/time.hpp"},
     {"framework/geometry/messages.hpp", "components/grid/messages.hpp"}},

    {"sim/(simulator_component\\.cpp|component/.*)",
     {"sim/", "framework/kervan.hpp", "framework/component/", "framework/geometry/", messages}},
    // Compiled for other processors: whatever inline functions they saw, the whole program might get.
    {"sim/ray_kernel_avx.*\\.cpp", {"sim/ray_kernel.hpp"}},
    // Worlds and robot models are configuration files; the simulator itself takes them as plain values.
    {"sim/files/.*",
     {"sim/", "framework/config/", "framework/map_file/", "framework/component/error.hpp", "framework/geometry/"}},
    {"sim/.*",
     {"sim/", "framework/geometry/", "framework/workers/"},
     {"sim/files/", "framework/geometry/messages.hpp"}},

    // The model knows manifests, not modules, and nothing that runs.
    {"deploy/composition/.*", {own_folder, "framework/component/", "framework/config/", "framework/geometry/"}},
    // A picture of a world needs the world's reader and the drawing of a run's map, the plan of its walls how a world
    // becomes cells: plain libraries all.
    {"deploy/cli/draw\\.cpp",
     {"deploy/", "framework/", "sim/files/world_file.hpp", "components/observe/map_drawing.hpp",
      "components/observe/map_truth.hpp"}},
    {"deploy/cli/(drawn_world|sweep)\\.[ch]pp",
     {"deploy/", "framework/", "sim/files/world_file.hpp", "sim/world.hpp", "components/observe/map_drawing.hpp"}},
    {"deploy/cli/.*", {"deploy/", "framework/", messages}},
    // The supervisor writes what containers read, and reads what they write.
    {"deploy/supervisor/.*", {own_folder, "deploy/container/", "deploy/composition/", "framework/", messages}},
    // What links do to packets is drawn from the simulator's counter-based random numbers.
    {"deploy/lab/link/.*", {own_folder, "deploy/composition/", "framework/", "sim/random.hpp"}},
    // Plans of many runs: what a run left is read and drawn with the library that drew it.
    {"deploy/lab/.*",
     {own_folder, "deploy/composition/", "deploy/supervisor/child_process.hpp", "framework/", "components/observe/"}},
    {"deploy/.*", {own_folder, "deploy/composition/", "framework/", messages}, {"deploy/cli/"}},

    // The generator is a back end of idlc, whose headers begin alike.
    {"idl/.*", {"idl/", "idlc/"}},
    {"tests/.*", {""}},
};

/// Who may use a library: files that fit one of the expressions.
struct Fence {
  const char* include;  ///< how its headers begin
  Strings files;
};

const std::vector<Fence> fences = {
    // Benchmarks and conformance tests compare with plain Cyclone.
    {"dds/", {"framework/dds/.*", "tests/bench/.*", "tests/conformance/.*"}},
    {"idlc/", {"idl/generator/.*"}},
    {"yaml-cpp/", {"framework/config/yaml\\.cpp"}},
    // Whoever logs: what runs components, and components in their handlers.
    {"spdlog/",
     {"framework/runtime/.*", ".*_component\\.cpp", "components/behavior/behaviour_shell\\.hpp",
      "components/planning/grid_planner_shell\\.hpp", "tests/.*"}},
    {"CLI/", {"deploy/cli/main\\.cpp", "tests/experiments/.*"}},
    // Quantiles of distributions; its headers are slow to compile.
    {"boost/", {"deploy/lab/statistics\\.cpp"}},
    {"ompl/", {"components/planning/ompl_.*"}},
    {"png.h", {"framework/map_file/image\\.cpp"}},
    {"emmintrin.h", {"components/mapping/.*_kernel\\..pp"}},
    {"immintrin.h", {"sim/ray_kernel_avx.*\\.cpp"}},
    {"nlohmann/", {"deploy/.*", "tests/.*"}},
    {"gtest/", {"tests/.*"}},
    {"gmock/", {"tests/.*"}},
};

constexpr std::size_t longest_header = 300;
constexpr std::size_t longest_file = 600;
/// Longer all the same, with the reason.
const std::map<std::string, std::string> long_files = {};

bool fits(const std::string& path, const std::string& expression) {
  return std::regex_match(path, std::regex(expression));
}

bool is_message(const std::string& include) {
  static const std::regex message("[a-z0-9_]+/(msg|srv|action)/[A-Za-z0-9_]+\\.hpp");
  return std::regex_match(include, message);
}

/// "components/control/" of "components/control/route_follower.cpp".
std::string folder_of(const std::string& path) {
  const auto first = path.find('/');
  const auto second = path.find('/', first + 1);
  return path.substr(0, (second == std::string::npos ? first : second) + 1);
}

bool any_begins(const Strings& prefixes, const std::string& file, const std::string& include) {
  return std::any_of(prefixes.begin(), prefixes.end(), [&](const std::string& prefix) {
    if (prefix == messages) return is_message(include);
    return include.starts_with(prefix == own_folder ? folder_of(file) : prefix);
  });
}

/// Why `file` may not have `#include "include"`; nothing if it may.
std::optional<std::string> refused(const std::string& file, const std::string& include) {
  if (include.ends_with(".cpp") || include.find("_component.h") != std::string::npos)
    return "nothing includes a component, or any other .cpp";
  const auto arrow = std::find_if(arrows.begin(), arrows.end(), [&](const Arrow& a) { return fits(file, a.files); });
  if (arrow == arrows.end()) return "no arrow is known for this folder";
  if (include.find('/') == std::string::npos) return std::nullopt;  // beside it
  if (any_begins(arrow->may_include, file, include) && !any_begins(arrow->but_not, file, include)) return std::nullopt;
  return "no arrow leads there from " + std::string(arrow->files);
}

/// The same for `#include <include>`.
std::optional<std::string> fenced(const std::string& file, const std::string& include) {
  for (const Fence& fence : fences)
    if (include.starts_with(fence.include) &&
        std::none_of(fence.files.begin(), fence.files.end(), [&](const std::string& f) { return fits(file, f); }))
      return "only these use it: " + fence.files.front() + (fence.files.size() > 1 ? " and others" : "");
  return std::nullopt;
}

bool is_header(const fs::path& file) { return file.extension() == ".hpp" || file.extension() == ".h"; }
bool is_source(const fs::path& file) {
  return is_header(file) || file.extension() == ".cpp" || file.extension() == ".c";
}

/// Paths of all sources, seen from the root.
Strings sources() {
  Strings paths;
  for (const char* folder : {"framework", "components", "sim", "deploy", "idl", "tests"})
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(KERVAN_SOURCES) / folder))
      if (entry.is_regular_file() && is_source(entry.path()))
        paths.push_back(fs::relative(entry.path(), KERVAN_SOURCES).generic_string());
  std::sort(paths.begin(), paths.end());
  return paths;
}

Strings lines_of(const std::string& path) {
  std::ifstream stream(fs::path(KERVAN_SOURCES) / path);
  Strings lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

TEST(Architecture, EveryIncludeFollowsAnArrow) {
  static const std::regex include("\\s*#\\s*include\\s*([<\"])([^>\"]+)[>\"].*");
  std::size_t seen = 0;
  for (const std::string& path : sources()) {
    const Strings lines = lines_of(path);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      std::smatch match;
      if (!std::regex_match(lines[i], match, include)) continue;
      ++seen;
      const std::string name = match[2];
      if (const auto why = match[1] == "\"" ? refused(path, name) : fenced(path, name))
        ADD_FAILURE() << path << ":" << i + 1 << ": " << lines[i] << ": " << *why;
    }
  }
  EXPECT_GT(seen, 500u) << "the sources are not where this test looks";
}

TEST(Architecture, HeadersAreShort) {
  for (const std::string& path : sources())
    if (is_header(path)) {
      EXPECT_LE(lines_of(path).size(), longest_header) << path << ": one concept a header";
    }
}

TEST(Architecture, FilesAreShort) {
  for (const std::string& path : sources())
    if (!long_files.contains(path)) {
      EXPECT_LE(lines_of(path).size(), longest_file) << path;
    }
  for (const auto& [path, reason] : long_files)
    EXPECT_GT(lines_of(path).size(), longest_file) << path << " need not be listed any more";
}

/// The test itself: what it must refuse and what it must allow.
TEST(Arrows, RefuseWhatTheHouseForbids) {
  EXPECT_TRUE(refused("components/control/a.cpp", "components/planning/b.hpp"));
  EXPECT_TRUE(refused("components/control/a_component.cpp", "components/planning/b.hpp"));
  EXPECT_TRUE(refused("components/control/a.cpp", "framework/component/component.hpp"));
  EXPECT_TRUE(refused("components/control/a.cpp", "nav_msgs/msg/Path.hpp"));
  EXPECT_TRUE(refused("components/control/a_component.cpp", "framework/dds/endpoint.hpp"));
  EXPECT_TRUE(refused("framework/runtime/a.cpp", "components/control/b.hpp"));
  EXPECT_TRUE(refused("framework/runtime/a.cpp", "sim/world.hpp"));
  EXPECT_TRUE(refused("framework/component/a.hpp", "framework/runtime/container.hpp"));
  EXPECT_TRUE(refused("framework/runtime/a.cpp", "deploy/composition/load.hpp"));
  EXPECT_TRUE(refused("sim/a.cpp", "framework/config/node.hpp"));
  EXPECT_TRUE(refused("sim/a.cpp", "sim/files/world_file.hpp"));
  EXPECT_TRUE(refused("deploy/composition/a.cpp", "framework/runtime/container.hpp"));
  EXPECT_TRUE(refused("deploy/composition/a.cpp", "deploy/cli/verbs.hpp"));
  EXPECT_TRUE(refused("deploy/container/a.cpp", "deploy/cli/verbs.hpp"));
  EXPECT_TRUE(refused("deploy/container/a.cpp", "deploy/supervisor/supervisor.hpp"));
  EXPECT_TRUE(refused("deploy/supervisor/a.cpp", "deploy/cli/verbs.hpp"));
  EXPECT_TRUE(refused("tests/component/a.cpp", "components/control/potential_field_component.cpp"));
  EXPECT_TRUE(refused("elsewhere/a.cpp", "sim/world.hpp"));
  EXPECT_TRUE(fenced("framework/runtime/a.cpp", "dds/dds.h"));
  EXPECT_TRUE(fenced("components/control/a.cpp", "spdlog/spdlog.h"));
  EXPECT_TRUE(fenced("sim/files/a.cpp", "yaml-cpp/yaml.h"));
}

TEST(Arrows, AllowWhatTheHouseAllows) {
  EXPECT_FALSE(refused("components/control/a.cpp", "components/control/b.hpp"));
  EXPECT_FALSE(refused("components/control/a.cpp", "components/grid/cell.hpp"));
  EXPECT_FALSE(refused("components/control/a.cpp", "framework/geometry/pose2.hpp"));
  EXPECT_FALSE(refused("components/control/a_component.cpp", "nav_msgs/msg/Path.hpp"));
  EXPECT_FALSE(refused("deploy/cli/a.cpp", "deploy/composition/load.hpp"));
  EXPECT_FALSE(refused("deploy/supervisor/a.cpp", "deploy/composition/load.hpp"));
  EXPECT_FALSE(fenced("framework/dds/a.cpp", "dds/dds.h"));
  EXPECT_FALSE(fenced("sim/a.cpp", "vector"));
}

}  // namespace
