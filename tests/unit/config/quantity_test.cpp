// Numbers with units.
#include "framework/config/quantity.hpp"

#include <gtest/gtest.h>

#include <numbers>

using namespace kervan::config;

namespace {

double value(const std::string& text, const std::string& unit) {
  const auto parsed = parse_quantity(text, unit);
  if (const auto* trouble = std::get_if<std::string>(&parsed)) ADD_FAILURE() << *trouble;
  return std::holds_alternative<double>(parsed) ? std::get<double>(parsed) : -1e300;
}

std::string trouble(const std::string& text, const std::string& unit) {
  const auto parsed = parse_quantity(text, unit);
  return std::holds_alternative<std::string>(parsed) ? std::get<std::string>(parsed) : "accepted";
}

TEST(Quantity, IsConvertedToSiUnits) {
  EXPECT_DOUBLE_EQ(value("50ms", "s"), 0.05);
  EXPECT_DOUBLE_EQ(value("2Hz", "Hz"), 2.0);
  EXPECT_DOUBLE_EQ(value("30deg", "rad"), std::numbers::pi / 6);
  EXPECT_DOUBLE_EQ(value("0.05 m", "m"), 0.05);
  EXPECT_DOUBLE_EQ(value("5 cm", "m"), 0.05);
  EXPECT_DOUBLE_EQ(value("1.5 m/s", "m/s"), 1.5);
  EXPECT_DOUBLE_EQ(value("36 km/h", "m/s"), 10.0);
  EXPECT_DOUBLE_EQ(value("20 rad/s", "rad/s"), 20.0);
  EXPECT_DOUBLE_EQ(value("0.3 m/s2", "m/s2"), 0.3);
  EXPECT_DOUBLE_EQ(value("0.3 m/s^2", "m/s2"), 0.3);
  EXPECT_DOUBLE_EQ(value("-1e-3 m", "m"), -0.001);
  EXPECT_DOUBLE_EQ(value("+.5 m", "m"), 0.5);
}

TEST(Quantity, WithoutADimensionIsAPlainNumber) {
  EXPECT_DOUBLE_EQ(value("0.5", ""), 0.5);
  EXPECT_EQ(trouble("0.5 m", ""), "'0.5 m' has a unit, but this is a plain number; write 0.5");
  EXPECT_EQ(trouble("half", ""), "'half' is not a number");
  EXPECT_EQ(trouble("1_000", ""), "'1_000' is not a number");
  EXPECT_EQ(trouble("1,5", ""), "'1,5' is not a number");
}

TEST(Quantity, MustCarryAUnitOfItsDimension) {
  EXPECT_EQ(trouble("0.5", "m"), "0.5 has no unit; write e.g. 0.5 m");
  EXPECT_EQ(trouble("0.5 kg", "m"), "0.5 kg is not a length; allowed units: m, cm, mm, km");
  EXPECT_EQ(trouble("2Hz", "s"), "2Hz is not a time; allowed units: s, ms, us, ns, min");
  EXPECT_EQ(trouble("0.3 m/s", "m/s2"), "0.3 m/s is not an acceleration; allowed units: m/s2, cm/s2, mm/s2");
  EXPECT_EQ(trouble("soon", "s"), "'soon' is not a time; write a number and a unit, e.g. 1 s");
}

TEST(Quantity, InAUnitOutsideTheTableIsWrittenAsItIs) {
  EXPECT_DOUBLE_EQ(value("3 rad/m", "rad/m"), 3.0);
  EXPECT_EQ(trouble("3 deg/m", "rad/m"), "3 deg/m is not a quantity in this unit; allowed units: rad/m");
}

TEST(Quantity, RefusesNumbersThatReadDifferentlyElsewhere) {
  EXPECT_EQ(trouble("010 m", "m"), "'010' begins with a zero, which some read as octal; write it without");
  EXPECT_EQ(trouble("0x10 m", "m"), "0x10 m is not a length; allowed units: m, cm, mm, km");
  EXPECT_EQ(trouble(".inf", ""), "'.inf' is not a number");
  EXPECT_EQ(trouble("nan", ""), "'nan' is not a number");
  EXPECT_EQ(trouble("1e999 m", "m"), "1e999 is too large or too small for a number");
}

}  // namespace
