#include "deploy/lab/results.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

#include "deploy/lab/experiment_file.hpp"
#include "deploy/lab/tables.hpp"

using namespace kervan::lab;

namespace {

/// Two floors, two arms, three seeds; points, whether it arrived, and a trace.
Results results(const std::string& table, const std::string& more = "") {
  Results results;
  results.experiment = parse_experiment(
      "kervan_sweep: 1\nname: s\ncomposition: lab\n"
      "matrix: {floor: [1, 2], arm: [paper, ours], seed: 1..3}\n"
      "responses: {points: {figure: p, unit: '1'}, arrived: a, trace: t}\n" +
          table + more,
      "s.yaml", ".");
  results.cells = cells(results.experiment);
  for (const Cell& cell : results.cells) {
    const auto [floor, arm, seed] = std::tuple(cell.levels[0], cell.levels[1], cell.levels[2]);
    const double points =
        10.0 * static_cast<double>(floor + 1) * static_cast<double>(arm + 1) + static_cast<double>(seed);
    results.records.push_back({RunState::done, "", 0, {}});
    results.values.push_back({points, arm == 1, arm == 0 ? "aa" : "b" + std::to_string(seed)});
  }
  return results;
}

Results with_a_failure(Results results) {
  results.records[0] = {RunState::failed, "SIGSEGV, \"alas\"", 0, {}};
  results.values[0].clear();
  return results;
}

const char* const by_both = "table: {rows: [floor, arm]}\n";

TEST(Groups, AreInTheOrderOfThePlan) {
  const auto groups = grouped(results(by_both), {"arm", "floor"});
  ASSERT_EQ(groups.size(), 4u);
  EXPECT_EQ(groups[1].labels, (std::vector<std::string>{"paper", "2"}));
  EXPECT_EQ(groups[1].cells, (std::vector<std::size_t>{6, 7, 8}));
}

TEST(Groups, LeaveOutWhatFailed) {
  const Results some = with_a_failure(results(by_both));
  const Summary summary = summary_of(some, grouped(some, {"floor", "arm"})[0].cells, 0);
  EXPECT_EQ(summary.n, 2u);
  EXPECT_DOUBLE_EQ(summary.estimate->value, 11.5);
}

TEST(MarkdownTable, HasAColumnForEachResponse) {
  EXPECT_EQ(table_markdown(results(by_both)),
            "| floor | arm | runs | points (1) | arrived | trace |\n"
            "|---|---|---|---|---|---|\n"
            "| 1 | paper | 3 | 11.0 [8.5, 13.5] | 0 of 3 [0, 56] % | aa |\n"
            "| 1 | ours | 3 | 21.0 [18.5, 23.5] | 3 of 3 [44, 100] % | 3 different |\n"
            "| 2 | paper | 3 | 21.0 [18.5, 23.5] | 0 of 3 [0, 56] % | aa |\n"
            "| 2 | ours | 3 | 41.0 [38.5, 43.5] | 3 of 3 [44, 100] % | 3 different |\n");
}

TEST(MarkdownTable, HasRowsAgainstColumns) {
  EXPECT_EQ(table_markdown(results("table: {rows: [floor], columns: [arm], responses: [points]}\n")),
            "**points (1)** by arm, n = 3\n"
            "\n"
            "| floor | paper | ours |\n"
            "|---|---|---|\n"
            "| 1 | 11.0 [8.5, 13.5] | 21.0 [18.5, 23.5] |\n"
            "| 2 | 21.0 [18.5, 23.5] | 41.0 [38.5, 43.5] |\n");
}

TEST(MarkdownTable, SaysBesideEachValueHowManyRunsItIsOfIfTheyDiffer) {
  EXPECT_EQ(table_markdown(with_a_failure(results("table: {rows: [floor], columns: [arm], responses: [trace]}\n"))),
            "**trace** by arm\n"
            "\n"
            "| floor | paper | ours |\n"
            "|---|---|---|\n"
            "| 1 | aa, n = 2 | 3 different, n = 3 |\n"
            "| 2 | aa, n = 3 | 3 different, n = 3 |\n");
}

TEST(CsvTable, HasARowForEachRunAndQuotesWhatNeedsIt) {
  const std::string csv = runs_csv(with_a_failure(results(by_both)));
  EXPECT_TRUE(
      csv.starts_with("floor,arm,seed,points (1),arrived,trace,state,reason,folder\n"
                      "1,paper,1,,,,failed,\"SIGSEGV, \"\"alas\"\"\",\"runs/floor=1,arm=paper,seed=1\"\n"
                      "1,paper,2,11,no,aa,done,,\"runs/floor=1,arm=paper,seed=2\"\n"))
      << csv;
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 13);
}

TEST(CsvTable, HasARowForEachGroupAndResponse) {
  const std::string csv = table_csv(results("table: {rows: [floor], columns: [arm], responses: [arrived, trace]}\n"));
  EXPECT_TRUE(
      csv.starts_with("floor,arm,response,unit,kind,n,value,low,high\n"
                      "1,paper,arrived,,share,3,0,0,0.56149"))
      << csv;
  EXPECT_NE(csv.find("1,paper,trace,,text,3,aa,,\n"), std::string::npos) << csv;
}

TEST(Differences, AreOfRunsThatAreEqualInAllElse) {
  const Results all = results(by_both, "compare: {factor: arm, to: paper, responses: [points]}\n");
  const Differences found = differences(all);
  EXPECT_EQ(found.by, (std::vector<std::string>{"floor"}));
  ASSERT_EQ(found.all.size(), 3u);
  EXPECT_EQ(found.all[0].difference.value, 10.0);
  EXPECT_EQ(found.all[0].difference.low, 10.0) << "each seed's difference is the same, though the seeds differ";
  EXPECT_NEAR(*found.all[0].ratio, 21.0 / 11.0, 1e-12);
  EXPECT_TRUE(found.all[0].significant());
  EXPECT_TRUE(found.all[2].group.empty());
  EXPECT_EQ(found.all[2].difference.n, 6u);
  EXPECT_EQ(differences_markdown(all),
            "| floor | arm | response | pairs | difference | ratio | significant |\n"
            "|---|---|---|---|---|---|---|\n"
            "| 1 | ours | points (1) | 3 | 10 | 1.91 | yes |\n"
            "| 2 | ours | points (1) | 3 | 20 | 1.95 | yes |\n"
            "| all | ours | points (1) | 6 | 15.0 [9.3, 20.7] | 1.94 | yes |\n");
}

TEST(Differences, LeaveOutPairsOfWhichOneFailed) {
  const Results some =
      with_a_failure(results(by_both, "compare: {factor: arm, to: paper, responses: [points, arrived]}\n"));
  const Differences found = differences(some);
  EXPECT_EQ(found.all[0].difference.n, 2u);
  EXPECT_EQ(found.all[1].difference.value, 1.0) << "so counts as 1";
  EXPECT_FALSE(found.all[1].ratio) << "nothing can be divided by 0";
}

TEST(Differences, ThatMayBeNothingAreNotSignificant) {
  Results all = results(by_both, "compare: {factor: arm, to: paper, responses: [points]}\n");
  for (std::size_t seed = 0; seed < 3; ++seed)
    all.values[3 + seed][0] = std::get<double>(all.values[seed][0]) + (seed == 1 ? -1.0 : 1.0);
  EXPECT_FALSE(differences(all).all[0].significant());
}

TEST(Texts, HaveAsManyDigitsAsTheIntervalIsWorth) {
  EXPECT_EQ(estimate_text({0.29612, 0.29112, 0.30112, 20}), "0.2961 [0.2911, 0.3011]");
  EXPECT_EQ(estimate_text({1235.2, 1000.0, 1469.0, 3}), "1235 [1000, 1469]");
  EXPECT_EQ(estimate_text({0.123456, 0.123456, 0.123456, 1}), "0.1235");
  EXPECT_EQ(estimate_text({49.0, 49.0, 49.0, 5}), "49");
  EXPECT_EQ(estimate_text({-0.001, -0.5, 0.5, 5}), "0.00 [-0.50, 0.50]");
  EXPECT_EQ(estimate_text({-10.3, -20.4, -0.2, 3}), "-10.3 [-20.4, -0.2]") << "it leaves out 0";
}

}  // namespace
