#include "deploy/lab/responses.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

using namespace kervan;
using namespace kervan::lab;

namespace {

const char* const summary =
    R"({"result": "failed", "robots": {"r1": {"reached": false, "time_s": 12.5, "min_clearance_m": null}},)"
    R"( "trace_hash": "00ff", "figures": {"r1/map": {"p99.5": 3}}, "containers": [{"pid": 1}]})";

Response response(const std::string& figure) { return {.name = "x", .figure = figure, .location = {"s.yaml", 3, 4}}; }

Value value(const std::string& figure) { return values_in({response(figure)}, summary).values.front(); }

TEST(Responses, AreFiguresOfTheSummary) {
  EXPECT_EQ(value("robots.r1.time_s"), Value(12.5));
  EXPECT_EQ(value("robots.r1.reached"), Value(false));
  EXPECT_EQ(value("trace_hash"), Value("00ff"));
  EXPECT_EQ(value("figures.r1/map.p99.5"), Value(3.0)) << "a key may hold dots";
}

TEST(Responses, AreNothingWhereThereIsNoFigure) {
  EXPECT_EQ(value("robots.r1.min_clearance_m"), Value()) << "it was never measured";
  EXPECT_EQ(value("robots.r2.time_s"), Value());
  EXPECT_EQ(value("robots.r1"), Value()) << "many figures are none";
  EXPECT_TRUE(values_in({response("robots.r1.min_clearance_m")}, summary).absent.empty());
  EXPECT_EQ(values_in({response("robots.r1")}, summary).absent.size(), 1u);
}

TEST(Responses, MayBeWhetherATextIsThis) {
  Response success = response("result");
  success.is = "success";
  EXPECT_EQ(values_in({success}, summary).values.front(), Value(false));
  success.is = "failed";
  EXPECT_EQ(values_in({success}, summary).values.front(), Value(true));
}

TEST(Responses, ThatTheRunsLackAreNamedAtTheirPlace) {
  const auto refusal = [](const std::vector<Response>& responses) -> std::string {
    try {
      require_figures(responses, values_in(responses, summary));
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal({response("robots.r1.tiem_s")}),
            "s.yaml:3:4: the runs have no figure 'robots.r1.tiem_s'; did you mean 'robots.r1.time_s'? they have: "
            "figures.r1/map.p99.5, result, robots.r1.min_clearance_m, robots.r1.reached, robots.r1.time_s, trace_hash");
  Response optional = response("robots.r1.tiem_s");
  optional.optional = true;
  EXPECT_EQ(refusal({optional, response("robots.r1.min_clearance_m")}), "");
}

TEST(Responses, NeedASummary) {
  EXPECT_THROW(values_in({}, ""), std::runtime_error);
  EXPECT_THROW(values_in({}, "{\"result\": "), std::runtime_error);
  EXPECT_THROW(values_in({}, "[1]"), std::runtime_error);
}

TEST(Responses, AreWrittenAsShortAsTheyCanBeReadBack) {
  EXPECT_EQ(to_text(Value(0.1)), "0.1");
  EXPECT_EQ(to_text(Value(1.0)), "1");
  EXPECT_EQ(to_text(Value(true)), "yes");
  EXPECT_EQ(to_text(Value("a, b")), "a, b");
  EXPECT_EQ(to_text(Value()), "");
}

}  // namespace
