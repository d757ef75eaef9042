#include "tests/bench/reference.hpp"

#include <dds/dds.h>
#include <sys/resource.h>

#include <atomic>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "bench_msgs/msg/Payload.h"
#include "tests/bench/statistics.hpp"

namespace kervan::bench {

namespace {

dds_entity_t checked(dds_entity_t entity) {
  if (entity < 0) {
    std::fprintf(stderr, "reference: %s\n", dds_strretcode(-entity));
    std::exit(1);
  }
  return entity;
}

/// A domain without a network, reliable and keep last 1, as the `state` profile has it.
struct Participant {
  dds_entity_t domain = checked(dds_create_domain(220, "<General><Transport>none</Transport></General>"));
  dds_entity_t participant = checked(dds_create_participant(220, nullptr, nullptr));
  dds_qos_t* qos = dds_create_qos();

  Participant() {
    dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
    dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 1);
  }
  ~Participant() {
    dds_delete_qos(qos);
    dds_delete(domain);
  }
  dds_entity_t topic(const std::string& name) const {
    return checked(dds_create_topic(participant, &bench_msgs_msg_Payload_desc, name.c_str(), nullptr, nullptr));
  }
};

/// Declared before its Participant: the reader looks once more when its writer is deleted with the domain.
struct Receiver {
  bench_msgs_msg_Payload sample{};
  std::int64_t received = 0;
  ~Receiver() { dds_free(sample.data._buffer); }
};

void on_data(dds_entity_t reader, void* argument) {
  auto& receiver = *static_cast<Receiver*>(argument);
  void* samples[1] = {&receiver.sample};
  dds_sample_info_t info[1];
  while (dds_take(reader, samples, info, 1, 1) > 0) receiver.received = now_ns();
}

}  // namespace

std::vector<std::int64_t> raw_c_hops(std::size_t bytes, std::size_t count) {
  Receiver receiver;
  const Participant dds;
  const dds_entity_t topic = dds.topic("hop");
  dds_listener_t* listener = dds_create_listener(&receiver);
  dds_lset_data_available(listener, on_data);
  checked(dds_create_reader(dds.participant, topic, dds.qos, listener));
  dds_delete_listener(listener);
  const dds_entity_t writer = checked(dds_create_writer(dds.participant, topic, dds.qos, nullptr));
  std::vector<std::uint8_t> data(bytes);
  bench_msgs_msg_Payload message{};
  message.data._buffer = data.data();
  message.data._length = message.data._maximum = static_cast<std::uint32_t>(bytes);
  std::vector<std::int64_t> hops;
  hops.reserve(count);
  for (std::size_t i = 0; i < count + count / 10; ++i) {
    ++message.number;
    message.stamp = now_ns();
    dds_write(writer, &message);
    if (i >= count / 10) hops.push_back(receiver.received - message.stamp);
  }
  return hops;
}

std::vector<std::int64_t> queue_hops(std::size_t count) {
  struct Message {
    std::int64_t stamp;
    unsigned char data[64];
  };
  std::mutex mutex;
  std::condition_variable arrived;
  std::deque<std::unique_ptr<Message>> queue;
  std::vector<std::int64_t> hops;
  hops.reserve(count);
  std::thread consumer([&] {
    while (hops.size() < count) {
      std::unique_lock lock(mutex);
      arrived.wait(lock, [&] { return !queue.empty(); });
      const std::unique_ptr<Message> message = std::move(queue.front());
      queue.pop_front();
      lock.unlock();
      hops.push_back(now_ns() - message->stamp);
    }
  });
  for (std::size_t i = 0; i < count; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    auto message = std::make_unique<Message>();
    message->stamp = now_ns();
    {
      const std::lock_guard lock(mutex);
      queue.push_back(std::move(message));
    }
    arrived.notify_one();
  }
  consumer.join();
  return hops;
}

std::vector<std::int64_t> raw_c_cross_thread_hops(std::size_t count) {
  struct Wake {
    std::mutex mutex;
    std::condition_variable arrived;
    bool ready = false;
  } wake;
  Receiver receiver;
  const Participant dds;
  const dds_entity_t topic = dds.topic("cross");
  dds_listener_t* listener = dds_create_listener(&wake);
  dds_lset_data_available(listener, [](dds_entity_t, void* argument) {
    auto& sleeper = *static_cast<Wake*>(argument);
    {
      const std::lock_guard lock(sleeper.mutex);
      sleeper.ready = true;
    }
    sleeper.arrived.notify_one();
  });
  const dds_entity_t reader = checked(dds_create_reader(dds.participant, topic, dds.qos, listener));
  dds_delete_listener(listener);
  const dds_entity_t writer = checked(dds_create_writer(dds.participant, topic, dds.qos, nullptr));
  std::vector<std::int64_t> hops;
  hops.reserve(count);
  std::atomic<bool> done{false};
  std::thread consumer([&] {
    while (hops.size() < count) {
      {
        std::unique_lock lock(wake.mutex);
        wake.arrived.wait(lock, [&] { return wake.ready; });
        wake.ready = false;
      }
      void* samples[1] = {&receiver.sample};
      dds_sample_info_t info[1];
      while (hops.size() < count && dds_take(reader, samples, info, 1, 1) > 0)
        hops.push_back(now_ns() - receiver.sample.stamp);
    }
    done = true;
  });
  std::vector<std::uint8_t> data(64);
  bench_msgs_msg_Payload message{};
  message.data._buffer = data.data();
  message.data._length = message.data._maximum = 64;
  while (!done) {  // a newer sample may have pushed one out, so more than `count` may be needed
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    message.stamp = now_ns();
    dds_write(writer, &message);
  }
  consumer.join();
  return hops;
}

double raw_c_chain_cpu(int hops, double seconds) {
  const Participant dds;
  std::vector<dds_entity_t> writers, readers;
  const dds_entity_t waitset = checked(dds_create_waitset(dds.participant));
  for (int i = 0; i < hops; ++i) {
    const dds_entity_t topic = dds.topic("chain" + std::to_string(i));
    writers.push_back(checked(dds_create_writer(dds.participant, topic, dds.qos, nullptr)));
    readers.push_back(checked(dds_create_reader(dds.participant, topic, dds.qos, nullptr)));
    dds_set_status_mask(readers.back(), DDS_DATA_AVAILABLE_STATUS);
    checked(dds_waitset_attach(waitset, readers.back(), i));
  }
  std::vector<std::uint8_t> data(64);
  bench_msgs_msg_Payload message{};
  message.data._buffer = data.data();
  message.data._length = message.data._maximum = 64;
  bench_msgs_msg_Payload taken{};
  rusage before{}, after{};
  getrusage(RUSAGE_SELF, &before);
  const std::int64_t start = now_ns();
  std::int64_t next = start;
  while (now_ns() - start < static_cast<std::int64_t>(seconds * 1e9)) {
    if (now_ns() >= next) {
      next += 1'000'000;
      dds_write(writers[0], &message);
    }
    dds_attach_t triggered[16];
    const dds_return_t n = dds_waitset_wait(waitset, triggered, 16, std::max<std::int64_t>(0, next - now_ns()));
    for (dds_return_t k = 0; k < n; ++k) {
      void* samples[1] = {&taken};
      dds_sample_info_t info[1];
      const auto i = static_cast<std::size_t>(triggered[k]);
      while (dds_take(readers[i], samples, info, 1, 1) > 0)
        if (i + 1 < writers.size()) dds_write(writers[i + 1], &taken);
    }
  }
  getrusage(RUSAGE_SELF, &after);
  dds_free(taken.data._buffer);
  const auto cpu = [](const rusage& u) {
    return static_cast<double>(u.ru_utime.tv_sec + u.ru_stime.tv_sec) +
           static_cast<double>(u.ru_utime.tv_usec + u.ru_stime.tv_usec) * 1e-6;
  };
  return cpu(after) - cpu(before);
}

}  // namespace kervan::bench
