// SPDX-License-Identifier: Apache-2.0
// The wires of an AXI4 interface, outside of any verilated class.
#pragma once

#include <array>
#include <cstdint>

namespace fasttree::rtl {

/// Addresses of 32 bits, data of up to 64 bytes. Data are meaningful only where valid.
struct AxiSignals {
  using Data = std::array<std::uint32_t, 16>;

  // Of the master.
  bool ar_valid = false;
  std::uint32_t ar_address = 0;
  std::uint32_t ar_length = 0;  ///< beats less one
  std::uint32_t ar_id = 0;
  bool r_ready = false;
  bool aw_valid = false;
  std::uint32_t aw_address = 0;
  std::uint32_t aw_length = 0;
  std::uint32_t aw_id = 0;
  bool w_valid = false;
  bool w_last = false;
  std::uint64_t w_strobes = 0;
  Data w_data{};
  bool b_ready = false;

  // Of the slave.
  bool ar_ready = false;
  bool r_valid = false;
  bool r_last = false;
  std::uint32_t r_response = 0;
  std::uint32_t r_id = 0;
  Data r_data{};
  bool aw_ready = false;
  bool w_ready = false;
  bool b_valid = false;
  std::uint32_t b_response = 0;
  std::uint32_t b_id = 0;
};

}  // namespace fasttree::rtl
