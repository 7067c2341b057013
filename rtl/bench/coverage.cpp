// SPDX-License-Identifier: Apache-2.0
#include "coverage.h"

#include <unistd.h>
#include <verilated_cov.h>

#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <map>
#include <string>

namespace fasttree::rtl {
namespace {

class Totals {
 public:
  Totals() {
    const char* folder = std::getenv("FASTTREE_RTL_COVERAGE");
    path_ = std::string(folder != nullptr ? folder : ".") + "/" + std::to_string(getpid()) + ".dat";
  }
  ~Totals() {
    std::ofstream file(path_);
    file << "# SystemC::Coverage-3\n";
    for (const auto& [point, count] : counts_) file << point << ' ' << count << '\n';
  }
  /// Verilator gives the counts to a file only.
  void add(VerilatedContext& context) {
    context.coveragep()->write(path_.c_str());
    std::ifstream file(path_);
    for (std::string line; std::getline(file, line);) {
      const std::size_t space = line.rfind(' ');
      if (line[0] != 'C' || space == std::string::npos) continue;
      counts_[line.substr(0, space)] += std::stoull(line.substr(space + 1));
    }
  }

 private:
  std::string path_;
  std::map<std::string, std::uint64_t> counts_;
};

}  // namespace

void add_coverage(VerilatedContext& context) {
  static Totals totals;
  totals.add(context);
}

}  // namespace fasttree::rtl
