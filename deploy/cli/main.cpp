// The kervan program: parses the command line, calls the verb, and turns what goes wrong into one line on stderr.
#include <CLI/CLI.hpp>
#include <iostream>
#include <nlohmann/json.hpp>

#include "deploy/cli/verbs.hpp"
#include "framework/component/error.hpp"
#include "framework/config/node.hpp"

using namespace kervan;

namespace {

const std::vector<std::string> verbs = {"run", "check", "describe"};

/// The options that run and check share.
void add_composition(CLI::App& verb, cli::CompositionRequest& request) {
  verb.add_option("composition", request.composition, "name of a shipped composition, or a file")
      ->type_name("NAME|FILE")
      ->required();
  verb.add_option("--arg", request.arguments, "value of one of the composition's arguments; may be repeated")
      ->type_name("NAME=VALUE")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  verb.add_option("--place", "where the components go; 'all' puts them into one container")
      ->type_name("all")
      ->check(CLI::IsMember({"all"}))
      ->each([&request](const std::string&) { request.place_all = true; });
  verb.add_flag("--json", request.json, "print the result as one JSON object, on the last line");
}

/// The reason on stderr, and with --json also as an object on stdout, so that a script never has to read prose.
int refuse(const std::string& message, const Location& location, bool json) {
  std::cerr << (location.file.empty() ? message : to_text(location) + ": " + message) << std::endl;
  if (json) {
    nlohmann::ordered_json error = {{"message", message}};
    if (!location.file.empty()) error["file"] = location.file;
    if (location.line > 0) error["line"] = location.line;
    if (location.column > 0) error["column"] = location.column;
    std::cout << nlohmann::ordered_json{{"result", "error"}, {"error", error}}.dump() << std::endl;
  }
  return cli::exit_unusable;
}

int dispatch(int argc, char** argv) {
  CLI::App app("Runs and checks compositions of robot components.", "kervan");
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 good, 1 found something or the mission failed, 2 wrong usage or configuration, 130 Ctrl-C.");

  cli::RunRequest run;
  CLI::App* run_verb = app.add_subcommand("run", "Run a composition until its mission ends.");
  add_composition(*run_verb, run);
  run_verb->add_option("--for", run.time_limit, "stop after this time of the composition's clock")->type_name("TIME");
  run_verb->add_option("--threads", run.threads, "threads of the dispatcher")->check(CLI::Range(1, 64))->type_name("N");
  run_verb->add_option("--runs", run.runs_folder, "folder that gets a folder for this run")
      ->capture_default_str()
      ->type_name("DIR");

  cli::CheckRequest check;
  CLI::App* check_verb = app.add_subcommand("check", "Check a composition without running it.");
  add_composition(*check_verb, check);
  check_verb->add_option("--explain", check.explain, "say which line gave each value of a topic's quality of service")
      ->type_name("TOPIC");

  cli::DescribeRequest describe;
  CLI::App* describe_verb =
      app.add_subcommand("describe", "List the component types, or the ports and parameters of one.");
  describe_verb->add_option("component", describe.component, "a type, such as control/potential_field")
      ->type_name("COMPONENT");
  describe_verb->add_flag("--json", describe.json, "print one JSON object");

  if (argc == 1) return refuse("a command is missing: " + config::joined(verbs) + "; see kervan --help", {}, false);
  // CLI11 would call a misspelt verb an unexpected argument.
  if (argc > 1 && argv[1][0] != '-' && std::find(verbs.begin(), verbs.end(), argv[1]) == verbs.end())
    return refuse("there is no command '" + std::string(argv[1]) + "'" + config::hint(argv[1], verbs, "commands"), {},
                  false);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    const std::string verb = argc > 1 && argv[1][0] != '-' ? " " + std::string(argv[1]) : "";
    return refuse("kervan" + verb + ": " + error.what() + "; see kervan" + verb + " --help", {}, false);
  }

  const bool json = run.json || check.json || describe.json;
  try {
    if (*run_verb) return cli::run(run);
    if (*check_verb) return cli::check(check);
    return cli::describe(describe);
  } catch (const ConfigError& error) {
    return refuse(error.message(), error.location(), json);
  } catch (const std::exception& error) {
    return refuse(error.what(), {}, json);
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
