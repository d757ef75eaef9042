#include "deploy/supervisor/systemd_units.hpp"

#include <algorithm>
#include <cstdio>

#include "deploy/container/spec_json.hpp"
#include "framework/component/error.hpp"

namespace kervan::supervisor {

namespace {

/// "30s", "100ms"
std::string time_text(Duration duration) {
  const auto ms = std::chrono::ceil<std::chrono::milliseconds>(duration).count();
  return ms % 1000 == 0 ? std::to_string(ms / 1000) + "s" : std::to_string(ms) + "ms";
}

const char* to_text(composition::RestartPolicy policy) {
  switch (policy) {
    case composition::RestartPolicy::never: return "no";
    case composition::RestartPolicy::on_failure: return "on-failure";
    case composition::RestartPolicy::always: return "always";
  }
  return "no";
}

/// A word of a unit file: % begins a specifier and $ a variable there, and blanks end a word.
std::string word(const std::filesystem::path& path) {
  std::string text = "\"";
  for (const char c : path.string()) {
    if (c == '%' || c == '$') text += c;
    if (c == '"' || c == '\\') text += '\\';
    text += c;
  }
  return text + '"';
}

std::string state_name(const std::string& composition, const std::string& container) {
  return "kervan-" + composition + "-" + container;
}

/// What a container needs is its network, its state folder and nothing else.
constexpr const char* kSandbox = R"(
DynamicUser=yes
UMask=0077
NoNewPrivileges=yes
CapabilityBoundingSet=
AmbientCapabilities=
ProtectSystem=strict
ProtectHome=read-only
ProtectProc=invisible
ProcSubset=pid
PrivateTmp=yes
PrivateDevices=yes
PrivateUsers=yes
ProtectClock=yes
ProtectControlGroups=yes
ProtectHostname=yes
ProtectKernelLogs=yes
ProtectKernelModules=yes
ProtectKernelTunables=yes
LockPersonality=yes
MemoryDenyWriteExecute=yes
RestrictNamespaces=yes
RestrictRealtime=yes
RestrictSUIDSGID=yes
RestrictAddressFamilies=AF_INET AF_INET6 AF_NETLINK AF_UNIX
RemoveIPC=yes
KeyringMode=private
SystemCallArchitectures=native
SystemCallFilter=@system-service
SystemCallFilter=~@privileged @resources
SystemCallErrorNumber=EPERM
)";

std::string unit(const UnitPlan& plan, const UnitOptions& options) {
  const std::string& container = plan.spec.name;
  const std::string specification = unit_name(options.composition, container) + ".json";
  std::string text = "# Made by kervan systemd from the composition " + options.composition + ".\n[Unit]\n";
  text += "Description=Kervan: container " + container + " of " + options.composition + "\n";
  text +=
      "PartOf=kervan-" + options.composition + ".target\nWants=network-online.target\nAfter=network-online.target\n";
  text += "StartLimitIntervalSec=" + time_text(plan.restart.window) + "\n";
  text += "StartLimitBurst=" + std::to_string(plan.restart.max) + "\n";
  text += "\n[Service]\nType=notify\nNotifyAccess=main\n";
  text += "WatchdogSec=" + time_text(kUnitWatchdog) + "\n";
  text += std::string("Restart=") + to_text(plan.restart.policy) + "\n";
  text += "RestartSec=" + time_text(plan.restart.backoff) + "\n";
  // It waits for the other containers, however long they take.
  text += "TimeoutStartSec=infinity\nTimeoutStopSec=3s\nKillMode=mixed\n";
  text += "StateDirectory=" + state_name(options.composition, container) + "\n";
  text += "LoadCredential=specification:" + (options.folder / specification).string() + "\n";
  if (!options.modules.empty()) {
    std::string path;
    for (const auto& folder : options.modules) path += (path.empty() ? "" : ":") + folder.string();
    text += "Environment=" + word("KERVAN_COMPONENT_PATH=" + path) + "\n";
  }
  text += "ExecStart=" + word(options.program) + " \"%d/specification\" " + word(container) + "\n";
  text += kSandbox;
  text += "\n[Install]\nWantedBy=kervan-" + options.composition + ".target\n";
  return text;
}

std::string target(const std::vector<UnitPlan>& plans, const UnitOptions& options) {
  std::string text = "# Made by kervan systemd from the composition " + options.composition +
                     ".\n[Unit]\nDescription=Kervan: all containers of " + options.composition + " on this host\n";
  for (const UnitPlan& plan : plans) text += "Wants=" + unit_name(options.composition, plan.spec.name) + "\n";
  return text + "\n[Install]\nWantedBy=multi-user.target\n";
}

}  // namespace

std::string unit_name(const std::string& composition, const std::string& container) {
  return state_name(composition, container) + ".service";
}

std::map<std::string, std::string> systemd_units(const std::vector<UnitPlan>& plans, const UnitOptions& options) {
  std::map<std::string, std::string> files;
  for (const UnitPlan& plan : plans) {
    const std::string name = unit_name(options.composition, plan.spec.name);
    runtime::ContainerSpec spec = plan.spec;
    // The user is made for the unit, and the folder with it.
    spec.run_folder = "/var/lib/" + state_name(options.composition, spec.name);
    files[name] = unit(plan, options);
    files[name + ".json"] = container::to_json(spec);
  }
  files["kervan-" + options.composition + ".target"] = target(plans, options);
  return files;
}

}  // namespace kervan::supervisor
