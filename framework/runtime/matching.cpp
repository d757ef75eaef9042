#include "framework/runtime/matching.hpp"

#include <algorithm>

#include "framework/runtime/container.hpp"

namespace kervan::runtime {

Matching::Matching(const Container& container) {
  const ContainerSpec& spec = container.spec();
  for (unsigned index = 0; index < spec.components.size(); ++index) {
    const ComponentSpec& component = spec.components[index];
    const auto instance = std::ranges::find(container.instances(), index, &ComponentInstance::index);
    if (instance != container.instances().end()) {
      for (const auto& port : (*instance)->outputs())
        writers_.push_back({.name = component.name + "." + port->name(),
                            .topic = port->binding().topic,
                            .container = spec.name,
                            .output = port.get()});
      for (const auto& port : (*instance)->inputs())
        readers_.push_back({.name = component.name + "." + port->name(),
                            .topic = port->binding().topic,
                            .container = spec.name,
                            .optional = port->binding().optional,
                            .input = port.get()});
      continue;
    }
    for (const PortBinding& port : component.ports)
      (port.direction == PortDirection::output ? writers_ : readers_)
          .push_back({.name = component.name + "." + port.port,
                      .topic = port.topic,
                      .container = component.container,
                      .optional = port.optional,
                      .absent = is_local(spec, component)});
  }
  for (unsigned reader = 0; reader < readers_.size(); ++reader)
    for (unsigned writer = 0; writer < writers_.size(); ++writer)
      if (readers_[reader].topic == writers_[writer].topic && !readers_[reader].input != !writers_[writer].output &&
          !readers_[reader].absent && !writers_[writer].absent)
        pairs_.push_back({.writer = writer, .reader = reader});
}

const std::string& Matching::other_container(const Pair& pair) const {
  return readers_[pair.reader].input ? writers_[pair.writer].container : readers_[pair.reader].container;
}

bool Matching::complete() {
  // Pairs of one reader stand together, those of one writer do not: ask about each endpoint once.
  std::vector<std::vector<dds::MatchedPeer>> of_writer(writers_.size());
  std::vector<bool> asked(writers_.size(), false);
  std::vector<dds::MatchedPeer> of_reader;
  unsigned asked_reader = dds::kInternal;
  bool complete = true;
  for (Pair& pair : pairs_) {
    if (pair.matched) continue;
    const std::vector<dds::MatchedPeer>* peers = nullptr;
    unsigned wanted = 0;
    std::uint64_t layout = 0;
    if (InputPort* const input = readers_[pair.reader].input) {
      if (std::exchange(asked_reader, pair.reader) != pair.reader) of_reader = input->reader().matched_writers();
      peers = &of_reader;
      wanted = pair.writer;
      layout = input->type().layout_hash;
    } else {
      OutputPort* const output = writers_[pair.writer].output;
      if (!asked[pair.writer]) of_writer[pair.writer] = output->writer().matched_readers();
      asked[pair.writer] = true;
      peers = &of_writer[pair.writer];
      wanted = pair.reader;
      layout = output->type().layout_hash;
    }
    for (const dds::MatchedPeer& peer : *peers) {
      if (!peer.identity || peer.identity->index != wanted) continue;
      pair.another_layout = peer.identity->layout_hash != layout;
      pair.matched = !pair.another_layout;
    }
    complete = complete && pair.matched;
  }
  return complete;
}

}  // namespace kervan::runtime
