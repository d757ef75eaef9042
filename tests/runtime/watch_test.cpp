/// What is wrong between ports of several containers is named on both sides, and withdrawn when it is over.
#include <gmock/gmock.h>
#include <unistd.h>

#include <map>
#include <mutex>
#include <optional>

#include "builtin_interfaces/msg/Duration.hpp"
#include "builtin_interfaces/msg/Time.hpp"
#include "framework/component/sample.hpp"
#include "framework/dds/discovery.hpp"
#include "framework/kervan.hpp"
#include "framework/runtime/status.hpp"
#include "framework/runtime/trouble.hpp"
#include "framework/test/harness.hpp"
#include "kervan_msgs/msg/ComponentStatus.hpp"
#include "tests/runtime/containers.hpp"

namespace {

using namespace std::chrono_literals;
using builtin_interfaces::msg::Time;
using kervan::PortDirection;
using kervan::runtime::RunPhase;
using kervan::test::binding;
using kervan::test::Composition;
using kervan::test::eventually;
using kervan::test::Running;
using ::testing::HasSubstr;

class Talker final : public kervan::Component {
  kervan::Output<Time> out_{this, "out", kervan::qos::event, "Numbers."};
  kervan::Timer tick_{this, 10ms, &Talker::on_tick};
  void on_tick(kervan::Time) { out_.publish(Time{}); }
};

class Listener final : public kervan::Component {
  kervan::Input<Time> in_{this, "in", kervan::qos::event, &Listener::on_message, "Numbers."};
  void on_message(const Time&, kervan::Time) {}
};

class OfAnotherType final : public kervan::Component {
  kervan::Input<builtin_interfaces::msg::Duration> in_{this, "in", kervan::qos::event, "Durations."};
};

const auto talker = kervan::test::define<Talker>("test/talker");
const auto listener = kervan::test::define<Listener>("test/listener");
const auto of_another_type = kervan::test::define<OfAnotherType>("test/of_another_type");

kervan::QosProfile event() { return *kervan::builtin_profile("event"); }
kervan::QosProfile best_effort() {
  kervan::QosProfile profile = event();
  profile.reliability = kervan::Reliability::best_effort;
  return profile;
}
kervan::runtime::PortBinding out(const kervan::QosProfile& profile) {
  return binding<Time>("out", PortDirection::output, "/numbers", profile);
}
kervan::runtime::PortBinding in(const kervan::QosProfile& profile) {
  return binding<Time>("in", PortDirection::input, "/numbers", profile);
}

/// As this process is named among peers.
std::string here() {
  char host[256] = {};
  gethostname(host, sizeof host - 1);
  return " (pid " + std::to_string(getpid()) + " on " + host + ")";
}

std::string trouble_of_input(Running& running, const std::string& component) {
  return running.container().find(component)->inputs().front()->health().trouble();
}
std::string trouble_of_output(Running& running, const std::string& component) {
  return running.container().find(component)->outputs().front()->health().trouble();
}

TEST(Watch, QualityOfServiceThatDoesNotFitIsNamedOnBothSides) {
  Composition composition({"left", "right"});
  composition.add("left", "talker", talker, {out(best_effort())});
  composition.add("right", "listener", listener, {in(event())});
  Running left(composition.spec("left"), composition.registry());
  Running right(composition.spec("right"), composition.registry());

  const std::string at_left = "incompatible with reader listener.in of container 'right'" + here() +
                              ": reliability offered best_effort, requested reliable";
  const std::string at_right = "incompatible with writer talker.out of container 'left'" + here() +
                               ": reliability offered best_effort, requested reliable";
  EXPECT_TRUE(eventually([&] { return trouble_of_output(left, "talker") == at_left; }))
      << trouble_of_output(left, "talker");
  EXPECT_TRUE(eventually([&] { return trouble_of_input(right, "listener") == at_right; }))
      << trouble_of_input(right, "listener");
  EXPECT_TRUE(eventually([&] { return !left.log().empty() && !right.log().empty(); }));
  EXPECT_THAT(left.log(), HasSubstr(" warning [talker] out on /numbers: " + at_left + "\n"));
  EXPECT_THAT(right.log(), HasSubstr(" warning [listener] in on /numbers: " + at_right + "\n"));
}

TEST(Watch, ATopicThatMeetsAnotherTypeIsNamedOnBothSides) {
  Composition composition({"left", "right"});
  composition.add("left", "talker", talker, {out(event())});
  composition.add("right", "other", of_another_type,
                  {binding<builtin_interfaces::msg::Duration>("in", PortDirection::input, "/numbers", event())});
  Running left(composition.spec("left"), composition.registry());
  Running right(composition.spec("right"), composition.registry());

  const std::string at_left = "reader other.in of container 'right'" + here() +
                              " has type builtin_interfaces::msg::Duration, this port builtin_interfaces::msg::Time";
  const std::string at_right = "writer talker.out of container 'left'" + here() +
                               " has type builtin_interfaces::msg::Time, this port builtin_interfaces::msg::Duration";
  EXPECT_TRUE(eventually([&] { return trouble_of_output(left, "talker") == at_left; }))
      << trouble_of_output(left, "talker");
  EXPECT_TRUE(eventually([&] { return trouble_of_input(right, "other") == at_right; }))
      << trouble_of_input(right, "other");
}

TEST(Watch, AnotherLayoutOfTheSameTypeIsNamed) {
  Composition composition({"main"});
  composition.add("main", "listener", listener, {in(event())});
  Running main(composition.spec("main"), composition.registry());
  ASSERT_TRUE(eventually([&] { return main.has_reached(RunPhase::active); }));

  kervan::TypeSupport other = kervan::type_support<Time>();
  other.layout_hash ^= 1;
  kervan::dds::DomainConfig config = composition.spec("elsewhere").domain;
  config.user_data = kervan::dds::to_user_data({"elsewhere", 1});
  kervan::dds::Domain domain(config);
  {
    const kervan::dds::Writer writer(domain, "/numbers", other, event(), kervan::dds::CyclonePart::whole_profile, 0,
                                     kervan::dds::kInternal);
    const std::string sentence = "writer of container 'elsewhere'" + here() +
                                 " was built with another layout of builtin_interfaces::msg::Time; rebuild both "
                                 "against the same IDL package";
    EXPECT_TRUE(eventually([&] { return trouble_of_input(main, "listener") == sentence; }))
        << trouble_of_input(main, "listener");
  }
  EXPECT_TRUE(eventually([&] { return trouble_of_input(main, "listener").empty(); }));
}

TEST(Watch, APeerThatIsMissingIsNamedUntilItIsBack) {
  Composition composition({"left", "right"});
  composition.add("left", "talker", talker, {out(event())});
  composition.add("right", "listener", listener, {in(event())});
  Running left(composition.spec("left"), composition.registry());
  const std::string gone = "no match with reader listener.in of container 'right': it is not there";
  {
    Running right(composition.spec("right"), composition.registry());
    ASSERT_TRUE(eventually([&] { return left.has_reached(RunPhase::active); }));
    EXPECT_EQ(trouble_of_output(left, "talker"), "");
  }
  EXPECT_TRUE(eventually([&] { return trouble_of_output(left, "talker") == gone; }))
      << trouble_of_output(left, "talker");
  EXPECT_THAT(left.log(), HasSubstr(" warning [talker] out on /numbers: " + gone + "\n"));

  Running right(composition.spec("right"), composition.registry());
  EXPECT_TRUE(eventually([&] { return trouble_of_output(left, "talker").empty(); }));
  EXPECT_TRUE(eventually([&] { return left.log().find("over: " + gone + "\n") != std::string::npos; }));
}

/// Keeps the newest status of a component, as anybody on the network gets it.
class StatusReader final : public kervan::dds::SampleSink {
 public:
  explicit StatusReader(kervan::dds::Domain& domain)
      : reader_(domain, kervan::runtime::kStatusTopic, kervan::type_support<kervan_msgs::msg::ComponentStatus>(),
                kervan::runtime::status_profile(), kervan::dds::CyclonePart::whole_profile, *this) {}

  kervan_msgs::msg::ComponentStatus of(const std::string& component) const {
    const std::lock_guard lock(mutex_);
    const auto found = statuses_.find(component);
    return found == statuses_.end() ? kervan_msgs::msg::ComponentStatus{} : found->second;
  }
  void on_sample(const kervan::dds::Arrival& arrival) noexcept override {
    const auto& status = *static_cast<const kervan_msgs::msg::ComponentStatus*>(kervan::dds::value_of(arrival.block));
    const std::lock_guard lock(mutex_);
    statuses_[status.component] = status;
  }
  void on_writer_gone(std::uint64_t) noexcept override {}
  void on_status() noexcept override {}

 private:
  mutable std::mutex mutex_;
  std::map<std::string, kervan_msgs::msg::ComponentStatus> statuses_;
  kervan::dds::Reader reader_;  // last: it calls into the members above
};

TEST(Watch, TheStatusTellsTroublesAndCounters) {
  Composition composition({"left", "right"});
  composition.add("left", "talker", talker, {out(event())});
  composition.add("right", "listener", listener, {in(event())});
  kervan::dds::Domain domain(composition.spec("viewer").domain);
  const StatusReader statuses(domain);
  Running left(composition.spec("left"), composition.registry());
  auto right = std::make_optional<Running>(composition.spec("right"), composition.registry());

  // Both go on for as long as they run: what is counted, and that it is told again and again.
  EXPECT_TRUE(eventually([&] {
    const auto status = statuses.of("listener");
    return !status.ports.empty() && status.ports[0].handled >= 20 && status.ports[0].worst_latency > 0.0;
  }));
  EXPECT_EQ(statuses.of("listener").ports[0].lost, 0u);
  EXPECT_EQ(statuses.of("listener").ports[0].output, false);
  right.reset();
  EXPECT_TRUE(eventually([&] {
    const auto status = statuses.of("talker");
    return !status.ports.empty() && status.ports[0].output && status.ports[0].published > 0 &&
           status.ports[0].trouble == "no match with reader listener.in of container 'right': it is not there";
  }));
}

TEST(Watch, AParticipantSaysWhichContainerItIs) {
  const kervan::dds::ParticipantIdentity identity{"brain", 0x12ab};
  EXPECT_EQ(kervan::dds::to_user_data(identity), "enclave=/;kc=brain;kh=00000000000012ab;");
  const auto parsed = kervan::dds::parse_participant("enclave=/;kc=brain;kh=00000000000012ab;");
  ASSERT_TRUE(parsed);
  EXPECT_EQ(parsed->container, "brain");
  EXPECT_EQ(parsed->composition, 0x12abu);
  for (const char* foreign : {"", "enclave=/;", "kc=brain;", "kc=brain;kh=;", "kc=brain;kh=12xy;"})
    EXPECT_FALSE(kervan::dds::parse_participant(foreign)) << foreign;
}

TEST(Watch, LinesThatDifferInNumbersOnlyAreAlike) {
  using kervan::runtime::shape_of;
  EXPECT_EQ(shape_of("writer 1a:2b:3c:1 #17: no space"), shape_of("writer ff:2:3:c1 #9: no space"));
  EXPECT_NE(shape_of("no space left"), shape_of("no time left"));
}

}  // namespace
