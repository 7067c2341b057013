// SPDX-License-Identifier: Apache-2.0
// fasttree_netlist XC7.json ASIC.json LIBERTY ABC.log [PORT...]: a unit's figures as JSON, from
// what synthesize.sh had Yosys write. PORT: inputs that hold still while their values matter.
#include <fstream>
#include <iostream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "rtl/synth/figures.h"

namespace {

std::string content(const char* name) {
  std::ifstream file(name, std::ios::binary);
  if (!file) throw std::runtime_error(std::string(name) + ": cannot be read");
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The last "Delay = 1451.50 ps" of ABC's log: after all its steps.
double delay_ns(const std::string& log) {
  const std::string mark = "Delay =";
  const std::size_t place = log.rfind(mark);
  return place == std::string::npos ? 0 : std::stod(log.substr(place + mark.size())) / 1000;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace fasttree::synth;
  if (argc < 5) {
    std::cerr << "usage: fasttree_netlist XC7.json ASIC.json LIBERTY ABC.log [PORT...]\n";
    return 2;
  }
  try {
    const Netlist fpga = read_netlist(content(argv[1]), "unit");
    const Netlist asic = read_netlist(content(argv[2]), "unit");
    TimingOptions options;
    options.still.insert(argv + 5, argv + argc);
    nlohmann::ordered_json json;
    json["asic"] =
        json_of(count_asic(asic, read_areas(content(argv[3]))), delay_ns(content(argv[4])));
    json["fpga"] = json_of(count_xc7(fpga));
    json["timing"] = json_of(analyse(fpga, options));
    std::cout << json.dump(2) << "\n";
  } catch (const std::exception& error) {
    std::cerr << "fasttree_netlist: " << error.what() << "\n";
    return 1;
  }
  return 0;
}
