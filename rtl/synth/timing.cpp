// SPDX-License-Identifier: Apache-2.0
#include "rtl/synth/timing.h"

#include <algorithm>
#include <stdexcept>

namespace fasttree::synth {
namespace {

constexpr double kNever = -1;

class Analysis {
 public:
  Analysis(const Netlist& netlist, const TimingOptions& options)
      : netlist_(netlist),
        options_(options),
        driver_(netlist.nets(), kPort),
        sinks_(netlist.nets(), 0) {
    timings_.reserve(netlist.cells.size());
    for (std::size_t c = 0; c < netlist.cells.size(); ++c) {
      const Cell& cell = netlist.cells[c];
      timings_.push_back(timing_of(cell, options.delays));
      for (const auto& [pin, nets] : cell.outputs) {
        for (const Net net : nets) {
          if (net >= 0) driver_[at(net)] = static_cast<int>(c);
        }
      }
      for (const auto& [pin, nets] : cell.inputs) {
        for (const Net net : nets) {
          if (net >= 0) ++sinks_[at(net)];
        }
      }
    }
    for (const auto& [name, nets] : netlist.outputs) {
      for (const Net net : nets) {
        if (net >= 0) ++sinks_[at(net)];
      }
    }
    order_arcs();
  }

  /// `ports`: paths begin and end there as well.
  Path longest(bool ports) {
    arrival_.assign(netlist_.nets(), kNever);
    from_.assign(netlist_.nets(), kConstant);
    for (const CellTiming& timing : timings_) {
      for (const Clocked& start : timing.starts) arrive(start.net, start.ns, kConstant);
    }
    if (ports) {
      for (const auto& [name, nets] : netlist_.inputs) {
        if (options_.still.count(name) > 0) continue;
        for (const Net net : nets) {
          if (net >= 0) arrive(net, options_.delays.ff_clock_to_q, kConstant);
        }
      }
    }
    for (const PlacedArc& placed : order_) {
      const Arc& arc = *placed.arc;
      if (arrival_[at(arc.from)] == kNever) continue;
      arrive(arc.to, at_pin(arc.from, netlist_.cells[placed.cell].type, arc.pin) + arc.ns,
             arc.from);
    }
    return worst(ports);
  }

 private:
  static constexpr int kPort = -1;

  struct PlacedArc {
    const Arc* arc;
    std::size_t cell;
  };

  static std::size_t at(Net net) { return static_cast<std::size_t>(net); }

  std::string driver_type(Net net) const {
    const int cell = driver_[at(net)];
    return cell == kPort ? "port" : netlist_.cells[static_cast<std::size_t>(cell)].type;
  }

  double at_pin(Net net, const std::string& sink, const std::string& pin) const {
    return arrival_[at(net)] +
           net_delay(driver_type(net), sink, pin, sinks_[at(net)], options_.delays);
  }

  void arrive(Net net, double ns, Net from) {
    if (ns > arrival_[at(net)]) {
      arrival_[at(net)] = ns;
      from_[at(net)] = from;
    }
  }

  // Arcs in an order in which nothing comes before what feeds it (Kahn). By net and not by cell: a
  // memory's two read ports may well feed one another.
  void order_arcs() {
    std::vector<std::vector<PlacedArc>> leaving(netlist_.nets());
    std::vector<std::size_t> waits(netlist_.nets(), 0);
    std::size_t count = 0;
    for (std::size_t c = 0; c < timings_.size(); ++c) {
      for (const Arc& arc : timings_[c].arcs) {
        leaving[at(arc.from)].push_back({&arc, c});
        ++waits[at(arc.to)];
        ++count;
      }
    }
    std::vector<std::size_t> ready;
    for (std::size_t net = 0; net < waits.size(); ++net) {
      if (waits[net] == 0) ready.push_back(net);
    }
    for (std::size_t i = 0; i < ready.size(); ++i) {
      for (const PlacedArc& placed : leaving[ready[i]]) {
        order_.push_back(placed);
        if (--waits[at(placed.arc->to)] == 0) ready.push_back(at(placed.arc->to));
      }
    }
    if (order_.size() == count) return;
    for (std::size_t net = 0; net < waits.size(); ++net) {
      if (waits[net] > 0) {
        const Cell& cell = netlist_.cells[static_cast<std::size_t>(driver_[net])];
        throw std::runtime_error("a combinational loop goes through or leads to a " + cell.type +
                                 " (" + cell.name + ")");
      }
    }
  }

  Path worst(bool ports) const {
    double most = 0;
    Net last = kConstant;
    std::string end, signal;
    const auto consider = [&](double ns, Net net, const std::string& type,
                              const std::string& name) {
      if (ns <= most) return;
      most = ns;
      last = net;
      end = type;
      signal = name;
    };
    for (std::size_t c = 0; c < timings_.size(); ++c) {
      const Cell& cell = netlist_.cells[c];
      for (const Clocked& stop : timings_[c].ends) {
        if (arrival_[at(stop.net)] == kNever) continue;
        consider(at_pin(stop.net, cell.type, stop.pin) + stop.ns, stop.net,
                 cell.type + "." + stop.pin, output_of(cell));
      }
    }
    if (ports) {
      for (const auto& [name, nets] : netlist_.outputs) {
        for (const Net net : nets) {
          if (net < 0 || arrival_[at(net)] == kNever) continue;
          consider(at_pin(net, "port", name) + options_.delays.ff_setup, net, "port", name);
        }
      }
    }
    Path path;
    if (last == kConstant) return path;
    path.ns = most;
    for (Net net = last; net != kConstant; net = from_[at(net)]) {
      path.steps.push_back({driver_type(net), netlist_.names[at(net)], arrival_[at(net)]});
    }
    std::reverse(path.steps.begin(), path.steps.end());
    path.levels = static_cast<int>(path.steps.size()) - 1;  // less the cell or port it starts in
    path.steps.push_back({end, signal, most});
    return path;
  }

  /// What a clocked cell is called: its output's name.
  std::string output_of(const Cell& cell) const {
    for (const auto& [pin, nets] : cell.outputs) {
      for (const Net net : nets) {
        if (net >= 0 && !netlist_.names[at(net)].empty()) return netlist_.names[at(net)];
      }
    }
    return cell.name.find('$') == std::string::npos ? cell.name : "";
  }

  const Netlist& netlist_;
  const TimingOptions& options_;
  std::vector<CellTiming> timings_;
  std::vector<int> driver_;  ///< cell, or kPort
  std::vector<std::size_t> sinks_;
  std::vector<PlacedArc> order_;
  std::vector<double> arrival_;
  std::vector<Net> from_;
};

}  // namespace

Timing analyse(const Netlist& netlist, const TimingOptions& options) {
  Analysis analysis(netlist, options);
  Timing timing;
  timing.registers = analysis.longest(false);
  timing.any = analysis.longest(true);
  return timing;
}

}  // namespace fasttree::synth
