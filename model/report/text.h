// SPDX-License-Identifier: Apache-2.0
// Numbers and names as text, the same in every report.
#pragma once

#include <cstdint>
#include <string>

namespace fasttree::model {

/// With so many digits after the point.
std::string fixed(double value, int digits);
/// "1,234,567"
std::string grouped(std::uint64_t value);
/// Part of a whole as "12.3 %"; "-" where there is no whole.
std::string percent(double part, double whole);
/// "12.3 MiB"
std::string byte_count(std::uint64_t bytes);

/// For HTML text, and for attributes between double quotes.
std::string escaped_html(const std::string& text);
/// One cell of a CSV line, in quotes where it needs them.
std::string csv_cell(const std::string& text);

}  // namespace fasttree::model
