#include "framework/runtime/log.hpp"

#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <utility>

#include "framework/component/sample.hpp"
#include "framework/dds/endpoint.hpp"
#include "framework/dds/type_support.hpp"
#include "framework/geometry/messages.hpp"
#include "rcl_interfaces/msg/Log.hpp"

namespace kervan::runtime {

namespace {

thread_local Time log_time{};

/// `%*` in a pattern: the composition's time in seconds.
class TimeFlag final : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg&, const std::tm&, spdlog::memory_buf_t& out) override {
    const std::string text = fmt::format("{:10.3f}", seconds(log_time));
    out.append(text.data(), text.data() + text.size());
  }
  std::unique_ptr<custom_flag_formatter> clone() const override { return std::make_unique<TimeFlag>(); }
};

void use_pattern(spdlog::sinks::sink& sink, const std::string& pattern) {
  auto formatter = std::make_unique<spdlog::pattern_formatter>();
  formatter->add_flag<TimeFlag>('*').set_pattern(pattern);
  sink.set_formatter(std::move(formatter));
}

class RosoutSink final : public spdlog::sinks::base_sink<std::mutex> {
 public:
  explicit RosoutSink(dds::Domain& domain)
      : writer_(domain, "/rosout", type_support<rcl_interfaces::msg::Log>(), profile(), dds::CyclonePart::whole_profile,
                0, dds::kInternal) {}

 private:
  static QosProfile profile() {
    // What ROS 2's own /rosout offers, so that its tools match it.
    return {.name = "rosout", .durability = Durability::transient_local, .depth = 100, .trace = false};
  }

  void sink_it_(const spdlog::details::log_msg& line) override {
    namespace level = rcl_interfaces::msg::Log_Constants;
    dds::SampleBlock* block = writer_.loan(true);
    auto& message = *static_cast<rcl_interfaces::msg::Log*>(dds::mutable_value_of(block));
    message.stamp = geometry::to_message(log_time);
    message.level = line.level <= spdlog::level::debug  ? level::DEBUG
                    : line.level == spdlog::level::info ? level::INFO
                    : line.level == spdlog::level::warn ? level::WARN
                    : line.level == spdlog::level::err  ? level::ERROR
                                                        : level::FATAL;
    message.name.assign(line.logger_name.data(), line.logger_name.size());
    message.msg.assign(line.payload.data(), line.payload.size());
    if (line.source.filename) message.file = line.source.filename;
    if (line.source.funcname) message.function = line.source.funcname;
    message.line = static_cast<std::uint32_t>(line.source.line);
    writer_.publish(block, log_time, false);
  }
  void flush_() override {}

  dds::Writer writer_;
};

}  // namespace

LogTime::LogTime(Time now) : outer_(std::exchange(log_time, now)) {}
LogTime::~LogTime() { log_time = outer_; }

LogSinks::LogSinks(bool console, const std::filesystem::path& file, dds::Domain* rosout) {
  if (console) {
    auto sink = std::make_shared<spdlog::sinks::stderr_color_sink_mt>();
    sink->set_level(spdlog::level::warn);
    // A progress line may stand on the terminal; a log line takes its place.
    use_pattern(*sink, std::string(isatty(STDERR_FILENO) ? "\r\033[K" : "") + "%^%l%$ [%* %n] %v");
    sinks_.push_back(std::move(sink));
  }
  if (!file.empty()) {
    auto sink = std::make_shared<spdlog::sinks::basic_file_sink_mt>(file.string());
    use_pattern(*sink, "%* %l [%n] %v");
    sinks_.push_back(std::move(sink));
  }
  if (rosout) sinks_.push_back(std::make_shared<RosoutSink>(*rosout));
}

LogSinks::~LogSinks() = default;

std::shared_ptr<spdlog::logger> LogSinks::make(const std::string& name, const std::string& level) const {
  auto logger = std::make_shared<spdlog::logger>(name, sinks_.begin(), sinks_.end());
  logger->set_level(spdlog::level::from_str(level));
  logger->flush_on(spdlog::level::warn);  // what went wrong is in the file even if the process does not live on
  return logger;
}

}  // namespace kervan::runtime
