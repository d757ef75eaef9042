/// The endpoints of a whole composition, and which of those elsewhere the ones of this container must be matched with
/// before anything may be published.
#pragma once

#include <string>
#include <vector>

namespace kervan::runtime {

class Container;
class InputPort;
class OutputPort;

/// An endpoint of the composition. Its index is its place among the composition's writers, or among its readers.
struct CompositionEndpoint {
  std::string name;              ///< component and port: "r1/control.odometry"
  std::string topic;             ///< "/r1/odom"
  std::string container;         ///< where it runs
  bool optional = false;         ///< an input that may stay without a writer
  bool absent = false;           ///< of a component that was unloaded here
  InputPort* input = nullptr;    ///< if it is a reader of this container
  OutputPort* output = nullptr;  ///< if it is a writer of this container
};

class Matching {
 public:
  /// Reads the composition off the container's spec and asks nobody yet. The container must outlive this.
  explicit Matching(const Container& container);

  const std::vector<CompositionEndpoint>& writers() const { return writers_; }
  const std::vector<CompositionEndpoint>& readers() const { return readers_; }

  /// A writer and a reader of one topic of which one is here and the other is not.
  struct Pair {
    unsigned writer;
    unsigned reader;
    bool matched = false;
    bool another_layout = false;  ///< the one elsewhere was built with another version of the IDL
  };

  /// Asks Cyclone about all pairs that are not matched yet; true when none is left. A reliable writer delivers
  /// everything it publishes once both sides say so.
  bool complete();

  /// All pairs, in the order of the reader, then of the writer.
  const std::vector<Pair>& pairs() const { return pairs_; }
  /// Where the endpoint of a pair that is not of this container runs.
  const std::string& other_container(const Pair& pair) const;

 private:
  std::vector<CompositionEndpoint> writers_;
  std::vector<CompositionEndpoint> readers_;
  std::vector<Pair> pairs_;
};

}  // namespace kervan::runtime
