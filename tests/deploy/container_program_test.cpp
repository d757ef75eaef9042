// kervan-container as somebody calls it by hand.
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <fstream>
#include <memory>

#include "deploy/container/spec_json.hpp"
#include "tests/program/eventually.hpp"
#include "tests/program/program.hpp"

namespace kervan::test {
namespace {

class ContainerProgram : public testing::Test {
 protected:
  Result call(const std::string& arguments) const {
    return run_line(KERVAN_CONTAINER_PROGRAM, arguments, folder_.path());
  }

  void expect_refused(const std::string& arguments, const std::string& message) const {
    const Result result = call(arguments);
    EXPECT_EQ(result.code, 2) << arguments;
    EXPECT_EQ(result.err, message + "\n") << arguments;
  }

  /// The specification of the container `one`, with these components.
  void write(std::vector<runtime::ComponentSpec> components = {}) const {
    runtime::ContainerSpec spec;
    spec.name = "one";
    spec.components = std::move(components);
    spec.domain.network = false;
    container::write_spec(spec, folder_.path() / "spec.json");
  }

  Folder folder_;
};

TEST_F(ContainerProgram, SaysHowToCallIt) {
  const std::string usage = "kervan-container: usage: kervan-container SPEC.json NAME [--control-fd N] [--for-ns N]";
  expect_refused("", usage);
  expect_refused("spec.json", usage);
  expect_refused("spec.json a --for 1s", "kervan-container: there is no option --for; allowed: --control-fd, --for-ns");
  expect_refused("spec.json a --for-ns", "kervan-container: --for-ns needs a value");
  expect_refused("spec.json a --for-ns 1s", "kervan-container: --for-ns 1s: must be a whole number, 0 or more");
}

TEST_F(ContainerProgram, NamesASpecificationThatItCannotUse) {
  expect_refused("spec.json a", "kervan-container: a: spec.json: cannot be read");
  std::ofstream(folder_.path() / "broken.json") << "{";
  expect_refused("broken.json a", "kervan-container: a: broken.json:1:2: this is no JSON");
  write();
  expect_refused("spec.json a", "kervan-container: a: spec.json: is for the container 'one', not 'a'");
}

TEST_F(ContainerProgram, NamesAComponentThatIsNotThere) {
  write({{.name = "c", .type = "no/such"}});
  expect_refused("spec.json one", "kervan-container: one: there is no component type 'no/such'");
}

TEST_F(ContainerProgram, EndsWhenItsTimeIsUp) {
  write();
  const Result result = call("spec.json one --for-ns 1000000");
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(result.err, "");
}

/// Of three containers the third never comes, and the second stands still while the first waits for both.
TEST_F(ContainerProgram, NamesAContainerThatDoesNotAnswer) {
  runtime::ContainerSpec spec;
  spec.members = {"left", "middle", "right"};
  spec.domain = {.id = 94, .tag = "does-not-answer-" + std::to_string(::getpid())};
  spec.run_folder = folder_.path();
  spec.log_to_console = false;
  std::vector<std::unique_ptr<Process>> processes;
  for (const char* name : {"left", "middle"}) {
    spec.name = name;
    const std::string file = std::string(name) + ".json";
    container::write_spec(spec, folder_.path() / file);
    processes.push_back(std::make_unique<Process>(Command{KERVAN_CONTAINER_PROGRAM, {file, name}}, folder_.path()));
  }
  const auto left_says = [&](const std::string& text) {
    return eventually(
        [&] { return text_of(folder_.path() / "log-left.txt").find(" s: " + text + "\n") != std::string::npos; });
  };
  EXPECT_TRUE(left_says("container 'right' is not there"));
  processes[1]->signal(SIGSTOP);
  EXPECT_TRUE(left_says("container 'middle' does not answer; container 'right' is not there"));
  processes[1]->signal(SIGCONT);
  for (const auto& process : processes) {
    process->signal(SIGINT);
    EXPECT_EQ(process->wait().code, 0);
  }
}

}  // namespace
}  // namespace kervan::test
