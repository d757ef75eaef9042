#include "deploy/container/mission_listener.hpp"

#include <string>

#include "framework/component/component.hpp"

namespace kervan::container {
namespace {

using kervan_msgs::msg::MissionResult;

class MissionListener final : public Component {
  Input<MissionResult> result_{this, "result", qos::latched, &MissionListener::on_result, "How the mission ended."};
  void on_result(const MissionResult& result, Time) { heard = result; }

 public:
  std::optional<MissionResult> heard;
};

}  // namespace

void add_mission_listener(ComponentRegistry& registry) {
  registry.add({kMissionListener.data(), "Hears how the mission ended.",
                []() -> std::unique_ptr<Component> { return std::make_unique<MissionListener>(); }});
}

std::optional<MissionResult> mission_result(runtime::Container& container) {
  const runtime::ComponentInstance* instance = container.find(std::string(kMissionListener));
  if (!instance) return std::nullopt;
  const auto* listener = dynamic_cast<const MissionListener*>(&instance->component());
  return listener ? listener->heard : std::nullopt;
}

}  // namespace kervan::container
