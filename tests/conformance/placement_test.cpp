/// Quality of service means the same wherever components run: each case is written once and run in every placement. The
/// page README.md has a table of it, which the last test compares with what is here.
#include "tests/conformance/placement.hpp"

#include <gmock/gmock.h>
#include <signal.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>

namespace kervan::test {

using namespace std::chrono_literals;

namespace {

QosProfile keeping(int depth) {
  QosProfile profile = *builtin_profile("event");
  profile.depth = depth;
  return profile;
}

template <class V>
QosProfile with(QosProfile profile, V QosProfile::*field, V value) {
  profile.*field = std::move(value);
  return profile;
}

const std::map<std::string, CaseQos>& cases() {
  static const std::map<std::string, CaseQos> all = [] {
    std::map<std::string, CaseQos> list;
    list["Order"] = {keeping(0)};
    list["HistoryDepth"] = {keeping(2)};
    list["KeepAllWithALimit"] = {with(keeping(0), &QosProfile::limit, 5)};
    list["TransientLocal"] = {*builtin_profile("latched")};
    list["Deadline"] = {with(keeping(100), &QosProfile::deadline, Duration(50ms))};
    list["Lifespan"] = {with(keeping(100), &QosProfile::lifespan, Duration(200ms))};
    list["LivelinessAutomatic"] = {with(keeping(100), &QosProfile::lease, Duration(2s))};
    list["LivelinessManual"] = {
        with(with(keeping(100), &QosProfile::liveliness, Liveliness::manual), &QosProfile::lease, Duration(100ms))};
    list["Ownership"] = {with(keeping(100), &QosProfile::ownership, Ownership::exclusive)};
    list["Takeover"] = {
        with(with(keeping(100), &QosProfile::ownership, Ownership::exclusive), &QosProfile::deadline, Duration(100ms))};
    list["Partition"] = {with(keeping(100), &QosProfile::partition, std::vector<std::string>{"red"}), {"blue"}};
    list["Dispose"] = {keeping(100)};
    list["LargeSamples"] = {keeping(2)};
    list["SlowReader"] = {keeping(100)};
    return list;
  }();
  return all;
}

std::vector<Got> numbers(const std::string& key, int first, int last) {
  std::vector<Got> all;
  for (int n = first; n <= last; ++n) all.push_back({.key = key, .number = n});
  return all;
}

}  // namespace

CaseQos qos_of(const std::string& name) { return cases().at(name); }

std::ostream& operator<<(std::ostream& out, const Got& got) {
  return out << (got.disposed ? "dispose " : "") << got.key << " " << got.number << " (" << got.bytes << " B)";
}

namespace {

struct SameThread {
  static constexpr Where where = Where::same_thread;
  static constexpr const char* column = "same thread";
};
struct TwoThreads {
  static constexpr Where where = Where::two_threads;
  static constexpr const char* column = "two threads";
};
struct TwoDomains {
  static constexpr Where where = Where::two_domains;
  static constexpr const char* column = "two domains";
};
struct TwoProcesses {
  static constexpr Where where = Where::two_processes;
  static constexpr const char* column = "two processes";
};
struct Lockstep {
  static constexpr Where where = Where::lockstep;
  static constexpr const char* column = "lockstep";
};
using Placements = ::testing::Types<SameThread, TwoThreads, TwoDomains, TwoProcesses, Lockstep>;

struct PlacementNames {
  template <class Here>
  static std::string GetName(int) {
    std::string name = Here::column;
    std::ranges::replace(name, ' ', '_');
    return name;
  }
};

template <class Here>
class QualityOfService : public ::testing::Test {
 protected:
  Placement place_{Here::where, ::testing::UnitTest::GetInstance()->current_test_info()->name()};

  bool received(const std::string& reader, std::uint64_t count) {
    return place_.eventually([&] { return place_.counters(reader).received >= count; });
  }
};
TYPED_TEST_SUITE(QualityOfService, Placements, PlacementNames);

TYPED_TEST(QualityOfService, Order) {
  auto& place = this->place_;
  place.publish("strong", "a", 1, 300);
  ASSERT_TRUE(this->received("sink", 300));
  EXPECT_EQ(place.take("sink"), numbers("a", 1, 300));
  EXPECT_EQ(place.counters("sink").lost, 0u);
}

TYPED_TEST(QualityOfService, HistoryDepth) {
  auto& place = this->place_;
  place.publish("strong", "a", 1, 3);
  place.publish("strong", "b", 1, 1);
  ASSERT_TRUE(this->received("sink", 4));
  EXPECT_EQ(place.take("sink"), (std::vector<Got>{{"a", 2}, {"a", 3}, {"b", 1}}));
  EXPECT_TRUE(place.eventually([&] { return place.counters("sink").overwritten == 1; }));
}

TYPED_TEST(QualityOfService, KeepAllWithALimit) {
  auto& place = this->place_;
  std::vector<Got> served;
  for (int n = 1; n <= 8; ++n) {
    place.publish("strong", "a", n);  // fails if it blocks
    ASSERT_TRUE(place.eventually([&] {
      for (const Got& got : place.take("other")) served.push_back(got);
      return served.size() == static_cast<std::size_t>(n);
    }));
  }
  EXPECT_EQ(served, numbers("a", 1, 8));
  EXPECT_TRUE(place.eventually([&] { return place.counters("sink").refused == 3; }));
  EXPECT_EQ(place.take("sink"), numbers("a", 1, 5));
  EXPECT_EQ(place.counters("other").refused, 0u);
}

TYPED_TEST(QualityOfService, TransientLocal) {
  auto& place = this->place_;
  place.publish("strong", "a", 1, 3);
  place.publish("strong", "b", 7, 1);
  ASSERT_TRUE(this->received("sink", 4));
  EXPECT_THAT(place.late_joiner_takes(2), ::testing::UnorderedElementsAre(Got{"a", 3}, Got{"b", 7}));
}

TYPED_TEST(QualityOfService, Deadline) {
  auto& place = this->place_;
  place.publish("strong", "a", 1);
  EXPECT_TRUE(place.eventually([&] { return place.counters("sink").deadline_missed >= 3; }));
  EXPECT_EQ(place.take("sink"), numbers("a", 1, 1)) << "a missed deadline takes nothing away";
}

TYPED_TEST(QualityOfService, Lifespan) {
  auto& place = this->place_;
  place.publish("strong", "a", 1, 3);
  ASSERT_TRUE(this->received("sink", 3));
  place.pass(250ms);
  EXPECT_EQ(place.take("sink"), std::vector<Got>{});
  EXPECT_TRUE(place.eventually([&] { return place.counters("sink").expired == 3; }));
  EXPECT_EQ(place.living("sink"), std::vector<std::string>{});
}

TYPED_TEST(QualityOfService, LivelinessAutomatic) {
  auto& place = this->place_;
  place.publish("strong", "a", 1);
  ASSERT_TRUE(this->received("sink", 1));
  place.pass(2500ms);  // longer than the lease: the writer is silent, but its process is alive
  EXPECT_EQ(place.counters("sink").liveliness_lost, 0u);
  EXPECT_EQ(place.living("sink"), std::vector<std::string>{"a"});
}

TYPED_TEST(QualityOfService, LivelinessManual) {
  auto& place = this->place_;
  for (const unsigned losses : {1U, 2U}) {
    place.publish("strong", "a", 1);
    EXPECT_TRUE(place.eventually([&] { return place.counters("sink").liveliness_lost == losses; }))
        << place.counters("sink").liveliness_lost;
  }
}

TYPED_TEST(QualityOfService, Ownership) {
  auto& place = this->place_;
  place.publish("weak", "a", 1);
  ASSERT_TRUE(this->received("sink", 1));
  place.publish("strong", "a", 2);
  ASSERT_TRUE(this->received("sink", 2));
  place.publish("weak", "a", 3);
  place.publish("weak", "b", 4);
  ASSERT_TRUE(this->received("sink", 4));
  EXPECT_EQ(place.take("sink"), (std::vector<Got>{{"a", 1}, {"a", 2}, {"b", 4}})) << "ownership is of an instance";
  EXPECT_EQ(place.counters("sink").not_owner, 1u);
}

TYPED_TEST(QualityOfService, Takeover) {
  auto& place = this->place_;
  place.publish("strong", "a", 1);
  ASSERT_TRUE(this->received("sink", 1));
  EXPECT_EQ(place.take("sink"), numbers("a", 1, 1));
  int next = 1;
  // The strong one is silent, so before long what the weak one says counts.
  std::vector<Got> got;
  EXPECT_TRUE(place.eventually([&] {
    place.publish("weak", "a", ++next);
    got = place.take("sink");
    return !got.empty();
  }));
  place.publish("strong", "a", 1000);
  EXPECT_TRUE(place.eventually([&] {
    got = place.take("sink");
    return std::ranges::count(got, Got{"a", 1000}) == 1;
  }));
}

TYPED_TEST(QualityOfService, Partition) {
  auto& place = this->place_;
  place.publish("strong", "a", 1, 5);
  ASSERT_TRUE(this->received("other", 5));
  EXPECT_EQ(place.take("other"), numbers("a", 1, 5));
  EXPECT_EQ(place.take("sink"), std::vector<Got>{});
  EXPECT_EQ(place.counters("sink").received, 0u);
}

TYPED_TEST(QualityOfService, Dispose) {
  auto& place = this->place_;
  place.publish("strong", "a", 1);
  place.publish("strong", "b", 2);
  place.dispose("strong", "a");
  ASSERT_TRUE(this->received("sink", 3));
  EXPECT_TRUE(place.eventually([&] { return place.living("sink") == std::vector<std::string>{"b"}; }));
  EXPECT_EQ(place.take("sink"), (std::vector<Got>{{"a", 1}, {"b", 2}, {.key = "a", .disposed = true}}));
}

TYPED_TEST(QualityOfService, LargeSamples) {
  constexpr std::size_t size = 5'000'000;
  auto& place = this->place_;
  place.publish("strong", "a", 1, 2, size);
  ASSERT_TRUE(this->received("sink", 2));
  EXPECT_EQ(place.take("sink"), (std::vector<Got>{{"a", 1, size}, {"a", 2, size}}));
}

TYPED_TEST(QualityOfService, SlowReader) {
  auto& place = this->place_;
  std::vector<Got> served;
  for (int chunk = 0; chunk < 10; ++chunk) {
    place.publish("strong", "a", 1 + 50 * chunk, 50);
    ASSERT_TRUE(place.eventually([&] {
      for (const Got& got : place.take("other")) served.push_back(got);
      return served.size() == static_cast<std::size_t>(50 * (chunk + 1));
    }));
  }
  EXPECT_EQ(served, numbers("a", 1, 500)) << "one reader does not suffer from another";
  ASSERT_TRUE(this->received("sink", 500));
  EXPECT_EQ(place.take("sink"), numbers("a", 401, 500));
  EXPECT_TRUE(place.eventually([&] { return place.counters("sink").overwritten == 400; }));
}

/// The rows of the table in README.md, as in "| `Order` | yes | … |": label and cells.
std::map<std::string, std::vector<std::string>> rows_of_the_page() {
  std::map<std::string, std::vector<std::string>> rows;
  std::ifstream page(std::string(KERVAN_SOURCE) + "/README.md");
  for (std::string line; std::getline(page, line);) {
    if (!line.starts_with("| `")) continue;
    std::istringstream cells(line.substr(1));
    std::vector<std::string> row;
    for (std::string cell; std::getline(cells, cell, '|');) row.push_back(cell.substr(1, cell.find_last_not_of(' ')));
    const std::string name = row.front().substr(1, row.front().size() - 2);
    if (cases().contains(name)) rows[name] = row;
  }
  return rows;
}

TEST(ReadMe, ItsTableSaysWhatThisSuiteRuns) {
  constexpr std::size_t columns =
      std::tuple_size_v<std::tuple<SameThread, TwoThreads, TwoDomains, TwoProcesses, Lockstep>>;
  std::map<std::string, std::size_t> run;  // by case: in how many placements
  const ::testing::UnitTest& suite = *::testing::UnitTest::GetInstance();
  for (int i = 0; i < suite.total_test_suite_count(); ++i) {
    const ::testing::TestSuite& here = *suite.GetTestSuite(i);
    if (!std::string(here.name()).starts_with("QualityOfService/")) continue;
    for (int j = 0; j < here.total_test_count(); ++j) ++run[here.GetTestInfo(j)->name()];
  }
  const auto rows = rows_of_the_page();
  ASSERT_EQ(run.size(), cases().size());
  for (const auto& [name, placements] : run) {
    EXPECT_EQ(placements, columns) << name;
    const auto row = rows.find(name);
    if (row == rows.end()) {
      ADD_FAILURE() << "README.md has no row `" << name << "`";
      continue;
    }
    // The case's name, what is compared, and a cell for each placement.
    ASSERT_GE(row->second.size(), 2 + columns) << name;
    for (std::size_t column = 2; column < 2 + columns; ++column) EXPECT_EQ(row->second[column], "yes") << name;
  }
}

class Watchdog final : public ::testing::EmptyTestEventListener {
  void OnTestStart(const ::testing::TestInfo&) override { alarm(110); }
};

}  // namespace
}  // namespace kervan::test

int main(int argc, char** argv) {
  if (argc == 5 && std::string(argv[1]) == "--peer") {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    alarm(110);
    return kervan::test::run_placement_peer(argv[2], static_cast<std::uint32_t>(std::stoul(argv[3])), argv[4]);
  }
  ::testing::InitGoogleTest(&argc, argv);
  ::testing::UnitTest::GetInstance()->listeners().Append(new kervan::test::Watchdog);
  return RUN_ALL_TESTS();
}
