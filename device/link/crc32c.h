// SPDX-License-Identifier: Apache-2.0
// CRC-32C (Castagnoli): the checksum of a frame. Hardware makes it as bytes go by, a word a cycle;
// processors have an instruction for it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace fasttree::device {

/// Of the bytes that `crc` stands for, and then of these: polynomial 0x1EDC6F41, reflected, all
/// ones before and inverted behind, as in iSCSI.
std::uint32_t crc32c(std::span<const std::byte> bytes, std::uint32_t crc = 0);

/// The same without the processor's instruction.
std::uint32_t crc32c_portable(std::span<const std::byte> bytes, std::uint32_t crc = 0);

}  // namespace fasttree::device
