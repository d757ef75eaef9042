// The rules by which kervan check and discovery judge endpoints, beside the verdict of Cyclone DDS itself: pairs of a
// writer and a reader in a domain without network, each policy through all its values, then many policies at once.
#include "framework/component/qos_match.hpp"

#include <dds/dds.h>
#include <gtest/gtest.h>

#include <memory>
#include <random>

#include "RosLaserScan.h"
#include "framework/dds/endpoint_qos.hpp"

namespace {

using namespace std::chrono_literals;
using kervan::EndpointQos;
using kervan::forever;

/// What Cyclone says of a pair: 0 if it matches, else the number of the policy that stands against it.
class Cyclone {
 public:
  Cyclone()
      : domain_(dds_create_domain(211, "<General><Transport>none</Transport></General>")),
        participant_(dds_create_participant(211, nullptr, nullptr)),
        topic_(dds_create_topic(participant_, &sensor_msgs_msg_dds__LaserScan__desc, "pairs", nullptr, nullptr)) {
    EXPECT_GT(topic_, 0) << dds_strretcode(-topic_);
  }
  Cyclone(const Cyclone&) = delete;
  Cyclone& operator=(const Cyclone&) = delete;
  ~Cyclone() { dds_delete(domain_); }

  std::uint32_t verdict(const EndpointQos& offered, const EndpointQos& requested) {
    const dds_entity_t writer = dds_create_writer(participant_, topic_, cyclone(offered).get(), nullptr);
    const dds_entity_t reader = dds_create_reader(participant_, topic_, cyclone(requested).get(), nullptr);
    EXPECT_GT(writer, 0) << dds_strretcode(-writer);
    EXPECT_GT(reader, 0) << dds_strretcode(-reader);
    dds_set_status_mask(reader, DDS_SUBSCRIPTION_MATCHED_STATUS | DDS_REQUESTED_INCOMPATIBLE_QOS_STATUS);
    const dds_entity_t waitset = dds_create_waitset(participant_);
    dds_waitset_attach(waitset, reader, 0);
    EXPECT_GT(dds_waitset_wait(waitset, nullptr, 0, DDS_SECS(20)), 0) << "Cyclone says nothing at all";
    dds_requested_incompatible_qos_status_t incompatible{};
    dds_subscription_matched_status_t matched{};
    dds_get_requested_incompatible_qos_status(reader, &incompatible);
    dds_get_subscription_matched_status(reader, &matched);
    EXPECT_EQ(matched.current_count + incompatible.total_count, 1u);
    for (const dds_entity_t entity : {waitset, reader, writer}) dds_delete(entity);
    return matched.current_count == 1 ? 0 : incompatible.last_policy_id;
  }

 private:
  using Qos = std::unique_ptr<dds_qos_t, void (*)(dds_qos_t*)>;
  static Qos cyclone(const EndpointQos& qos) {
    Qos handle(dds_create_qos(), dds_delete_qos);
    kervan::dds::set_endpoint_qos(handle.get(), qos);
    EXPECT_EQ(kervan::dds::endpoint_qos(handle.get()), qos) << "what was set reads back as something else";
    return handle;
  }

  dds_entity_t domain_, participant_, topic_;
};

std::string described(const EndpointQos& offered, const EndpointQos& requested) {
  std::string text;
  for (const auto& conflict : kervan::qos_conflicts(offered, requested)) text += conflict.sentence + "; ";
  return text.empty() ? "no conflict" : text;
}

std::uint32_t our_verdict(const EndpointQos& offered, const EndpointQos& requested) {
  const auto conflicts = kervan::qos_conflicts(offered, requested);
  return conflicts.empty() ? 0 : static_cast<std::uint32_t>(conflicts.front().policy);
}

const std::vector<kervan::Duration> times = {0ns, 1us, 100ms, 2s, forever};
const std::vector<kervan::Duration> leases = {100ms, 2s, forever};
const std::vector<std::vector<std::string>> partitions = {
    {}, {""}, {"r1"}, {"r2"}, {"r1", "r2"}, {"r*"}, {"r1/x"}, {"*"}, {"?1"}, {"r*x", "r1"}, {"r**/?"}, {"*1*"}};

/// One function a policy: sets the i-th of its values and says how many there are.
using Choice = std::size_t (*)(EndpointQos&, std::size_t);
const std::vector<Choice> choices = {
    [](EndpointQos& q, std::size_t i) {
      return q.reliability = static_cast<kervan::Reliability>(i % 2), std::size_t{2};
    },
    [](EndpointQos& q, std::size_t i) {
      return q.durability = static_cast<kervan::DurabilityKind>(i % 4), std::size_t{4};
    },
    [](EndpointQos& q, std::size_t i) { return q.deadline = times[i % times.size()], times.size(); },
    [](EndpointQos& q, std::size_t i) { return q.latency_budget = times[i % times.size()], times.size(); },
    [](EndpointQos& q, std::size_t i) { return q.ownership = static_cast<kervan::Ownership>(i % 2), std::size_t{2}; },
    [](EndpointQos& q, std::size_t i) {
      q.liveliness = static_cast<kervan::LivelinessKind>(i % 3);
      return q.lease = leases[i / 3 % leases.size()], 3 * leases.size();
    },
    [](EndpointQos& q, std::size_t i) {
      return q.destination_order = static_cast<kervan::DestinationOrder>(i % 2), std::size_t{2};
    },
    [](EndpointQos& q, std::size_t i) {
      q.access_scope = static_cast<kervan::AccessScope>(i % 3);
      q.coherent_access = i / 3 % 2;
      return q.ordered_access = i / 6 % 2, std::size_t{12};
    },
    [](EndpointQos& q, std::size_t i) { return q.partition = partitions[i % partitions.size()], partitions.size(); },
    [](EndpointQos& q, std::size_t i) {
      using enum kervan::Representation;
      const std::vector<kervan::Representation> all[] = {{xcdr1}, {xcdr2}, {xcdr1, xcdr2}, {xcdr2, xcdr1}};
      return q.representations = all[i % 4], std::size_t{4};
    },
};

TEST(QosMatch, AgreesWithCycloneOnEveryPairOfValuesOfEveryPolicy) {
  Cyclone cyclone;
  std::size_t pairs = 0;
  for (const Choice& choose : choices) {
    EndpointQos offered, requested;
    const std::size_t count = choose(offered, 0);
    for (std::size_t w = 0; w < count; ++w)
      for (std::size_t r = 0; r < count; ++r, ++pairs) {
        choose(offered, w);
        choose(requested, r);
        ASSERT_EQ(cyclone.verdict(offered, requested), our_verdict(offered, requested))
            << described(offered, requested);
      }
  }
  EXPECT_GT(pairs, 400u);
}

TEST(QosMatch, AgreesWithCycloneOnPairsThatDifferInManyPolicies) {
  Cyclone cyclone;
  std::mt19937 random(1);
  std::size_t matched = 0;
  constexpr int pairs = 3000;
  for (int pair = 0; pair < pairs; ++pair) {
    EndpointQos offered, requested;
    // Some policies differ, the others are equal: if all differed, hardly any pair would match.
    for (const Choice& choose : choices) {
      const std::size_t value = random();
      choose(offered, value);
      choose(requested, random() % 4 == 0 ? random() : value);
    }
    const std::uint32_t verdict = our_verdict(offered, requested);
    ASSERT_EQ(cyclone.verdict(offered, requested), verdict) << "pair " << pair << ": " << described(offered, requested);
    matched += verdict == 0;
  }
  EXPECT_GT(matched, 300u);
  EXPECT_LT(matched, 2700u);
}

TEST(QosMatch, SaysWhoOffersAndWhoRequestsWhat) {
  EndpointQos offered, requested;
  requested.reliability = kervan::Reliability::reliable;
  requested.deadline = 100ms;
  requested.lease = 1s;
  offered.partition = {"r1", "r2"};
  offered.representations = {kervan::Representation::xcdr2};
  std::vector<std::string> sentences;
  for (const auto& conflict : kervan::qos_conflicts(offered, requested)) sentences.push_back(conflict.sentence);
  EXPECT_EQ(
      sentences,
      (std::vector<std::string>{
          "the reader requests reliability reliable, the writer offers best_effort",
          "the reader requests deadline 100 ms or shorter, the writer offers none",
          "the reader requests liveliness automatic, lease 1 s or shorter, the writer offers automatic, lease none",
          "the reader requests partition none, the writer offers [r1, r2]",
          "the reader requests data representation xcdr1, the writer offers xcdr2"}));
}

TEST(QosMatch, ReadersOfAProfileMatchItsWritersWhateverItIs) {
  for (const kervan::QosProfile& profile : kervan::builtin_profiles())
    EXPECT_TRUE(kervan::qos_conflicts(kervan::offered_qos(profile), kervan::requested_qos(profile)).empty());
  const kervan::QosProfile all{.durability = kervan::Durability::transient_local,
                               .deadline = 1s,
                               .liveliness = kervan::Liveliness::manual,
                               .lease = 1s,
                               .ownership = kervan::Ownership::exclusive,
                               .partition = {"r1"},
                               .network = kervan::Network::async};
  EXPECT_TRUE(kervan::qos_conflicts(kervan::offered_qos(all), kervan::requested_qos(all)).empty());
  const kervan::QosProfile pattern{.partition = {"r*"}};
  EXPECT_EQ(kervan::qos_conflicts(kervan::offered_qos(pattern), kervan::requested_qos(pattern)).size(), 1u);
}

TEST(Partitions, PatternsOfOthersCostBoundedTime) {
  std::string pattern, name(4000, 'a');
  for (int i = 0; i < 500; ++i) pattern += "*a";
  EXPECT_FALSE(kervan::partitions_meet({pattern + "b"}, {name}));
  EXPECT_TRUE(kervan::partitions_meet({pattern}, {name}));
}

}  // namespace
