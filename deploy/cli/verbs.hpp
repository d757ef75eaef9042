/// What the command line asks for, one function a verb. Each returns the program's exit code; main.cpp parses the
/// arguments and turns errors into one line and a code.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace kervan::cli {

/// The exit codes of every verb.
enum ExitCode : int {
  exit_good = 0,
  exit_found = 1,     ///< the check found something, the mission failed
  exit_unusable = 2,  ///< wrong usage or configuration; nothing was done
  exit_interrupt = 130,
  exit_terminated = 143,
};

struct CompositionRequest {
  std::string composition;             ///< a name or a file
  std::vector<std::string> arguments;  ///< "name=value"
  std::vector<std::string> settings;   ///< "component.params.name=value"
  std::vector<std::string> place;      ///< "all", "each" or "container=component,component"
  std::string host;                    ///< which of the composition's hosts this is; empty: not said
  bool emulate_hosts = false;          ///< this machine plays all of them
  bool json = false;
};

struct RunRequest : CompositionRequest {
  std::string time_limit;  ///< "60s"; empty for none
  std::string threads;     ///< "4"; empty: as the composition says
  std::string snapshots;   ///< "5s"; empty: as the composition says
  std::string runs_folder = "runs";
  std::string run_folder;  ///< of this run; empty: a new one in runs_folder
};

struct SweepRequest {
  std::string file;  ///< a name or a file
  std::string out;   ///< folder; empty: sweeps/NAME
  std::string jobs;  ///< "4"; empty: as many as there are cores
  bool json = false;
};

struct CheckRequest : CompositionRequest {
  std::string explain;  ///< a topic; empty for the whole matrix
};

struct DescribeRequest {
  std::string component;  ///< empty for the list of all
  bool json = false;
  bool markdown = false;  ///< the section of its page; needs a component
};

/// Something asked of a container that runs: `kervan container set brain r1/control speed="0.4 m/s"`.
struct ContainerAsk {
  std::string verb;                     ///< list, state, load, unload, activate, deactivate, set, snapshot or call
  std::string container;                ///< empty for list
  std::string component;                ///< may be empty for state and snapshot
  std::string type;                     ///< load
  std::string request;                  ///< call
  std::vector<std::string> parameters;  ///< load, set, call: "name=value"
  std::vector<std::string> ports;       ///< load: "port=/topic"
  std::string log_level;                ///< load
  std::string run;                      ///< the folder of the run; empty: the newest that is not over
  std::string runs_folder = "runs";     ///< where runs are
  std::string domain;                   ///< instead of a run
  std::string interface = "lo";
  std::string tag;
  std::string timeout = "5s";
  bool json = false;
};

/// A link between two network namespaces: `kervan link 1234 1235 --loss "10 %"`.
struct LinkRequest {
  std::string a, b;                             ///< a process, a path or a name of `ip netns`
  std::string profile;                          ///< empty: no effects but those of `settings`
  std::map<std::string, std::string> settings;  ///< as LinkSettings describes them
  std::vector<std::string> down;                ///< "10s..15s"
  std::string interface = "link0";              ///< at both ends
  std::string address_a = "10.77.0.1", address_b = "10.77.0.2";
  std::string seed = "1";
  std::string time_limit;  ///< empty: until it is told to end
  bool netem = false;
  bool json = false;
};

struct DrawRequest {
  std::string world;  ///< a name or a file
  std::string out;    ///< the picture's file; empty: <name>.svg
  std::string plan;   ///< not empty: no picture, but the world's walls as a map of map_server, in this file
};

struct SystemdRequest : CompositionRequest {
  std::string out;  ///< folder for the units; empty: systemd-<composition>
};

int run(const RunRequest& request);
int sweep(const SweepRequest& request);
int check(const CheckRequest& request);
int describe(const DescribeRequest& request);
int draw(const DrawRequest& request);
int systemd(const SystemdRequest& request);
int container(const ContainerAsk& ask);
int link(const LinkRequest& request);

}  // namespace kervan::cli
