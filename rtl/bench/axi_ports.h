// SPDX-License-Identifier: Apache-2.0
// Copies the wires of an AXI4 interface from and to a verilated unit with ports m_axi_*.
#pragma once

#include <cstddef>
#include <cstdint>

#include "rtl/bench/axi_signals.h"
#include "rtl/bench/bench.h"

namespace fasttree::rtl {

/// What the slave drives.
template <typename Unit>
void drive_unit(const AxiSignals& axi, Unit& unit, std::size_t bus_bytes) {
  unit.m_axi_arready = axi.ar_ready;
  unit.m_axi_awready = axi.aw_ready;
  unit.m_axi_wready = axi.w_ready;
  unit.m_axi_rvalid = axi.r_valid;
  if (axi.r_valid) {
    unit.m_axi_rid = static_cast<std::uint8_t>(axi.r_id);
    unit.m_axi_rresp = static_cast<std::uint8_t>(axi.r_response);
    unit.m_axi_rlast = axi.r_last;
    for (std::size_t i = 0; i < bus_bytes / 4; ++i) set_word(unit.m_axi_rdata, i, axi.r_data[i]);
  }
  unit.m_axi_bvalid = axi.b_valid;
  if (axi.b_valid) {
    unit.m_axi_bid = static_cast<std::uint8_t>(axi.b_id);
    unit.m_axi_bresp = static_cast<std::uint8_t>(axi.b_response);
  }
}

/// What the unit drives, after it was evaluated.
template <typename Unit>
void look_at_unit(const Unit& unit, AxiSignals& axi, std::size_t bus_bytes) {
  axi.ar_valid = unit.m_axi_arvalid;
  if (axi.ar_valid) {
    axi.ar_address = unit.m_axi_araddr;
    axi.ar_length = unit.m_axi_arlen;
    axi.ar_id = unit.m_axi_arid;
  }
  axi.r_ready = unit.m_axi_rready;
  axi.aw_valid = unit.m_axi_awvalid;
  if (axi.aw_valid) {
    axi.aw_address = unit.m_axi_awaddr;
    axi.aw_length = unit.m_axi_awlen;
    axi.aw_id = unit.m_axi_awid;
  }
  axi.w_valid = unit.m_axi_wvalid;
  if (axi.w_valid) {
    axi.w_last = unit.m_axi_wlast;
    axi.w_strobes = unit.m_axi_wstrb;
    for (std::size_t i = 0; i < bus_bytes / 4; ++i) axi.w_data[i] = get_word(unit.m_axi_wdata, i);
  }
  axi.b_ready = unit.m_axi_bready;
}

}  // namespace fasttree::rtl
