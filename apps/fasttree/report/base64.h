// SPDX-License-Identifier: Apache-2.0
// Bytes as text, for pictures that lie inside a page.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace fasttree::report {

/// RFC 4648, with padding.
std::string base64(std::span<const std::byte> bytes);

/// "data:image/png;base64,..."
std::string png_uri(std::span<const std::byte> png);

}  // namespace fasttree::report
