// SPDX-License-Identifier: Apache-2.0
#include "fuzz/mutator.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string_view>
#include <utility>

namespace fasttree::fuzz {
namespace {

Bytes to_bytes(std::string_view text) {
  Bytes bytes(text.size());
  std::transform(text.begin(), text.end(), bytes.begin(),
                 [](char c) { return static_cast<std::byte>(c); });
  return bytes;
}

bool is_word(std::byte b) {
  const auto c = std::to_integer<unsigned char>(b);
  return std::isalnum(c) != 0 || c == '-' || c == '.' || c == '_' || c == '/' || c == '+';
}

// The whole word around a place.
std::pair<std::size_t, std::size_t> word_at(const Bytes& bytes, std::size_t at) {
  std::size_t begin = at;
  std::size_t end = at;
  while (begin > 0 && is_word(bytes[begin - 1])) --begin;
  while (end < bytes.size() && is_word(bytes[end])) ++end;
  return {begin, end};
}

constexpr std::array<std::uint64_t, 16> kNumbers = {
    0,      1,       2,          3,          0x7f,       0x80,       0xff,       0x7fff,
    0xffff, 0x10000, 0x7fffffff, 0x80000000, 0xfffffffe, 0xffffffff, 1ull << 53, ~0ull};

constexpr std::array<std::string_view, 16> kNumberWords = {"0",
                                                           "-1",
                                                           "1",
                                                           "2",
                                                           "255",
                                                           "65536",
                                                           "3.5",
                                                           "2147483648",
                                                           "4294967295",
                                                           "1e39",
                                                           "18446744073709551616",
                                                           "nan",
                                                           "-inf",
                                                           "9007199254740992",
                                                           "-9223372036854775808",
                                                           ""};

}  // namespace

Mutator::Mutator(std::vector<Bytes> seeds, std::uint64_t seed)
    : seeds_(std::move(seeds)), random_(seed) {
  std::set<std::string> words;
  for (const Bytes& bytes : seeds_) {
    for (std::size_t at = 0; at < bytes.size();) {
      const std::size_t end = word_at(bytes, at).second;
      if (end > at && end - at <= 32) {
        words.emplace(reinterpret_cast<const char*>(bytes.data()) + at, end - at);
      }
      at = end + 1;
    }
  }
  for (const std::string& word : words) words_.push_back(to_bytes(word));
}

std::size_t Mutator::below(std::size_t bound) {
  return bound == 0 ? 0 : static_cast<std::size_t>(random_() % bound);
}

Bytes Mutator::next() {
  Bytes bytes = seeds_[below(seeds_.size())];
  for (std::size_t changes = std::size_t{1} << below(4); changes > 0; --changes) change(bytes);
  return bytes;
}

void Mutator::change(Bytes& bytes) {
  if (bytes.empty()) return;
  switch (below(4)) {
    case 0:
      return change_bits(bytes);
    case 1:
      return change_number(bytes);
    case 2:
      return change_word(bytes);
    default:
      return move_parts(bytes);
  }
}

void Mutator::put(Bytes& bytes, std::size_t at, std::size_t erase, const Bytes& insert) const {
  const auto from = bytes.begin() + static_cast<std::ptrdiff_t>(at);
  const auto to = from + static_cast<std::ptrdiff_t>(std::min(erase, bytes.size() - at));
  const auto place = bytes.erase(from, to);
  bytes.insert(place, insert.begin(), insert.end());
}

Bytes Mutator::some_of(const Bytes& bytes) {
  const std::size_t begin = below(bytes.size());
  const std::size_t length = 1 + below(std::min<std::size_t>(bytes.size() - begin, 64));
  return {bytes.begin() + static_cast<std::ptrdiff_t>(begin),
          bytes.begin() + static_cast<std::ptrdiff_t>(begin + length)};
}

void Mutator::change_bits(Bytes& bytes) {
  std::byte& b = bytes[below(bytes.size())];
  if (below(2) == 0) {
    b ^= static_cast<std::byte>(1u << below(8));
  } else {
    b = static_cast<std::byte>(below(256));
  }
}

// A binary number of 1 to 8 bytes, either byte order.
void Mutator::change_number(Bytes& bytes) {
  const std::size_t size = std::size_t{1} << below(4);
  if (bytes.size() < size) return;
  const std::size_t at = below(bytes.size() - size + 1);
  std::uint64_t value = kNumbers[below(kNumbers.size())];
  if (below(4) == 0) value = bytes.size() - below(16);  // near a size that may be right
  const bool big = below(2) == 0;
  for (std::size_t i = 0; i < size; ++i) {
    bytes[at + (big ? size - 1 - i : i)] = static_cast<std::byte>(value >> (8 * i) & 0xff);
  }
}

void Mutator::change_word(Bytes& bytes) {
  const auto [begin, end] = word_at(bytes, below(bytes.size()));
  const bool number = words_.empty() || below(2) == 0;
  put(bytes, begin, end - begin,
      number ? to_bytes(kNumberWords[below(kNumberWords.size())]) : words_[below(words_.size())]);
}

void Mutator::move_parts(Bytes& bytes) {
  const std::size_t at = below(bytes.size());
  switch (below(5)) {
    case 0:  // cut the end off
      bytes.resize(at);
      break;
    case 1:  // lose some
      put(bytes, at, 1 + below(16), {});
      break;
    case 2:  // repeat some
      put(bytes, at, 0, some_of(bytes));
      break;
    case 3: {  // overwrite some with some of another
      const Bytes part = some_of(seeds_[below(seeds_.size())]);
      put(bytes, at, part.size(), part);
      break;
    }
    default: {  // go on as another
      const Bytes& other = seeds_[below(seeds_.size())];
      bytes.resize(at);
      bytes.insert(bytes.end(), other.begin() + static_cast<std::ptrdiff_t>(below(other.size())),
                   other.end());
    }
  }
}

std::vector<Bytes> read_corpus(const std::string& folder) {
  std::vector<std::filesystem::path> paths;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (entry.is_regular_file()) paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  std::vector<Bytes> files;
  for (const auto& path : paths) {
    std::ifstream in(path, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    if (!text.empty()) files.push_back(to_bytes(text));
  }
  return files;
}

}  // namespace fasttree::fuzz
