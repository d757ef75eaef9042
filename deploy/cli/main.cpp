// The kervan program: parses the command line, calls the verb, and turns what goes wrong into one line on stderr.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>

#include "deploy/cli/print_json.hpp"
#include "deploy/cli/verbs.hpp"
#include "deploy/composition/links.hpp"
#include "framework/component/error.hpp"
#include "framework/config/node.hpp"

using namespace kervan;

namespace {

const std::vector<std::string> verbs = {"run", "sweep", "check", "describe", "draw", "container", "systemd", "link"};

const CLI::Validator not_empty([](const std::string& text) { return text.empty() ? "the value is empty" : ""; }, "");

/// The options that run and check share.
void add_composition(CLI::App& verb, cli::CompositionRequest& request) {
  verb.add_option("composition", request.composition, "name of a shipped composition, or a file")
      ->type_name("NAME|FILE")
      ->required();
  verb.add_option("--arg", request.arguments, "value of one of the composition's arguments; may be repeated")
      ->type_name("NAME=VALUE")
      ->check(not_empty)
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  verb.add_option("--set", request.settings, "value of a component's parameter, over the file's; may be repeated")
      ->type_name("COMPONENT.params.NAME=VALUE")
      ->check(not_empty)
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  verb.add_option(
          "--place", request.place,
          "where components go: 'all' in one container, 'each' in its own, or these in that one; may be repeated")
      ->type_name("all|each|CONTAINER=COMPONENT,...")
      ->check(not_empty)
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  verb.add_flag("--json", request.json, "print the result as one JSON object, on the last line");
  CLI::Option* host = verb.add_option("--host", request.host, "which of the composition's hosts this is")
                          ->type_name("NAME")
                          ->check(not_empty);
  verb.add_flag(
          "--emulate-hosts", request.emulate_hosts,
          "this machine plays all hosts of the composition, each with a network of its own, joined as 'links' says")
      ->excludes(host);
}

/// `kervan container`: one subcommand for each thing that can be asked.
void add_container(CLI::App& verb, cli::ContainerAsk& ask) {
  verb.require_subcommand(1);
  const auto add = [&](const char* name, const char* help) {
    CLI::App* asked = verb.add_subcommand(name, help);
    asked->add_option("--run", ask.run, "folder of the run; else the newest one that is not over")
        ->check(not_empty)
        ->type_name("DIR");
    asked->add_option("--runs", ask.runs_folder, "folder that holds the runs")
        ->capture_default_str()
        ->check(not_empty)
        ->type_name("DIR");
    asked->add_option("--domain", ask.domain, "DDS domain to ask in, instead of that of a run")
        ->check(not_empty)
        ->type_name("ID")
        ->excludes("--run");
    asked->add_option("--interface", ask.interface, "network interface, with --domain")
        ->capture_default_str()
        ->check(not_empty)
        ->needs("--domain");
    asked->add_option("--tag", ask.tag, "tag of the run, with --domain")->check(not_empty)->needs("--domain");
    asked->add_option("--timeout", ask.timeout, "how long to wait for the answer")
        ->capture_default_str()
        ->check(not_empty)
        ->type_name("TIME");
    asked->add_flag("--json", ask.json, "print the answer as one JSON object");
    asked->callback([&ask, name] { ask.verb = name; });
    return asked;
  };
  const auto of_container = [&](CLI::App* asked) {
    asked->add_option("container", ask.container, "as the composition names it")->type_name("CONTAINER")->required();
    return asked;
  };
  const auto of_component = [&](CLI::App* asked, bool required = true) {
    of_container(asked)
        ->add_option("component", ask.component, "its full name, such as r1/control")
        ->type_name("COMPONENT")
        ->required(required);
    return asked;
  };
  add("list", "The containers of a run.");
  of_component(add("state", "How the components of a container are, or one of them."), false);
  CLI::App* load = of_component(add("load", "Load and activate a component."));
  load->add_option("type", ask.type, "such as control/potential_field; the composition's own need none")
      ->type_name("TYPE");
  load->add_option("--param", ask.parameters, "value of a parameter; may be repeated")
      ->type_name("NAME=VALUE")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  load->add_option("--port", ask.ports, "topic of a port; may be repeated")
      ->type_name("PORT=/TOPIC")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  load->add_option("--log", ask.log_level, "level of its log: trace, debug, info, warn, error or off")
      ->type_name("LEVEL");
  of_component(add("unload", "Unload a component, after its last words."));
  of_component(add("activate", "Let a component run that was deactivated."));
  of_component(add("deactivate", "Stop a component, after its last words; it stays loaded."));
  of_component(add("set", "Give live parameters new values, all of them or none."))
      ->add_option("values", ask.parameters, "such as speed=\"0.4 m/s\"")
      ->type_name("NAME=VALUE")
      ->required();
  CLI::App* call =
      of_component(add("call", "Ask a component one of the requests that it declares; kervan describe lists them."));
  call->add_option("request", ask.request, "such as teleport")->type_name("REQUEST")->required();
  call->add_option("values", ask.parameters, "its arguments, such as pose=\"[1 m, 2 m, 90 deg]\"")
      ->type_name("NAME=VALUE");
  of_component(add("snapshot", "All parameters of a container's components, or of one."), false);
}

/// What stands for the value of an option in the help.
std::string example_of(const ParameterInfo& info) {
  if (info.kind == ParameterKind::duration) return "TIME";
  return info.unit == "%" ? "SHARE" : info.unit == "B" ? "SIZE" : info.unit == "bit/s" ? "RATE" : "N";
}

/// `kervan link`: an option for each setting of a link, by the name that a composition uses, with hyphens.
void add_link(CLI::App& verb, cli::LinkRequest& link) {
  const char* const where = "a process in it, a path such as /proc/1234/ns/net, or a name of ip netns";
  verb.add_option("a", link.a, std::string("network namespace of one end: ") + where)->type_name("A")->required();
  verb.add_option("b", link.b, "that of the other end")->type_name("B")->required();
  verb.add_option("--profile", link.profile, "ethernet, wifi or lossy; the other options change it")
      ->check(not_empty)
      ->type_name("NAME");
  for (const ParameterInfo& info : schema_of<composition::LinkSettings>()) {
    std::string option = "--" + info.name;
    std::ranges::replace(option, '_', '-');
    const auto give = [&link, name = info.name](const std::string& text) { link.settings[name] = text; };
    if (info.kind == ParameterKind::boolean)
      verb.add_flag_callback(
          option, [give] { give("true"); }, info.help);
    else
      verb.add_option_function<std::string>(option, give, info.help)->check(not_empty)->type_name(example_of(info));
  }
  verb.add_option("--down", link.down, "time in which nothing passes, e.g. 10s..15s; may be repeated")
      ->type_name("FROM..UNTIL")
      ->check(not_empty)
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  verb.add_option("--interface", link.interface, "name of the interface that each end gets")
      ->capture_default_str()
      ->check(not_empty)
      ->type_name("NAME");
  verb.add_option("--address-a", link.address_a, "IPv4 address of A's")->capture_default_str()->type_name("IP");
  verb.add_option("--address-b", link.address_b, "of B's, in the same network of 24 bits")
      ->capture_default_str()
      ->type_name("IP");
  verb.add_option("--seed", link.seed, "of everything random")->capture_default_str()->type_name("N");
  verb.add_option("--for", link.time_limit, "end after this time; else at Ctrl-C")->check(not_empty)->type_name("TIME");
  verb.add_flag("--netem", link.netem, "have the kernel do it, if it has netem; its losses follow no seed");
  verb.add_flag("--json", link.json, "print the counters as one JSON object, on the last line");
}

/// The reason on stderr, and with --json also as an object on stdout, so that a script never has to read prose.
int refuse(const ConfigError& error, bool json) {
  std::cerr << error.what() << std::endl;
  if (json) {
    const Location& location = error.location();
    nlohmann::ordered_json object = {{"message", error.message()}};
    if (!location.file.empty()) object["file"] = location.file;
    if (location.line > 0) object["line"] = location.line;
    if (location.column > 0) object["column"] = location.column;
    cli::print_json({{"result", "error"}, {"error", object}});
  }
  return cli::exit_unusable;
}

/// CLI11's words where they are clear, ours where they are not.
std::string reason(const CLI::ParseError& error, const CLI::App& app) {
  if (dynamic_cast<const CLI::RequiredError*>(&error) == nullptr) return error.what();
  if (app.get_subcommands().empty()) return "a command is missing: " + config::joined(verbs);
  if (app.got_subcommand("container"))
    return app.get_subcommand("container")->get_subcommands().empty()
               ? "what to ask is missing: list, state, load, unload, activate, deactivate, set, call or snapshot"
               : error.what();
  if (app.got_subcommand("sweep")) return "a sweep is missing; name a shipped one, or a file";
  if (app.got_subcommand("link"))
    return "two network namespaces are missing; each is a process in it, a path, or a name that ip netns knows";
  if (app.got_subcommand("draw")) return "a world is missing; name a shipped one, such as lab, or a file";
  return "a composition is missing; name a shipped one, such as lab, or a file";
}

int dispatch(int argc, char** argv) {
  CLI::App app("Runs and checks compositions of robot components.", "kervan");
  app.require_subcommand(1);
  app.set_version_flag("--version", "kervan " KERVAN_VERSION);
  app.footer(
      "Exit codes: 0 good, 1 found something or the mission failed, 2 wrong usage or configuration, 130 Ctrl-C.");

  cli::RunRequest run;
  CLI::App* run_verb = app.add_subcommand("run", "Run a composition until its mission ends.");
  add_composition(*run_verb, run);
  run_verb
      ->add_option(
          "--for", run.time_limit,
          "stop after this time of the composition's clock, e.g. 10s; a mission that is not over then is aborted")
      ->check(not_empty)
      ->type_name("TIME");
  run_verb->add_option("--threads", run.threads, "threads of the dispatcher, 1 to 64; else as the composition says")
      ->check(not_empty)
      ->type_name("N");
  run_verb
      ->add_option("--snapshots", run.snapshots,
                   "show in map.svg what each robot's sensors saw at the start and every so often, e.g. 5s")
      ->check(not_empty)
      ->type_name("TIME");
  CLI::Option* runs = run_verb->add_option("--runs", run.runs_folder, "folder that gets a folder for this run")
                          ->capture_default_str()
                          ->check(not_empty)
                          ->type_name("DIR");
  run_verb->add_option("--out", run.run_folder, "folder for this run itself, empty or not there yet")
      ->check(not_empty)
      ->excludes(runs)
      ->type_name("DIR");

  cli::SweepRequest sweep;
  CLI::App* sweep_verb =
      app.add_subcommand("sweep", "Run a composition many times, as a file says, and compare what came of it.");
  sweep_verb->add_option("sweep", sweep.file, "name of a shipped sweep, or a file")->type_name("NAME|FILE")->required();
  sweep_verb->add_option("--out", sweep.out, "folder for runs and report; else sweeps/NAME")
      ->check(not_empty)
      ->type_name("DIR");
  sweep_verb->add_option("--jobs", sweep.jobs, "runs at a time, 1 to 256; else as many as there are cores")
      ->check(not_empty)
      ->type_name("N");
  sweep_verb->add_flag("--json", sweep.json, "print the result as one JSON object, on the last line");

  cli::CheckRequest check;
  CLI::App* check_verb = app.add_subcommand("check", "Check a composition without running it.");
  add_composition(*check_verb, check);
  check_verb->add_option("--explain", check.explain, "say which line gave each value of a topic's quality of service")
      ->check(not_empty)
      ->type_name("TOPIC");

  cli::DescribeRequest describe;
  CLI::App* describe_verb =
      app.add_subcommand("describe", "List the component types, or the ports and parameters of one.");
  CLI::Option* component =
      describe_verb->add_option("component", describe.component, "a type, such as control/potential_field")
          ->type_name("COMPONENT");
  CLI::Option* json_flag = describe_verb->add_flag("--json", describe.json, "print one JSON object");
  describe_verb->add_flag("--markdown", describe.markdown, "print the tables for the component's page")
      ->needs(component)
      ->excludes(json_flag);

  cli::DrawRequest draw;
  CLI::App* draw_verb = app.add_subcommand("draw", "Draw a world, or a map of ROS or ARIA, as an SVG picture.");
  draw_verb->add_option("world", draw.world, "name of a shipped world, or a file")->type_name("NAME|FILE")->required();
  auto* draw_out = draw_verb->add_option("--out", draw.out, "file for the picture; else NAME.svg")
                       ->check(not_empty)
                       ->type_name("FILE");
  draw_verb->add_option("--plan", draw.plan, "no picture: the walls alone, as a map of map_server (.yaml) and its .png")
      ->check(not_empty)
      ->type_name("FILE")
      ->excludes(draw_out);

  cli::SystemdRequest systemd;
  CLI::App* systemd_verb = app.add_subcommand("systemd", "Write the systemd units of a host's containers.");
  add_composition(*systemd_verb, systemd);
  systemd_verb->add_option("--out", systemd.out, "folder for the units; else systemd-NAME")
      ->check(not_empty)
      ->type_name("DIR");

  cli::ContainerAsk ask;
  CLI::App* container_verb = app.add_subcommand("container", "Look at a container that runs, or change what it hosts.");
  add_container(*container_verb, ask);

  cli::LinkRequest link;
  CLI::App* link_verb = app.add_subcommand("link", "Join two network namespaces by an emulated link.");
  add_link(*link_verb, link);

  const std::vector<std::string> arguments(argv + 1, argv + argc);
  const bool json = std::find(arguments.begin(), arguments.end(), "--json") != arguments.end();
  if (arguments.empty())
    return refuse({{}, "a command is missing: " + config::joined(verbs) + "; see kervan --help"}, false);
  const std::string verb = arguments[0].starts_with('-') ? "" : arguments[0];
  // CLI11 would call a misspelt verb an unexpected argument.
  if (!verb.empty() && std::find(verbs.begin(), verbs.end(), verb) == verbs.end())
    return refuse({{}, "there is no command '" + verb + "'" + config::hint(verb, verbs, "commands")}, json);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    const std::string program = verb.empty() ? "kervan" : "kervan " + verb;
    return refuse({{}, program + ": " + reason(error, app) + "; see " + program + " --help"}, json);
  }

  try {
    if (*run_verb) return cli::run(run);
    if (*sweep_verb) return cli::sweep(sweep);
    if (*check_verb) return cli::check(check);
    if (*draw_verb) return cli::draw(draw);
    if (*systemd_verb) return cli::systemd(systemd);
    if (*container_verb) return cli::container(ask);
    if (*link_verb) return cli::link(link);
    return cli::describe(describe);
  } catch (const ConfigError& error) {
    return refuse(error, json);
  } catch (const std::exception& error) {
    return refuse({{}, error.what()}, json);
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return dispatch(argc, argv);
  } catch (const std::exception& error) {
    std::fputs(error.what(), stderr);
    std::fputs("\n", stderr);
    return cli::exit_unusable;
  }
}
