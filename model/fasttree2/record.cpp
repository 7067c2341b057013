// SPDX-License-Identifier: Apache-2.0
#include "model/fasttree2/record.h"

#include <algorithm>
#include <bit>

namespace fasttree::model::ft2 {

RecordFormat::RecordFormat(std::uint32_t triangles, const std::array<std::uint8_t, 3>& axis_bits)
    : id_bits_(static_cast<std::uint32_t>(std::bit_width(std::max(triangles, 2u) - 1))),
      axis_bits_(axis_bits) {
  const std::uint32_t bits = id_bits_ + 2u * (axis_bits[0] + axis_bits[1] + axis_bits[2]);
  bytes_ = (bits + 7) / 8;
}

void RecordFormat::pack(const Record& record, std::uint8_t* to) const {
  // The box has up to 60 bits; together with the id more than a word holds.
  std::uint64_t box = 0;
  for (std::size_t corner = 2; corner-- > 0;) {
    for (std::size_t a = 3; a-- > 0;) {
      box = box << axis_bits_[a] | (corner == 0 ? record.box.lo[a] : record.box.hi[a]);
    }
  }
  std::uint64_t low = record.id | box << id_bits_;
  std::uint64_t high = box >> (64 - id_bits_);
  for (std::uint32_t i = 0; i < bytes_; ++i) {
    to[i] = static_cast<std::uint8_t>(low);
    low = low >> 8 | high << 56;
    high >>= 8;
  }
}

Record RecordFormat::unpack(const std::uint8_t* from) const {
  std::uint64_t low = 0;
  std::uint64_t high = 0;
  for (std::uint32_t i = bytes_; i-- > 0;) {
    high = high << 8 | low >> 56;
    low = low << 8 | from[i];
  }
  Record record;
  record.id = static_cast<std::uint32_t>(low & ((std::uint64_t{1} << id_bits_) - 1));
  std::uint64_t box = low >> id_bits_ | high << (64 - id_bits_);
  for (std::size_t corner = 0; corner < 2; ++corner) {
    for (std::size_t a = 0; a < 3; ++a) {
      const auto value = static_cast<std::uint32_t>(box & ((1u << axis_bits_[a]) - 1));
      (corner == 0 ? record.box.lo[a] : record.box.hi[a]) = value;
      box >>= axis_bits_[a];
    }
  }
  return record;
}

}  // namespace fasttree::model::ft2
