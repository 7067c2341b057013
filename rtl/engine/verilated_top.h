// SPDX-License-Identifier: Apache-2.0
// One variant of the verilated top level behind the interface of top.h.
#pragma once

#include <verilated.h>
#include <verilated_fst_c.h>

#include <memory>
#include <string>
#include <vector>

#include "rtl/bench/axi_ports.h"
#include "rtl/engine/top.h"

namespace fasttree::rtl {

template <typename Model, std::size_t kBusBytes>
class VerilatedTop : public Top {
 public:
  VerilatedTop() {
    context_.randReset(2);
    context_.randSeed(1);
    context_.fatalOnError(false);
    context_.traceEverOn(true);
    model_ = std::make_unique<Model>(&context_);
    model_->aclk = 0;
  }
  ~VerilatedTop() override {
    VerilatedTop::close_wave();
    model_->final();
    // Verilator's destructors look at the thread's context, which may be that of another, gone
    // model.
    Verilated::threadContextp(&context_);
    model_.reset();
  }

  void reset(bool active) override {
    model_->aresetn = !active;
    context_.assertOn(!active);  // registers begin at random
  }

  void settle(AxiSignals& memory, HostSignals& host) override {
    Model& m = *model_;
    m.s_axi_awvalid = m.s_axi_wvalid = host.write_valid;
    m.s_axi_awaddr = m.s_axi_araddr = static_cast<std::uint16_t>(host.address);
    m.s_axi_wdata = host.write_data;
    m.s_axi_wstrb = 15;
    m.s_axi_bready = 1;
    m.s_axi_arvalid = host.read_valid;
    m.s_axi_rready = 1;
    drive_unit(memory, m, kBusBytes);
    m.aclk = 0;
    m.eval();
    dump();
    host.write_ready = m.s_axi_awready && m.s_axi_wready;
    host.answer_valid = m.s_axi_bvalid;
    host.read_ready = m.s_axi_arready;
    host.data_valid = m.s_axi_rvalid;
    host.read_data = m.s_axi_rdata;
    host.irq = m.irq;
    host.stage = m.stage;
    look_at_unit(m, memory, kBusBytes);
  }

  void clock() override {
    model_->aclk = 1;
    model_->eval();
    dump();
  }

  void activity(std::vector<std::uint8_t>& units) const override {
    for (std::size_t u = 0; u < units.size(); ++u) {
      units[u] = static_cast<std::uint8_t>(get_word(model_->activity, u / 8) >> (u % 8 * 4) & 15);
    }
  }

  Status open_wave(const std::string& path) override {
    wave_ = std::make_unique<VerilatedFstC>();
    model_->trace(wave_.get(), 99);
    wave_->open(path.c_str());
    if (!wave_->isOpen()) {
      wave_.reset();
      return Status(StatusCode::io_error, "cannot write waveforms to " + path);
    }
    return {};
  }
  void close_wave() override {
    if (wave_) wave_->close();
    wave_.reset();
  }

  int failed_assertions() const override { return context_.errorCount(); }

 private:
  void dump() {
    if (wave_) wave_->dump(time_);
    ++time_;
  }

  VerilatedContext context_;
  std::unique_ptr<Model> model_;
  std::unique_ptr<VerilatedFstC> wave_;
  std::uint64_t time_ = 0;  ///< half cycles
};

}  // namespace fasttree::rtl
