// SPDX-License-Identifier: Apache-2.0
// Where a byte address is: channel, bank, row, column. Pictures in docs/memory_model.md.
#pragma once

#include <cstdint>

#include "model/kernel/quantities.h"
#include "model/memory/memory_config.h"

namespace fasttree::model {

struct DramLocation {
  std::uint32_t channel = 0;
  std::uint32_t bank = 0;
  std::uint32_t row = 0;
  std::uint32_t column = 0;  ///< first column of the burst

  friend bool operator==(const DramLocation&, const DramLocation&) = default;
};

/// A one-to-one map from bursts of the whole capacity to locations. Addresses beyond the capacity
/// wrap around. All sizes are powers of two, so it is a choice of bits.
class AddressMap {
 public:
  AddressMap(const DramSpec& spec, const ControllerConfig& controller);

  DramLocation locate(Address address) const {
    const std::uint64_t a = address.value;
    DramLocation at;
    at.channel = static_cast<std::uint32_t>(a >> channel_shift_) & (channels_ - 1);
    // The channel's bits taken out of the address leave the address inside the channel.
    const std::uint64_t below = a & ((std::uint64_t{1} << channel_shift_) - 1);
    const std::uint64_t inside = (a >> (channel_shift_ + channel_bits_) << channel_shift_) | below;
    at.column = (static_cast<std::uint32_t>(inside >> word_shift_) & (columns_ - 1)) & ~burst_mask_;
    at.bank = static_cast<std::uint32_t>(inside >> bank_shift_) & (banks_ - 1);
    at.row = static_cast<std::uint32_t>(inside >> row_shift_) & (rows_ - 1);
    if (bank_hash_) {
      // Exclusive or with every part of the row number: still one to one, for the row is kept.
      for (std::uint32_t rest = at.row; rest != 0 && bank_bits_ != 0; rest >>= bank_bits_) {
        at.bank ^= rest & (banks_ - 1);
      }
    }
    return at;
  }
  std::uint32_t channel(Address address) const {
    return static_cast<std::uint32_t>(address.value >> channel_shift_) & (channels_ - 1);
  }

 private:
  std::uint32_t channels_, banks_, rows_, columns_, burst_mask_;
  bool bank_hash_;
  int bank_bits_, channel_bits_, channel_shift_, word_shift_, bank_shift_, row_shift_;
};

}  // namespace fasttree::model
