/// Components out of modules: what two of them share, and what they must not disagree about.
#include <gtest/gtest.h>

#include "framework/dds/statistics.hpp"
#include "framework/runtime/container.hpp"
#include "sensor_msgs/msg/LaserScan.hpp"

namespace {

using namespace std::chrono_literals;
using sensor_msgs::msg::LaserScan;

/// The folder of the modules that were built for these tests alone.
kervan::ComponentRegistry test_modules() { return kervan::ComponentRegistry({KERVAN_TEST_MODULES}); }

TEST(Modules, ThatShareATypeHandEachOtherTheVerySameObjects) {
  kervan::ComponentRegistry registry = test_modules();
  kervan::runtime::ContainerSpec spec;
  spec.clock = kervan::runtime::ClockMode::lockstep;
  spec.domain = {.id = 210, .network = false};
  spec.log_to_console = false;
  spec.components.push_back({.name = "talker", .type = "test/talker"});
  spec.components.push_back({.name = "listener", .type = "test/listener"});
  kervan::runtime::Container container(spec, registry);
  const auto before = kervan::dds::data_path_statistics();
  const auto report = container.run({.limit = 10s});
  const auto after = kervan::dds::data_path_statistics();
  EXPECT_EQ(report.end, kervan::runtime::RunEnd::finished);
  EXPECT_EQ(report.reason, "100 of 100 are the same object");
  EXPECT_EQ(after.serialised, before.serialised);
  EXPECT_EQ(after.deserialised, before.deserialised);
}

TEST(Modules, ThatWereBuiltWithTwoLayoutsOfATypeAreRefused) {
  kervan::TypeSupport other = kervan::type_support<LaserScan>();
  other.layout_hash ^= 1;
  kervan::dds::Domain domain({.id = 211, .network = false});
  domain.topic("/scan", kervan::type_support<LaserScan>());
  for (const char* topic : {"/scan", "/other_scan"}) {
    try {
      domain.topic(topic, other);
      ADD_FAILURE() << "no error for " << topic;
    } catch (const kervan::dds::DdsError& error) {
      EXPECT_STREQ(error.what(),
                   "two modules of this container were built with different layouts of sensor_msgs::msg::LaserScan; "
                   "rebuild them against the same IDL package");
    }
  }
}

TEST(Modules, AreRefusedWhenTheyAreNoneOrHoldAnotherComponent) {
  kervan::ComponentRegistry registry = test_modules();
  EXPECT_EQ(registry.find("test/nobody"), nullptr);
  for (const char* name : {"test/misnamed", "test/no_component", "test/no_module"}) {
    try {
      registry.find(name);
      ADD_FAILURE() << name << " was loaded";
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
    }
  }
}

}  // namespace
