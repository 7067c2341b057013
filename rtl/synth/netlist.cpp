// SPDX-License-Identifier: Apache-2.0
#include "rtl/synth/netlist.h"

#include <nlohmann/json.hpp>
#include <stdexcept>

namespace fasttree::synth {
namespace {

using nlohmann::json;

std::vector<Net> nets_of(const json& bits) {
  std::vector<Net> nets;
  // Constants are written as text: "0", "1", "x".
  for (const json& bit : bits) nets.push_back(bit.is_number() ? bit.get<Net>() : kConstant);
  return nets;
}

std::string text_of(const json& value) {
  return value.is_string() ? value.get<std::string>() : value.dump();
}

void grow(Netlist& netlist, const std::vector<Net>& nets) {
  for (const Net net : nets) {
    if (net >= 0 && static_cast<std::size_t>(net) >= netlist.names.size()) {
      netlist.names.resize(static_cast<std::size_t>(net) + 1);
    }
  }
}

}  // namespace

long long Cell::parameter(const std::string& key, long long otherwise) const {
  const auto found = parameters.find(key);
  if (found == parameters.end()) return otherwise;
  long long value = 0;
  for (const char digit : found->second) {
    if (digit != '0' && digit != '1') continue;  // the space behind text, x
    value = value * 2 + (digit - '0');
  }
  return value;
}

Netlist read_netlist(const std::string& text, const std::string& module) {
  const json all = json::parse(text, nullptr, false);
  if (all.is_discarded() || !all.contains("modules") || !all["modules"].contains(module)) {
    throw std::runtime_error("no netlist of a module " + module);
  }
  const json& top = all["modules"][module];
  Netlist netlist;
  for (const auto& [name, port] : top.at("ports").items()) {
    auto& ports = port.at("direction") == "input" ? netlist.inputs : netlist.outputs;
    grow(netlist, ports[name] = nets_of(port.at("bits")));
  }
  for (const auto& [name, entry] : top.at("cells").items()) {
    Cell cell{name, entry.at("type").get<std::string>(), {}, {}, {}};
    for (const auto& [key, value] : entry.at("parameters").items()) {
      cell.parameters[key] = text_of(value);
    }
    const json& directions = entry.value("port_directions", json::object());
    for (const auto& [pin, bits] : entry.at("connections").items()) {
      if (!directions.contains(pin)) {
        throw std::runtime_error("cell of an unknown type: " + cell.type);
      }
      auto& pins = directions[pin] == "input" ? cell.inputs : cell.outputs;
      grow(netlist, pins[pin] = nets_of(bits));
    }
    netlist.cells.push_back(std::move(cell));
  }
  // A net may have several names; the shortest that the source gave says most.
  for (const auto& [name, entry] : top.at("netnames").items()) {
    if (entry.value("hide_name", 0) != 0) continue;
    const std::vector<Net> nets = nets_of(entry.at("bits"));
    for (std::size_t i = 0; i < nets.size(); ++i) {
      if (nets[i] < 0 || static_cast<std::size_t>(nets[i]) >= netlist.names.size()) continue;
      const std::string bit = nets.size() > 1 ? name + "[" + std::to_string(i) + "]" : name;
      std::string& known = netlist.names[static_cast<std::size_t>(nets[i])];
      if (known.empty() || bit.size() < known.size()) known = bit;
    }
  }
  return netlist;
}

}  // namespace fasttree::synth
