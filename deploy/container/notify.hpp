/// Tells the service manager how the process is, in the protocol of systemd's sd_notify(3): one datagram to the socket
/// that the environment names. Without such a manager it does nothing.
#pragma once

#include <string>

#include "framework/component/time.hpp"

namespace kervan::container {

class ServiceManager {
 public:
  /// Reads NOTIFY_SOCKET, WATCHDOG_USEC and WATCHDOG_PID.
  ServiceManager();
  ~ServiceManager();
  ServiceManager(const ServiceManager&) = delete;
  ServiceManager& operator=(const ServiceManager&) = delete;

  /// "READY=1", "STATUS=…", "STOPPING=1", "WATCHDOG=1"; several, one a line.
  void say(const std::string& text) const;

  /// How long the manager waits between two WATCHDOG=1 before it ends the process; `forever` if it does not watch.
  Duration watchdog() const { return watchdog_; }

 private:
  int socket_ = -1;
  std::string address_;
  Duration watchdog_ = forever;
};

}  // namespace kervan::container
