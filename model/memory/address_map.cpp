// SPDX-License-Identifier: Apache-2.0
#include "model/memory/address_map.h"

#include <bit>

namespace fasttree::model {

AddressMap::AddressMap(const DramSpec& spec, const ControllerConfig& controller)
    : channels_(spec.channels),
      banks_(spec.banks),
      rows_(spec.rows),
      columns_(spec.columns),
      burst_mask_(spec.burst_length - 1),
      bank_hash_(controller.bank_hash),
      bank_bits_(std::countr_zero(spec.banks)),
      channel_bits_(std::countr_zero(spec.channels)),
      channel_shift_(std::countr_zero(controller.interleave == Interleave::burst
                                          ? spec.access_bytes()
                                          : controller.row_interleave_bytes)),
      word_shift_(std::countr_zero(spec.channel_bits / 8)) {
  const int above_column = word_shift_ + std::countr_zero(spec.columns);
  if (controller.address_order == AddressOrder::row_bank_column) {
    bank_shift_ = above_column;
    row_shift_ = above_column + std::countr_zero(spec.banks);
  } else {
    row_shift_ = above_column;
    bank_shift_ = above_column + std::countr_zero(spec.rows);
  }
}

}  // namespace fasttree::model
